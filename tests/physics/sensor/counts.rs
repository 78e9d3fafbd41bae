//! Standard deviations from counts alone, and exposure times chosen by counts, against the flux
//! that was photographed.

use phicam::matrix::Matrix;
use phicam::model::{Extent, Kernel, converged};
use phicam::num::statistics::sidak_threshold;
use phicam::num::units::photon_energy;
use phicam::scene::{Scene, SensorModel};
use phicam::sensor::{Exposure, Figures, Light, Range, Sensor, Stated};
use phicam::transport::{Budget, Control, Estimator, Plan, Sampling, render};

use super::{SIGNIFICANCE, WAVELENGTH};
use crate::builtin;

const REAL: [SensorModel; 3] = [
    SensorModel::Ccd,
    SensorModel::Dslr,
    SensorModel::MachineVision,
];

/// `pixels` repetitions of each level of light (electrons in a second).
fn levels(figures: &Figures, pixels: usize, levels: &[f64]) -> Matrix {
    let watts = photon_energy(WAVELENGTH) / figures.quantum_efficiency;
    Matrix::from_fn(pixels, levels.len(), |_, l| levels[l] * watts)
}

/// χ²/dof against the true flux is 1 within 2 % from no light at all to half a full well, one frame
/// or several, with dark frames; and a mean weighted by 1/σ² has no bias, which weights from the
/// frames themselves would give it: an electron, or √(n/V) standard errors of a mean of n entries.
#[test]
fn deviations_from_counts_are_those_of_the_samples() {
    let pixels = 100_000;
    let electrons = [0.0, 1.0, 3.0, 10.0, 30.0, 300.0, 6000.0];
    for model in REAL {
        let sensor = Sensor::builtin(model);
        let stated = Stated::Counts(sensor.photon_transfer(2));
        let flux = levels(sensor.figures(), pixels, &electrons);
        let light = Light::new(&flux, WAVELENGTH).unwrap();
        for (frames, dark_frames) in [(1, 64), (4, 256)] {
            let exposure = Exposure::new(&[1.0], frames, dark_frames).unwrap();
            let taken = sensor.expose(&light, &exposure, stated, 5).unwrap();
            for (l, level) in electrons.iter().enumerate() {
                let (mut chi2, mut sum, mut weights) = (0.0, 0.0, 0.0);
                for p in 0..pixels {
                    let (off, s) = (taken.flux[(p, l)] - flux[(p, l)], taken.stderr[(p, l)]);
                    chi2 += off * off / (s * s);
                    sum += off / (s * s);
                    weights += 1.0 / (s * s);
                }
                let per_entry = chi2 / pixels as f64;
                let account = format!("{model:?}, {level} electrons, {frames} frames: {per_entry}");
                assert!((per_entry - 1.0).abs() < 0.02, "{account}");
                let off = sum / weights.sqrt();
                assert!(
                    off.abs() < sidak_threshold(SIGNIFICANCE, 42),
                    "{account}, {off} errors low"
                );
            }
        }
    }
}

/// Of entries around the full well a series gives the flux itself, band by band: the mean of many
/// exposures, within its standard error, and no entry is left out.
#[test]
fn a_series_is_unbiased_in_every_band_around_the_full_well() {
    let pixels = 40_000;
    for model in REAL {
        let sensor = Sensor::builtin(model);
        let full = sensor.figures().full_well;
        let electrons: Vec<f64> = (0..36)
            .map(|k| full * (0.85 + 0.005 * f64::from(k)))
            .collect();
        let flux = levels(sensor.figures(), pixels, &electrons);
        let light = Light::new(&flux, WAVELENGTH).unwrap();
        let exposure = Exposure::new(&[1.0, 0.25], 2, 400).unwrap();
        let stated = Stated::Counts(sensor.photon_transfer(1));
        let taken = sensor.expose(&light, &exposure, stated, 3).unwrap();
        assert_eq!(taken.count(Range::Within), taken.flux.len());
        let limit = sidak_threshold(SIGNIFICANCE, 3 * 36);
        let mut mixed = 0;
        for l in 0..electrons.len() {
            let errors = (0..pixels).map(|p| taken.flux[(p, l)] - flux[(p, l)]);
            let mean = errors.sum::<f64>() / pixels as f64;
            let variance = taken.stderr.column(l).norm_squared() / pixels as f64;
            let z = mean / (variance / pixels as f64).sqrt();
            assert!(z.abs() < limit, "{model:?}: level {l} is off by {z} errors");
            let brackets = &taken.bracket[l * pixels..(l + 1) * pixels];
            mixed += usize::from(brackets.contains(&0) && brackets.contains(&1));
        }
        assert!(mixed > 0, "{model:?}: no band is taken from both exposures");
    }
}

