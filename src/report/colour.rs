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
mod tests;
