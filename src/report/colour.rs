//! Colour scales.

/// Red, green, blue, sRGB.
pub type Rgb = [u8; 3];

/// A sequence of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// Black to white, linear in the sRGB value.
    Grey,
    /// viridis: perceptually uniform and safe for colour-blind eyes (S. van der Walt and N. Smith
    /// for matplotlib, CC0).
    Viridis,
    /// Blue – white – red for signed values: `RdBu` of ColorBrewer 2.0 (C. Brewer and M. Harrower),
    /// reversed.
    Diverging,
}

/// How colours are spread over values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// Evenly.
    Linear,
    /// Evenly over the logarithm.
    Logarithmic,
}

/// Values low…high shown by the colours of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    map: Map,
    law: Law,
    low: f64,
    high: f64,
}

/// What is not a number, on every scale: reddish purple (Okabe–Ito).
pub(super) const NOT_A_NUMBER: (Rgb, &str) = ([0xcc, 0x79, 0xa7], "purple");

impl Scale {
    /// The one scale of reflectances: black 0, white 1, whatever the data.
    pub fn reflectance() -> Self {
        Self {
            map: Map::Grey,
            law: Law::Linear,
            low: 0.0,
            high: 1.0,
        }
    }

    /// viridis from the smallest to the largest finite value.
    pub fn sequential<'a>(values: impl IntoIterator<Item = &'a f64>) -> Self {
        let (low, high) = values
            .into_iter()
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| {
                (l.min(x), h.max(x))
            });
        let (low, high) = match low <= high {
            true if low < high => (low, high),
            true => (low.min(0.0), high.max(0.0)),
            false => (0.0, 1.0),
        };
        Self {
            map: Map::Viridis,
            law: Law::Linear,
            low,
            high: if low < high { high } else { low + 1.0 },
        }
    }

    /// Diverging colours from −`limit` to `limit`; a limit that is not positive is taken as 1.
    pub fn symmetric(limit: f64) -> Self {
        let limit = if limit > 0.0 && limit.is_finite() {
            limit
        } else {
            1.0
        };
        Self {
            map: Map::Diverging,
            law: Law::Linear,
            low: -limit,
            high: limit,
        }
    }

    /// `map` from `low` to `high`; `None` unless they are finite, in this order, and above 0 where
    /// the scale is logarithmic.
    pub fn between(map: Map, law: Law, [low, high]: [f64; 2]) -> Option<Self> {
        let ordered = low < high && low.is_finite() && high.is_finite();
        let proper = ordered && (law == Law::Linear || low > 0.0);
        proper.then_some(Self {
            map,
            law,
            low,
            high,
        })
    }

    /// How its colours are spread.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Where between the first colour (0) and the last (1) a value of the range stands.
    pub fn share(&self, value: f64) -> f64 {
        match self.law {
            // Halves, so that no difference overflows.
            Law::Linear => (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low),
            Law::Logarithmic => {
                let [x, low, high] = [value, self.low, self.high].map(libm::log10);
                (x - low) / (high - low)
            }
        }
    }

    /// The value that stands there.
    pub fn value(&self, share: f64) -> f64 {
        match self.law {
            Law::Linear => self.low * (1.0 - share) + self.high * share,
            Law::Logarithmic => {
                let [low, high] = [self.low, self.high].map(libm::log10);
                // Rounding of the powers must not leave the range.
                libm::exp10(low * (1.0 - share) + high * share).clamp(self.low, self.high)
            }
        }
    }

    /// Its map.
    pub fn map(&self) -> Map {
        self.map
    }

    /// The values of the first and the last colour.
    pub fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// The colour of `value`: of the map inside the range, [`below`](Self::below) or
    /// [`above`](Self::above) outside.
    pub fn colour(&self, value: f64) -> Rgb {
        if value.is_nan() {
            NOT_A_NUMBER.0
        } else if value < self.low {
            self.below().0
        } else if value > self.high {
            self.above().0
        } else {
            self.map.at(self.share(value))
        }
    }

    /// Colour of values below the range, and its name.
    pub fn below(&self) -> (Rgb, &'static str) {
        match self.map {
            Map::Grey => ([0x00, 0x72, 0xb2], "blue"),
            Map::Viridis => ([0x00, 0x00, 0x00], "black"),
            Map::Diverging => ([0x00, 0x9e, 0x73], "green"),
        }
    }

    /// Colour of values above the range, and its name.
    pub fn above(&self) -> (Rgb, &'static str) {
        match self.map {
            Map::Grey => ([0xd5, 0x5e, 0x00], "orange"),
            Map::Viridis => ([0xd5, 0x5e, 0x00], "orange"),
            Map::Diverging => ([0xf0, 0xe4, 0x42], "yellow"),
        }
    }
}

