//! The largest stored integer, and whether the camera was full there.

/// Largest integers of cameras of 10, 12 and 14 bits, as they are and times what fills 16.
const FULL: [(u32, f64); 6] = [
    (10, 1023.0),
    (12, 4095.0),
    (14, 16_383.0),
    (10, 65_472.0),
    (12, 65_520.0),
    (14, 65_532.0),
];
/// The largest of values that end where they do by chance is held by fewer pixels.
const FEW: usize = 3;

/// The largest of some stored integers, and how many there are of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Highest {
    /// The integer.
    pub value: f64,
    /// How many.
    pub times: usize,
}

impl Highest {
    /// Of both.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        if self.value == other.value {
            let times = self.times + other.times;
            Self { times, ..self }
        } else if self.value > other.value {
            self
        } else {
            other
        }
    }

    /// That values end where those of a camera of fewer bits than the file's do.
    pub(super) fn clipped(self) -> Option<String> {
        let Self { value, times } = self;
        let (bits, _) = FULL
            .iter()
            .find(|(_, full)| *full == value && times >= FEW)?;
        Some(format!(
            "{times} stored values are {value}, the largest that {bits} bits have, and none is larger: the camera \
             was full there, and these entries count as if it were not; give `full_scale = {value}`"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4095 held by three pixels is the end of 12 bits; by one, or another value, it may be chance.
    #[test]
    fn a_camera_of_fewer_bits_is_told() {
        let told = |value, times| Highest { value, times }.clipped();
        for (value, bits) in [
            (4095.0, "12 bits"),
            (65_520.0, "12 bits"),
            (1023.0, "10 bits"),
        ] {
            let words = told(value, 3).unwrap();
            assert!(words.contains(bits) && words.contains(&format!("full_scale = {value}")));
            assert_eq!(told(value, 2), None);
        }
        assert_eq!(told(4094.0, 100), None);
        let all = [(7.0, 2), (4095.0, 1), (9.0, 1), (4095.0, 2)];
        let all = all.map(|(value, times)| Highest { value, times });
        let highest = all.into_iter().fold(Highest::default(), Highest::with);
        assert!(highest.clipped().is_some(), "{highest:?}");
    }
}
