//! Φ of every spot.

use super::correct::{Correction, Flat};
use super::error::{PhotographError, refused};
use super::footprints::Footprints;
use super::highest::Highest;
use super::left_out::{DEAD, HALO, MISSING, OUTSIDE, SATURATED, in_halo};
use super::noise::{CameraNoise, PhotonTransferFit};
use super::placing::Placing;
use super::plane::Averaged;
use super::read::Reader;
use super::set::Set;
use super::shots::Shots;
use super::takes::Take;
use crate::matrix::{Matrix, expected};
use crate::scene::Scene;

/// The columns of all spots.
pub(super) struct Columns {
    pub phi: Matrix,
    pub stderr: Matrix,
    pub left_out: Matrix,
    pub mean: Vec<f64>,
    pub gains: Vec<(usize, f64, f64)>,
    pub photographs: usize,
    pub zeros: f64,
    pub highest: Highest,
    /// How much too dark the light as a whole comes out, in its standard errors, where the variance
    /// of an entry is by its own light and entries are weighted by it.
    pub by_own_light: f64,
    /// Variance of the entries' variances over their squares, mean over the entries, where these
    /// follow from a line through repeats; 0 where the noise is given.
    pub unknown: f64,
    /// Part of the variance that is that of the dark frames, mean over the entries.
    pub common: f64,
    /// Part of the variance that is that of the flat field, mean over the entries.
    pub of_flat: f64,
    /// What the dark frames' rounding, alike in all pixels, moves entries by, over their standard
    /// errors, root mean square.
    pub rounded: f64,
}