impl Map {
    /// The colour at t ∈ [0, 1].
    pub fn at(self, t: f64) -> Rgb {
        let t = t.clamp(0.0, 1.0);
        match self {
            Self::Grey => [(255.0 * t).round() as u8; 3],
            Self::Viridis => {
                let i = (255.0 * t).round() as usize;
                hex(VIRIDIS, i)
            }
            Self::Diverging => {
                let x = 10.0 * t;
                let i = (x as usize).min(9);
                let (a, b, f) = (hex(BLUE_RED, i), hex(BLUE_RED, i + 1), x - i as f64);
                [0, 1, 2].map(|c| {
                    (f64::from(a[c]) + f * (f64::from(b[c]) - f64::from(a[c]))).round() as u8
                })
            }
        }
    }
}

/// Colour `i` of a table of hexadecimal triples.
fn hex(table: &str, i: usize) -> Rgb {
    [0, 2, 4].map(|k| {
        let digits = table.get(6 * i + k..6 * i + k + 2).unwrap_or("00");
        u8::from_str_radix(digits, 16).unwrap_or(0)
    })
}

/// ColorBrewer's 11-class `RdBu`, from blue to red.
const BLUE_RED: &str = "0530612166ac4393c392c5ded1e5f0f7f7f7fddbc7f4a582d6604db2182b67001f";

