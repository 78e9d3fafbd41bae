//! Random numbers as a pure function of (seed, spot, pixel, sample block): the one door to
//! generators.
//!
//! A [`Stream`] yields the sample points of one block. Which thread asks, and in which order the
//! blocks are traced, does not change a bit of it. Two samplings are offered:
//!
//! * [`Sampling::Pcg`]: independent uniform numbers from `Pcg64Mcg`, plain Monte Carlo; error ∝
//!   N^−½.
//! * [`Sampling::Sobol`]: Owen-scrambled Sobol' points (Burley, *Practical hash-based Owen
//!   scrambling*, JCGT 9(4), 2020). Each block is a net of its own with a scramble of its own, so
//!   that the block means are independent replicates and their spread is an honest error bar.
//!   Dimensions come in sets of four; within a set the points are a joint four-dimensional
//!   sequence, between sets they are independently shuffled.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

use super::named::{Named, named};
use super::{poisson, warp};

named! {
    /// The points that a path is built from.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Sampling {
        /// Independent uniform numbers.
        Pcg = "pcg": "Independent random numbers",
        /// Owen-scrambled Sobol' nets, one per block.
        Sobol = "sobol": "Owen-scrambled Sobol' points",
    }
}

impl std::str::FromStr for Sampling {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::by_name(text).ok_or_else(|| format!("no sampler `{text}` (use pcg or sobol)"))
    }
}

/// The largest number of points in one Sobol' block: the sequence repeats beyond 2¹⁶.
pub const LARGEST_NET: u32 = 1 << 16;

/// What a block of random numbers belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// Seed of the run.
    pub seed: u64,
    /// Spot index, or [`Key::ALL_SPOTS`] where one set of points serves every spot.
    pub spot: u32,
    /// Pixel index.
    pub pixel: u32,
    /// Sample block.
    pub block: u32,
}

impl Key {
    /// Stands for the spot where all spots share the points.
    pub const ALL_SPOTS: u32 = u32::MAX;
    /// Stands for the pixel where all pixels share the points.
    pub const ALL_PIXELS: u32 = u32::MAX;

    /// A well mixed 64-bit value of the key; different salts give unrelated values.
    fn mixed(self, salt: u64) -> u64 {
        let place = (u64::from(self.spot) << 32) | u64::from(self.pixel);
        let mut state = split_mix(self.seed ^ salt);
        state = split_mix(state ^ place);
        split_mix(state ^ u64::from(self.block))
    }
}

/// One step of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): a bijection of u64 that mixes every
/// bit.
fn split_mix(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The random numbers of one block.
#[derive(Clone, Debug)]
pub struct Stream {
    uniform: Pcg64Mcg,
    net: Option<Net>,
}

#[derive(Clone, Debug)]
struct Net {
    scramble: u32,
    index: u32,
    set: u32,
}

impl Stream {
    /// Opens the stream of `key`.
    pub fn new(sampling: Sampling, key: Key) -> Self {
        let state = (u128::from(key.mixed(0x5048_4943)) << 64) | u128::from(key.mixed(0x414d_0001));
        let uniform = Pcg64Mcg::from_seed(state.to_le_bytes());
        let net = match sampling {
            Sampling::Pcg => None,
            Sampling::Sobol => Some(Net {
                scramble: (key.mixed(0x534f_424f) >> 32) as u32,
                index: 0,
                set: 0,
            }),
        };
        Self { uniform, net }
    }

    /// Opens the stream of one stratum among those that the points of `key` are divided into;
    /// streams of different strata are unrelated.
    pub fn of_stratum(sampling: Sampling, key: Key, stratum: u32) -> Self {
        let seed = split_mix(key.seed ^ (u64::from(stratum) << 32 | 0x5354_5241));
        Self::new(sampling, Key { seed, ..key })
    }

    /// Moves to sample `index` of the block (0 … size − 1; Sobol': below [`LARGEST_NET`]). Samples
    /// must be visited in growing order.
    pub fn start(&mut self, index: u32) {
        if let Some(net) = &mut self.net {
            debug_assert!(index < LARGEST_NET);
            net.index = index;
            net.set = 0;
        }
    }

    /// The next four dimensions of the current sample, each in [0, 1).
    ///
    /// The Sobol' generator gives 24 bits; the bits below are filled with independent uniform ones,
    /// which is what Owen scrambling does to the digits that a finite net leaves free. No point
    /// sits on a lattice.
    pub fn next_four(&mut self) -> [f64; 4] {
        match &mut self.net {
            None => {
                let mut next = || unit(self.uniform.next_u64());
                [next(), next(), next(), next()]
            }
            Some(net) => {
                let sets = sobol_burley::NUM_DIMENSION_SETS_4D;
                let turn = (net.set / sets).wrapping_mul(0x9e37_79b9);
                let coarse =
                    sobol_burley::sample_4d(net.index, net.set % sets, net.scramble ^ turn);
                net.set += 1;
                let mut filled = |x: f32| {
                    let fine = unit(self.uniform.next_u64()) / f64::from(1u32 << 24);
                    (f64::from(x) + fine).min(1.0 - f64::EPSILON)
                };
                let [a, b, c, d] = coarse;
                [filled(a), filled(b), filled(c), filled(d)]
            }
        }
    }

    /// One uniform number in [0, 1), outside the sample's dimensions.
    pub fn uniform(&mut self) -> f64 {
        unit(self.uniform.next_u64())
    }

    /// One number with the standard normal distribution (Box and Muller; its tail ends at 8.5),
    /// outside the sample's dimensions.
    pub fn normal(&mut self) -> f64 {
        // The Gaussian spot of 1/e² radius 1 has a standard deviation of ½ along each axis.
        2.0 * warp::gaussian_spot([self.uniform(), self.uniform()])[0]
    }

    /// One number with the Poisson distribution of `mean` (finite, 0 or more), outside the sample's
    /// dimensions: exact up to means of [`LARGEST_EXACT_MEAN`](poisson::LARGEST_EXACT_MEAN), normal
    /// beyond.
    pub fn poisson(&mut self, mean: f64) -> f64 {
        if mean > poisson::LARGEST_EXACT_MEAN {
            return (mean + mean.sqrt() * self.normal()).round();
        }
        poisson::draw(mean, &mut || self.uniform())
    }
}

/// 53 random bits as a number in [0, 1).
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests;