impl Columns {
    /// Φ of every spot.
    pub(super) fn of(
        set: &Set,
        scene: &Scene,
        (shots, placing): (&Shots<'_>, &Placing),
        (noise, line): (Option<CameraNoise>, Option<&PhotonTransferFit>),
        reader: &mut Reader<'_>,
    ) -> Result<Self, PhotographError> {
        let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
        let flat = match &shots.flat {
            None => None,
            Some((shot, dark)) => Some(Flat::new(
                shot,
                dark.as_ref(),
                noise,
                placing.mapping.lens(),
            )?),
        };
        let mut dead = shots.dead.clone();
        if let Some(flat) = &flat {
            dead.iter_mut()
                .zip(&flat.unusable)
                .for_each(|(dead, bad)| *dead |= bad);
        }
        let mut found = Self {
            phi: Matrix::zeros(pixels, spots),
            stderr: Matrix::zeros(pixels, spots),
            left_out: Matrix::from_element(pixels, spots, f64::from(MISSING)),
            mean: vec![0.0; shots.size[0] * shots.size[1]],
            gains: Vec::new(),
            photographs: 0,
            zeros: 0.0,
            highest: Highest::default(),
            by_own_light: 0.0,
            unknown: 0.0,
            common: 0.0,
            of_flat: 0.0,
            rounded: 0.0,
        };
        let mut known = 0usize;
        let mut slopes = Matrix::zeros(pixels, spots);
        let weights = placing.footprints.gathered(&vec![1.0; found.mean.len()]);
        let code = Codes {
            set,
            scene,
            footprints: &placing.footprints,
            dead: &dead,
        };
        let mut seen = 0usize;
        let visit = |spot: usize, take: &Take, mean: Averaged| {
            let name = take.path.to_string_lossy();
            let correction = Correction {
                dark: shots.dark(take)?,
                shortest: shots.shortest_dark(),
                flat: flat.as_ref(),
                noise,
                exposure: take.exposure.unwrap_or(1.0),
            };
            let corrected = correction.apply(&name, &mean)?;
            found.photographs += mean.frames;
            found.zeros += mean.cut_off();
            found.highest.add(&mean.highest);
            found.common += corrected.common;
            found.of_flat += corrected.of_flat;
            seen += 1;
            for (mean, flux) in found.mean.iter_mut().zip(&corrected.flux) {
                *mean += flux;
            }
            let factor = set.watts.unwrap_or(1.0) / take.gain;
            if (take.gain, take.gain_error) != (1.0, 0.0) {
                found.gains.push((spot, take.gain, take.gain_error));
            }
            let flux = placing.footprints.gathered(&corrected.flux);
            let variance = corrected
                .variance
                .map(|v| placing.footprints.gathered_variance(&v));
            let slope = placing.footprints.gathered_variance(&corrected.slope);
            let below = correction.shortest.map(|dark| &dark.light);
            let above = |k: usize| mean.light[k] - below.map_or(0.0, |dark| dark[k]);
            let unknown = line.map(|line| {
                let each = (0..mean.light.len()).map(|k| line.unknown(above(k), mean.rounding[k]));
                placing.footprints.gathered(&each.collect::<Vec<f64>>())
            });
            for pixel in 0..pixels {
                let code = code.of(spot, pixel, &mean.saturated);
                found.left_out[(pixel, spot)] = f64::from(code);
                if code != 0 {
                    continue;
                }
                let value = factor * flux[pixel];
                found.phi[(pixel, spot)] = value;
                if let Some(variance) = &variance {
                    // All pixels share the gain's error: it is not one of the entry.
                    found.stderr[(pixel, spot)] = factor * variance[pixel].sqrt();
                    if let Some(unknown) = &unknown {
                        found.unknown += unknown[pixel] / weights[pixel];
                    }
                    if variance[pixel] > 0.0 {
                        found.rounded +=
                            (corrected.rounded * weights[pixel]).powi(2) / variance[pixel];
                        known += 1;
                    }
                    slopes[(pixel, spot)] = factor * slope[pixel] / weights[pixel];
                }
            }
            Ok(())
        };
        shots.each_spot(reader, visit)?;
        found.mean.iter_mut().for_each(|x| *x /= seen.max(1) as f64);
        found.common /= seen.max(1) as f64;
        found.of_flat /= seen.max(1) as f64;
        found.rounded = (found.rounded / known.max(1) as f64).sqrt();
        found.unknown /= known.max(1) as f64;
        if found.phi.iter().any(|x| !x.is_finite()) {
            return Err(refused(
                "a flux comes out as infinite",
                "check `watts`, `gain` and the exposure times",
            ));
        }
        if noise.is_some() {
            found.expect(&slopes)?;
        }
        Ok(found)
    }

    /// Puts standard errors of the expected light in place of those of the light measured, which
    /// raise variances by `slopes`, W.
    fn expect(&mut self, slopes: &Matrix) -> Result<(), PhotographError> {
        let variance = self.stderr.map(|s| s * s);
        let noise = slopes.zip_map(&variance, |k, v| k * k * v);
        let found = expected(&variance, &noise, Some(&self.left_out)).map_err(|e| {
            let cause = format!("the variances of the photographs have no decomposition: {e}");
            refused(
                cause,
                "look for photographs without light, or far out of scale",
            )
        })?;
        if let Some(variance) = found {
            self.stderr = variance.map(f64::sqrt);
            return Ok(());
        }
        // Σ k Φ/V less than the Σ Φ²/V of the least squares, whose error is its root.
        let known = (0..variance.len()).filter(|at| variance[*at] > 0.0);
        let [less, all] = known.fold([0.0; 2], |[less, all], at| {
            let by = self.phi[at] / variance[at];
            [less + slopes[at] * by, all + self.phi[at] * by]
        });
        self.by_own_light = less / all.max(f64::MIN_POSITIVE).sqrt();
        Ok(())
    }
}

/// Why entries are left out.
struct Codes<'a> {
    set: &'a Set,
    scene: &'a Scene,
    footprints: &'a Footprints,
    dead: &'a [bool],
}

impl Codes<'_> {
    /// Why an entry is left out; 0 if it is not.
    fn of(&self, spot: usize, pixel: usize, saturated: &[bool]) -> u8 {
        let mut code = 0;
        if self.footprints.is_outside(pixel) {
            code |= OUTSIDE;
        }
        if self.footprints.touches(pixel, saturated) {
            code |= SATURATED;
        }
        if self.footprints.touches(pixel, self.dead) {
            code |= DEAD;
        }
        let at = self.scene.laser.spots[spot].target.position;
        if self
            .set
            .halo
            .is_some_and(|radius| in_halo(&self.scene.camera, pixel, at, radius))
        {
            code |= HALO;
        }
        code
    }
}
