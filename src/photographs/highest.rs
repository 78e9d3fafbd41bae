//! The largest stored integers, and whether the camera was full at the largest of all.

use crate::num::digits::figure;

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
/// Values below the largest that it is compared with.
const BELOW: usize = 16;
/// By how much the largest outnumbers them where the camera was full, and the probability that
/// noise does that: 2⁻³⁶ for each of the 2¹⁶ values that could be the largest.
const SURPLUS: usize = 36;
const BY_CHANCE: f64 = 1.0 / (1 << 20) as f64;

/// The largest of some stored integers and the next below that occur, the largest first, and how
/// many there are of each.
///
/// Where the camera was full all that is brighter is stored as its largest value m, and noise does
/// not spread it. Let a stored value be light of any kind with normal noise of a standard deviation
/// of one step or more. Then the probabilities of m, of the 16 values below it and of all above
/// obey
///
/// > P(m) ≤ ½ P(m − 16 … m − 1) + P(above m),
///
/// so that the mean of f = 2, ½ and 0 of these three, 1 of others, is 1 at most. With n values of
/// m, b of the 16 below and none above, their product over independent values is 2^(n − b), and is
/// that large with a probability of 2^(b − n) at most (Markov). So n − b ≥ 36 has one below 1e-6,
/// whichever of 2¹⁶ values m is.
///
/// Less noise than a step leaves dark frames, flat fields and pictures without noise on a few
/// values: nothing is said where there are no more than 17, or most others lie on the 16 below. A
/// picture without noise whose brightest area is even is no different from one that was clipped.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Highest {
    values: Vec<(f64, usize)>,
    /// All integers.
    all: usize,
}

impl Highest {
    /// The largest; 0 of none.
    pub(super) fn value(&self) -> f64 {
        self.values.first().map_or(0.0, |(value, _)| *value)
    }

    /// One more.
    pub(super) fn count(&mut self, value: f64) {
        self.all += 1;
        self.hold(value, 1);
    }

    /// All of another.
    pub(super) fn add(&mut self, other: &Self) {
        self.all += other.all;
        other
            .values
            .iter()
            .for_each(|(value, n)| self.hold(*value, *n));
    }

    /// What falls below the [`BELOW`] + 1 largest never is among them again.
    fn hold(&mut self, value: f64, times: usize) {
        let at = self.values.partition_point(|(larger, _)| *larger > value);
        match self.values.get_mut(at) {
            Some((held, n)) if *held == value => *n += times,
            _ if at > BELOW => {}
            _ => {
                self.values.insert(at, (value, times));
                self.values.truncate(BELOW + 1);
            }
        }
    }