/// The 256 colours of viridis as published.
const VIRIDIS: &str = "\
    44015444025645045745055946075a46085c460a5d460b5e470d60470e61471063471164471365481467481668481769\
    48186a481a6c481b6d481c6e481d6f481f70482071482173482374482475482576482677482878482979472a7a472c7a\
    472d7b472e7c472f7d46307e46327e46337f463480453581453781453882443983443a83443b84433d84433e85423f85\
    4240864241864142874144874045884046883f47883f48893e49893e4a893e4c8a3d4d8a3d4e8a3c4f8a3c508b3b518b\
    3b528b3a538b3a548c39558c39568c38588c38598c375a8c375b8d365c8d365d8d355e8d355f8d34608d34618d33628d\
    33638d32648e32658e31668e31678e31688e30698e306a8e2f6b8e2f6c8e2e6d8e2e6e8e2e6f8e2d708e2d718e2c718e\
    2c728e2c738e2b748e2b758e2a768e2a778e2a788e29798e297a8e297b8e287c8e287d8e277e8e277f8e27808e26818e\
    26828e26828e25838e25848e25858e24868e24878e23888e23898e238a8d228b8d228c8d228d8d218e8d218f8d21908d\
    21918c20928c20928c20938c1f948c1f958b1f968b1f978b1f988b1f998a1f9a8a1e9b8a1e9c891e9d891f9e891f9f88\
    1fa0881fa1881fa1871fa28720a38620a48621a58521a68522a78522a88423a98324aa8325ab8225ac8226ad8127ad81\
    28ae8029af7f2ab07f2cb17e2db27d2eb37c2fb47c31b57b32b67a34b67935b77937b87838b9773aba763bbb753dbc74\
    3fbc7340bd7242be7144bf7046c06f48c16e4ac16d4cc26c4ec36b50c46a52c56954c56856c66758c7655ac8645cc863\
    5ec96260ca6063cb5f65cb5e67cc5c69cd5b6ccd5a6ece5870cf5773d05675d05477d1537ad1517cd2507fd34e81d34d\
    84d44b86d54989d5488bd6468ed64590d74393d74195d84098d83e9bd93c9dd93ba0da39a2da37a5db36a8db34aadc32\
    addc30b0dd2fb2dd2db5de2bb8de29bade28bddf26c0df25c2df23c5e021c8e020cae11fcde11dd0e11cd2e21bd5e21a\
    d8e219dae319dde318dfe318e2e418e5e419e7e419eae51aece51befe51cf1e51df4e61ef6e620f8e621fbe723fde725";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_have_their_published_colours() {
        // Published: viridis runs from #440154 through #21918c (entry 128) to #fde725; RdBu's
        // middle is #f7f7f7.
        assert_eq!(Map::Viridis.at(0.0), [0x44, 0x01, 0x54]);
        assert_eq!(Map::Viridis.at(128.0 / 255.0), [0x21, 0x91, 0x8c]);
        assert_eq!(Map::Viridis.at(1.0), [0xfd, 0xe7, 0x25]);
        assert_eq!(Map::Diverging.at(0.0), [0x05, 0x30, 0x61]);
        assert_eq!(Map::Diverging.at(0.5), [0xf7, 0xf7, 0xf7]);
        assert_eq!(Map::Diverging.at(1.0), [0x67, 0x00, 0x1f]);
        assert_eq!(Map::Grey.at(0.5), [128; 3]);
    }

    #[test]
    fn viridis_grows_lighter_all_the_way() {
        // A sequential map must order by lightness: relative luminance of linear sRGB (IEC
        // 61966-2-1).
        let luminance = |c: Rgb| {
            let linear = c.map(|x| {
                let x = f64::from(x) / 255.0;
                if x <= 0.04045 {
                    x / 12.92
                } else {
                    ((x + 0.055) / 1.055).powf(2.4)
                }
            });
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        for i in 0..255 {
            let [a, b] = [i, i + 1].map(|k| luminance(Map::Viridis.at(f64::from(k) / 255.0)));
            // Rounding to 8 bits may lower one channel by one step: at most 0.7152·(slope 2.3)/255.
            assert!(b > a - 0.0065, "{i}");
        }
        assert_eq!(VIRIDIS.len(), 6 * 256);
    }

    /// Four decades: each takes a quarter of the colours.
    #[test]
    fn a_logarithmic_scale_gives_each_decade_as_many_colours() {
        let scale = Scale::between(Map::Viridis, Law::Logarithmic, [1e-13, 1e-9]).unwrap();
        for (k, value) in [1e-13, 1e-12, 1e-11, 1e-10, 1e-9].into_iter().enumerate() {
            let share = k as f64 / 4.0;
            assert!((scale.share(value) - share).abs() < 1e-12);
            assert!((scale.value(share) / value - 1.0).abs() < 1e-12);
            assert_eq!(scale.colour(value), Map::Viridis.at(share));
        }
        for below in [0.0, -1.0, 0.9e-13] {
            assert_eq!(scale.colour(below), scale.below().0);
        }
        for (law, range) in [
            (Law::Logarithmic, [0.0, 1.0]),
            (Law::Logarithmic, [-1.0, 1.0]),
            (Law::Linear, [1.0, 1.0]),
            (Law::Linear, [0.0, f64::INFINITY]),
            (Law::Linear, [f64::NAN, 1.0]),
        ] {
            assert_eq!(Scale::between(Map::Grey, law, range), None);
        }
    }

    #[test]
    fn the_reflectance_scale_is_fixed_and_marks_what_lies_outside() {
        let scale = Scale::reflectance();
        assert_eq!(scale.colour(0.0), [0; 3]);
        assert_eq!(scale.colour(1.0), [255; 3]);
        assert_eq!(scale.colour(-1e-9), scale.below().0);
        assert_eq!(scale.colour(1.0 + 1e-9), scale.above().0);
        assert_eq!(scale.colour(f64::NEG_INFINITY), scale.below().0);
        assert_eq!(scale.colour(f64::NAN), NOT_A_NUMBER.0);
        let outside = [scale.below().0, scale.above().0, NOT_A_NUMBER.0];
        for c in outside {
            assert!(c[0] != c[1] || c[1] != c[2], "a mark that is itself a grey");
        }
    }

    #[test]
    fn scales_survive_empty_constant_and_huge_data() {
        for values in [
            vec![],
            vec![f64::NAN],
            vec![0.0, 0.0],
            vec![-3.0],
            vec![1e300],
            vec![-1e308, 1e308],
        ] {
            let scale = Scale::sequential(&values);
            let [low, high] = scale.range();
            assert!(
                low < high && low.is_finite() && high.is_finite(),
                "{values:?}"
            );
            for v in values.iter().filter(|v| v.is_finite()) {
                assert_ne!(scale.colour(*v), scale.above().0, "{values:?}");
                assert_ne!(scale.colour(*v), scale.below().0, "{values:?}");
            }
        }
        let scale = Scale::symmetric(4.0);
        assert_eq!(scale.colour(0.0), [0xf7; 3]);
        assert_eq!(scale.colour(4.1), scale.above().0);
    }
}
