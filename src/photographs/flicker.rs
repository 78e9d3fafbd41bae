//! By what photographs of one spot differ as wholes: the laser's flicker, or a drift of the dark
//! level.
//!
//! The light of a whole photograph T = Σ s over its pixels has, by the noise of these alone, the
//! variance Σ var s. What repeats scatter more is a factor 1 ± f that all pixels of a photograph
//! share,
//!
//! > f² = (var T − Σ var s)/T²,   Σ ν var T/Σ var s ~ χ² of Σ ν without any,
//!
//! over ν = repeats − 1 of each spot. Of the mean of n repeats it leaves f/√n, which no standard
//! error of single entries holds.

use super::plane::Averaged;
use crate::num::statistics::chi_square_sf;

/// Probability by the noise of pixels alone below which photographs differ as wholes.
const SURELY: f64 = 1e-3;

/// Sums over spots.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Flicker {
    excess: f64,
    light: f64,
    chi2: f64,
    freedom: f64,
    repeats: f64,
}

impl Flicker {
    /// One more spot, of which the dark frames are `below`.
    pub(super) fn add(&mut self, spot: &Averaged, below: Option<&Averaged>) {
        let Some([whole, due]) = spot.of_wholes().filter(|[_, due]| *due > 0.0) else {
            return;
        };
        let freedom = (spot.frames - 1) as f64;
        let light = spot.light_above(below);
        self.excess += freedom * (whole - due);
        self.light += freedom * light * light;
        self.chi2 += freedom * whole / due;
        self.freedom += freedom;
        self.repeats += freedom * spot.frames as f64;
    }

    /// f of one photograph and of the mean of a spot's repeats; none where their noise explains how
    /// they differ.
    pub(super) fn found(self) -> Option<[f64; 2]> {
        let is_more = self.freedom > 0.0 && chi_square_sf(self.chi2, self.freedom) < SURELY;
        let square = self.excess / self.light;
        (is_more && square > 0.0).then(|| {
            let own = square.sqrt();
            [own, own / (self.repeats / self.freedom).sqrt()]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::stream::{Key, Sampling, Stream};
    use crate::photographs::highest::Highest;
    use crate::photographs::plane::Plane;

    /// 40 spots of 4 repeats, 400 pixels of 1000 counts ± 30 over a dark level of 100: a flicker of
    /// 1 % is found within four of its errors, 1/√(2·120) of itself, none where there is none.
    #[test]
    fn a_flicker_is_found_and_none_is_made_up() {
        let plane = |light: Vec<f64>| Plane {
            size: [20, 20],
            rounding: vec![0.0; light.len()],
            saturated: vec![false; light.len()],
            light,
            share: 1.0,
            zeros: 0,
            highest: Highest::default(),
        };
        let dark = Averaged::of(plane(vec![100.0; 400]));
        for (flicker, seed) in [(0.01, 1), (0.0, 2), (0.0, 3)] {
            let key = Key {
                seed,
                spot: 0,
                pixel: 0,
                block: 0,
            };
            let mut stream = Stream::new(Sampling::Pcg, key);
            // Irwin and Hall: twelve uniform numbers, variance 1.
            let mut normal = || (0..12).map(|_| stream.uniform()).sum::<f64>() - 6.0;
            let mut found = Flicker::default();
            for _ in 0..40 {
                let mut one = || {
                    let factor = 1.0 + flicker * normal();
                    plane(
                        (0..400)
                            .map(|_| 100.0 + 1000.0 * factor + 30.0 * normal())
                            .collect(),
                    )
                };
                let mut spot = Averaged::of(one());
                (0..3).for_each(|_| spot.add("", &one()).unwrap());
                found.add(&spot, Some(&dark));
            }
            match found.found() {
                Some([own, of_mean]) => {
                    let off = (own / flicker - 1.0) * f64::sqrt(2.0 * 120.0);
                    assert!(off.abs() < 4.0, "{own}");
                    assert!((of_mean - 0.5 * own).abs() < 1e-12);
                }
                None => assert_eq!(flicker, 0.0),
            }
        }
    }
}
