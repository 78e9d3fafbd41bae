//! How the blocks of one entry of Φcam are spread, and what that says of its standard error.

use super::tails::{FEW_LIT, LARGEST, SKEWED};

/// The share of the scatter that one block may have. Student's t is asymptotically normal only if
/// this share goes to 0 (Giné, Götze, Mason, *When is the Student t-statistic asymptotically
/// standard normal?*, Ann. Probab. 25, 1997). Of 32 normal blocks one has more than half in fewer
/// than 1 case of 10⁴.
const LARGEST_SHARE: f64 = 0.5;
/// The largest |skewness| of [`FEWEST`] blocks; it grows as √n.
///
/// Of blocks with skewness γ and kurtosis κ a two-sided Student interval of ±x misses the mean more
/// often than it says by (Hall, *The Bootstrap and Edgeworth Expansion*, 1992, § 2.6; Johnson,
/// JASA 73, 1978)
///
/// ```text
/// 2/n · x φ(x) · [γ² (x⁴ + 2x² − 3)/18 − κ (x² − 3)/12]
/// ```
///
/// With κ = 1.5 γ² (the gamma family) and n = 32 that adds 1 % to 5 % at |γ| = 1.2, and 0.2 % to
/// 0.1 % at 0.9. The skewness of 32 blocks with γ = 0.9 is above 1.5 in about 5 % of all cases,
/// where the rule of neighbours begins; that of normal blocks in 0.1 %.
const SKEWNESS: f64 = 1.5;
/// The number of blocks that [`SKEWNESS`] is for.
const FEWEST: f64 = 32.0;
/// The share of blocks that may be without light: of 32 that are lit with probability ½, more are
/// dark in 2.5 % of all cases, and Student's interval of such still holds (Brown, Cai, DasGupta,
/// *Interval estimation for a binomial proportion*, Stat. Sci. 16, 2001).
const DARK_SHARE: f64 = 2.0 / 3.0;
/// A standard deviation below this share of the mean is that of rounding.
const ROUNDING: f64 = 1e-12;

/// The totals t of n blocks, beside their sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    /// Σ(t − t̄)², W².
    pub scatter: f64,
    /// Σ(t − t̄)³, W³.
    pub third: f64,
    /// The largest t, W.
    pub largest: f64,
    /// Blocks with t = 0.
    pub dark: f64,
}

impl Spread {
    /// Numbers of it on disk.
    pub(super) const NUMBERS: usize = 4;

    /// One block.
    pub(super) fn of_block(total: f64) -> Self {
        Self {
            scatter: 0.0,
            third: 0.0,
            largest: total,
            dark: f64::from(u8::from(total == 0.0)),
        }
    }

    /// n₁ and n₂ blocks together, whose means are δ = t̄₂ − t̄₁ apart (Chan, Golub, LeVeque,
    /// *Updating formulae and a pairwise algorithm for computing sample variances*, COMPSTAT 1982;
    /// Pébay, SAND2008-6212, for the third sum):
    ///
    /// ```text
    /// M = M₁ + M₂ + δ² n₁n₂/n      C = C₁ + C₂ + δ³ n₁n₂(n₁ − n₂)/n² + 3δ (n₁M₂ − n₂M₁)/n
    /// ```
    pub(super) fn join(self, other: Self, [n1, n2]: [f64; 2], apart: f64) -> Self {
        let n = n1 + n2;
        let weight = n1 * n2 / n;
        let cross = 3.0 * apart * (n1 * other.scatter - n2 * self.scatter) / n;
        let cube = apart * apart * apart * weight * ((n1 - n2) / n);
        Self {
            scatter: self.scatter + (other.scatter + apart * apart * weight),
            third: self.third + (other.third + (cube + cross)),
            largest: self.largest.max(other.largest),
            dark: self.dark + other.dark,
        }
    }

    pub(super) fn numbers(self) -> [f64; Self::NUMBERS] {
        [self.scatter, self.third, self.largest, self.dark]
    }

    /// `None` unless finite, and at least 0 but for the third sum.
    pub(super) fn from_numbers([scatter, third, largest, dark]: [f64; 4]) -> Option<Self> {
        let flux = |x: f64| x.is_finite() && x >= 0.0;
        let fits = third.is_finite() && [scatter, largest, dark].into_iter().all(flux);
        fits.then_some(Self {
            scatter,
            third,
            largest,
            dark,
        })
    }

    /// What the spread of n lit blocks of this mean says against Student's interval: bits of
    /// [`tails`](super::tails), 0 for nothing. Fewer than six blocks cannot show a tail.
    pub(super) fn code(self, n: f64, mean: f64) -> u32 {
        let rounding = ROUNDING * mean;
        if self.scatter <= n * rounding * rounding {
            return 0;
        }
        let apart = self.largest - mean;
        let skewness = self.third * n.sqrt() / (self.scatter * self.scatter.sqrt());
        let limit = SKEWNESS * (n / FEWEST).max(1.0).sqrt();
        [
            (LARGEST, apart * apart > LARGEST_SHARE * self.scatter),
            (SKEWED, skewness.abs() > limit),
            (FEW_LIT, self.dark > DARK_SHARE * n),
        ]
        .into_iter()
        .filter(|(_, is)| *is)
        .fold(0, |code, (bit, _)| code | bit)
    }
}