    /// That the camera was full at the largest: values end where those of a camera of fewer bits
    /// than the file's do, or more of them are the largest than noise leaves there.
    pub(super) fn clipped(&self) -> Option<String> {
        let ((value, times), below) = self.values.split_first()?;
        let known = FULL.iter().find(|(_, full)| full == value);
        if let Some((bits, _)) = known.filter(|_| *times >= FEW) {
            return Some(format!(
                "{times} stored values are {value}, the largest that {bits} bits have, and none is larger: the camera \
                 was full there, and these entries count as if it were not; give `full_scale = {value}`"
            ));
        }
        let next: usize = below.iter().map(|(_, n)| n).sum();
        let others = self.all - times;
        let is_plateau = below.len() == BELOW && *times >= next + SURPLUS && others >= 2 * next;
        is_plateau.then(|| {
            format!(
                "{times} of {} stored values are {value}, none is larger, and the next {BELOW} below are {next} \
                 together: noise does that with a probability below {}. The camera was full there, or what saved its \
                 counts, and these entries count as if it were not; give `saturation = {value}`",
                self.all,
                figure(BY_CHANCE, 1)
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use libm::{erfc, exp, log, sqrt};

    use super::*;
    use crate::num::stream::{Key, Sampling, Stream};

    fn of(values: impl IntoIterator<Item = f64>) -> Highest {
        let mut found = Highest::default();
        values.into_iter().for_each(|value| found.count(value));
        found
    }

    /// 4095 held by three pixels is the end of 12 bits; by one, or another value, it may be chance.
    #[test]
    fn a_camera_of_fewer_bits_is_told() {
        let told = |value, times| of(vec![value; times]).clipped();
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
        let mut all = of([7.0, 4095.0, 9.0, 7.0]);
        all.add(&of([4095.0, 3.0, 4095.0]));
        assert!(all.value() == 4095.0 && all.clipped().is_some(), "{all:?}");
    }

    /// P(m) ≤ ½ P(16 below) + P(above) by the normal law itself, of light about m in steps of a
    /// hundredth of its noise, which is one to a thousand steps.
    #[test]
    fn what_noise_leaves_at_the_top_is_bounded() {
        let above = |z: f64| 0.5 * erfc(z / sqrt(2.0));
        for sigma in [1.0, 1.3, 2.0, 5.0, 30.0, 1000.0] {
            for k in -800..=800 {
                let light = f64::from(k) * 0.01;
                let edge = |steps: f64| above((steps - 0.5) / sigma - light);
                let (more, from_top, from_below) = (edge(1.0), edge(0.0), edge(-(BELOW as f64)));
                let (top, next) = (from_top - more, from_below - from_top);
                assert!(top <= 0.5 * next + more, "{sigma} {light}");
            }
        }
    }

    /// Light of every kind with noise: that of a spot over a dark wall, a flat field and one with
    /// dead pixels, dark frames of less noise than a step, a glow and a ridge without noise.
    /// None ends by more than chance; the spot ends at 60000 where the camera does.
    #[test]
    fn a_plateau_is_told_and_none_is_made_up() {
        let key = Key {
            seed: 3,
            spot: 0,
            pixel: 0,
            block: 0,
        };
        let mut stream = Stream::new(Sampling::Pcg, key);
        let mut normal = || {
            let [a, b, ..] = stream.next_four();
            sqrt(-2.0 * log(1.0 - a)) * libm::cos(std::f64::consts::TAU * b)
        };
        let spot = |k: usize| {
            let [x, y] = [k % 128, k / 128].map(|i| (i as f64 - 64.0) / 6.0);
            200.0 + 90_000.0 * exp(-0.5 * (x * x + y * y))
        };
        let mut taken = |light: &dyn Fn(usize) -> f64, noise: f64| -> Vec<f64> {
            let pixels = 0..128 * 128;
            pixels
                .map(|k| (light(k) + noise * normal()).round().max(0.0))
                .collect()
        };
        let dead = |k: usize| {
            if k.is_multiple_of(150) {
                (k / 150) as f64
            } else {
                1000.55
            }
        };
        for noise in [1.0, 3.0, 50.0] {
            let [spots, flat, with_dead] = [
                taken(&spot, noise),
                taken(&|_| 1000.0, noise),
                taken(&dead, noise),
            ];
            for values in [&spots, &flat, &with_dead] {
                assert_eq!(of(values.iter().copied()).clipped(), None, "{noise}");
            }
            let full = of(spots.iter().map(|x| x.min(60_000.0)));
            let (upper, lower) = spots.split_at(spots.len() / 2);
            let [mut both, lower] =
                [upper, lower].map(|own| of(own.iter().map(|x| x.min(60_000.0))));
            both.add(&lower);
            assert_eq!(both, full);
            let count = spots.iter().filter(|x| **x >= 60_000.0).count();
            let words = full.clipped().unwrap();
            assert!(words.contains(&format!("{count} of 16384")), "{words}");
            assert!(words.contains("`saturation = 60000`"), "{words}");
        }
        for noise in [0.1, 0.3] {
            assert_eq!(of(taken(&dead, noise)).clipped(), None, "{noise}");
            for level in [0.0, 0.45, 1000.45] {
                let dark = of(taken(&|_| level, noise));
                assert_eq!(dark.clipped(), None, "{level} {noise}");
            }
        }
        // A glow of 8 bits that is darker than 12, 40 and 200 counts, and a board of two.
        for top in [12.0, 40.0, 200.0] {
            let glow = taken(&|k| top * (spot(k) - 200.0) / 90_000.0, 0.0);
            assert_eq!(of(glow).clipped(), None, "{top}");
            let ridge = taken(&|k| top - 0.04 * ((k % 128) as f64 - 64.0).powi(2), 0.0);
            assert_eq!(of(ridge).clipped(), None, "{top}");
            let board = taken(&|k| if k.is_multiple_of(3) { 10.0 } else { top }, 0.0);
            assert_eq!(of(board).clipped(), None, "{top}");
        }
    }
}