/// What every exposure brings near the full well is marked, though no frame of it is saturated.
#[test]
fn what_is_near_the_full_well_in_every_exposure_is_marked() {
    let sensor = Sensor::builtin(SensorModel::Ccd);
    let flux = levels(sensor.figures(), 100, &[35_000.0, 69_300.0, 140_000.0]);
    let light = Light::new(&flux, WAVELENGTH).unwrap();
    let exposure = Exposure::new(&[1.0], 1, 0).unwrap();
    let taken = sensor.expose(&light, &exposure, Stated::Oracle, 1).unwrap();
    let count = |l: usize, range| {
        taken.range[l * 100..(l + 1) * 100]
            .iter()
            .filter(|r| **r == range)
            .count()
    };
    assert_eq!(count(0, Range::Within), 100);
    // 2.6 standard deviations below: one in 200 is saturated.
    assert!(count(1, Range::Near) > 90, "{}", count(1, Range::Near));
    assert_eq!(count(1, Range::Within), 0);
    assert_eq!(count(2, Range::Saturated), 100);
}

/// A scene, traced at `samples` a pixel and spot, and its converged quadrature.
struct Traced {
    scene: Scene,
    flux: Matrix,
    stderr: Matrix,
    blocks: u32,
    model: Matrix,
}

impl Traced {
    fn new(scene: Scene, samples: u64) -> Self {
        let plan = Plan {
            estimator: Estimator::Independent,
            sampling: Sampling::Sobol,
            seed: 1,
            budget: Budget::new(samples, Sampling::Sobol).unwrap(),
        };
        let spots = 0..scene.laser.spots.len();
        let traced = render(&scene, &plan, spots, Control::none()).unwrap();
        let model = converged(&scene, Kernel::Physical, Extent::FULL).unwrap();
        Self {
            flux: traced.flux,
            stderr: traced.stderr,
            blocks: plan.budget.blocks,
            model: model.phi,
            scene,
        }
    }

    /// χ²/dof of its photographs against the quadrature, σ from counts alone and the render's own
    /// error in it.
    fn chi2(&self, model: SensorModel, frames: u32) -> f64 {
        let sensor = Sensor::builtin(model);
        let wavelength = self.scene.laser.wavelength;
        let light = Light::new(&self.flux, wavelength)
            .unwrap()
            .with_render_error(&self.stderr, self.blocks)
            .unwrap();
        let time = sensor.longest_exposure(self.flux.max(), wavelength);
        let exposure = Exposure::new(&[time], frames, 64 * frames).unwrap();
        let stated = Stated::Counts(sensor.photon_transfer(1));
        let taken = sensor.expose(&light, &exposure, stated, 1).unwrap();
        assert_eq!(taken.count(Range::Within), taken.flux.len());
        let z = (&taken.flux - &self.model).component_div(&taken.stderr);
        z.norm_squared() / z.len() as f64
    }
}

#[test]
fn photographs_of_the_bench_agree_with_the_model() {
    let traced = Traced::new(builtin("bench", &[]), 64);
    for frames in [1, 16] {
        let found = traced.chi2(SensorModel::MachineVision, frames);
        // Five standard deviations of the mean of 30720 squares are 0.04.
        assert!((found - 1.0).abs() < 0.04, "{frames}: {found}");
    }
}

/// Three scenes and every built-in sensor, at the default number of samples; of the card the middle
/// ninth of its view, more entries than the bench has.
#[test]
#[ignore = "slow"]
fn photographs_of_three_scenes_agree_with_the_model() {
    let middle = (
        "x = [0, 95], y = [0, 63] }\npixels = [72, 48]",
        "x = [31.6667, 63.3333], y = [21, 42] }\npixels = [24, 16]",
    );
    let mut told = Vec::new();
    for (name, changes) in [("bench", &[][..]), ("satin", &[]), ("card", &[middle])] {
        let traced = Traced::new(builtin(name, changes), 512);
        for model in SensorModel::ALL {
            for frames in [1, 16] {
                told.push((name, model, frames, traced.chi2(model, frames)));
            }
        }
    }
    println!("{told:?}");
    assert!(told.iter().all(|t| (t.3 - 1.0).abs() < 0.02), "{told:?}");
}
