//! The whole chain against its analytic standard deviation; what random numbers depend on; series
//! of exposures.

use phicam::matrix::Matrix;
use phicam::num::statistics::{chi_square_sf, normal_two_sided};
use phicam::num::units::photon_energy;
use phicam::scene::SensorModel;
use phicam::sensor::{Exposure, Figures, Light, Range, Sensor, Stated};

use super::{SIGNIFICANCE, WAVELENGTH, expose};

/// z of every column: pixels are the repetitions, each spot is a level of light (electrons in a
/// second).
fn law_holds(figures: Figures, levels: &[f64], exposure: &Exposure, ambient: f64) {
    let pixels = 20_000;
    let watts = photon_energy(WAVELENGTH) / figures.quantum_efficiency;
    let flux = Matrix::from_fn(pixels, levels.len(), |_, l| levels[l] * watts);
    let light = Light::new(&flux, WAVELENGTH)
        .unwrap()
        .with_ambient(ambient * watts)
        .unwrap();
    let sensor = Sensor::new(figures).unwrap();
    let exposed = sensor.expose(&light, exposure, Stated::Oracle, 3).unwrap();
    let expected = sensor.expected(&light, exposure);
    for (l, level) in levels.iter().enumerate() {
        assert!(expected.bracket[l * pixels].is_some(), "{level} saturates");
        let z = |p: usize| {
            assert_eq!(exposed.range[p + l * pixels], Range::Within);
            assert_eq!(
                Some(exposed.bracket[p + l * pixels]),
                expected.bracket[p + l * pixels]
            );
            assert_eq!(exposed.stderr[(p, l)], expected.stderr[(p, l)]);
            (exposed.flux[(p, l)] - expected.flux[(p, l)]) / expected.stderr[(p, l)]
        };
        let z: Vec<f64> = (0..pixels).map(z).collect();
        let n = pixels as f64;
        let mean = z.iter().sum::<f64>() / n.sqrt();
        assert!(
            normal_two_sided(mean) > SIGNIFICANCE,
            "{level}: mean off by {mean} errors"
        );
        let p = chi_square_sf(z.iter().map(|z| z * z).sum(), n);
        assert!(p.min(1.0 - p) > 0.5 * SIGNIFICANCE, "{level}: p = {p}");
    }
}

/// Averaging, dark frames, ambient light, relative noise and a series, in every built-in sensor
/// that has noise.
#[test]
fn the_analytic_deviation_is_that_of_the_samples() {
    for model in [
        SensorModel::Ccd,
        SensorModel::Dslr,
        SensorModel::MachineVision,
    ] {
        let figures = *Sensor::builtin(model).figures();
        let single = Exposure::new(&[1.0], 1, 0).unwrap();
        law_holds(figures, &[20.0, 300.0, 1e4], &single, 50.0);
        let averaged = Exposure::new(&[1.0], 5, 3).unwrap();
        law_holds(figures, &[20.0, 300.0, 1e4], &averaged, 50.0);
        let noisy = Figures {
            relative_noise: 0.05,
            ..figures
        };
        law_holds(noisy, &[300.0, 1e4], &averaged, 50.0);
        let series = Exposure::new(&[0.01, 1.0, 0.1], 2, 4).unwrap();
        law_holds(figures, &[300.0, 1e4, 1.1e5, 1e6], &series, 5.0);
    }
}

/// Without noise to dither it, rounding is the same in every frame: averaging 64 of them gains
/// nothing.
#[test]
fn rounding_without_noise_does_not_average_out() {
    for read_noise in [0.0, 1.5] {
        let figures = Figures {
            gain: 10.0,
            bits: Some(12),
            read_noise,
            ..Figures::IDEAL
        };
        let pixels = 40_000;
        // An irrational step visits the places between two counts evenly.
        let watts = photon_energy(WAVELENGTH);
        let electrons = |p: usize| 100.0 + 0.618_033_988_749_894_9 * p as f64 % 10.0;
        let flux = Matrix::from_fn(pixels, 1, |p, _| electrons(p) * watts);
        let exposure = Exposure::new(&[1.0], 64, 0).unwrap();
        let exposed = expose(figures, &flux, &exposure, 1);
        let squares = (0..pixels).map(|p| (exposed.flux[p] - flux[p]).powi(2));
        let found = squares.sum::<f64>() / pixels as f64;
        let law = exposed.stderr[0] * exposed.stderr[0];
        assert!(law > 0.2 * (10.0 * watts).powi(2) / 12.0);
        assert!((found / law - 1.0).abs() < 0.02, "{found} of {law}");
    }
}

#[test]
fn noise_depends_neither_on_threads_nor_on_other_spots() {
    let figures = Figures {
        relative_noise: 0.01,
        ..*Sensor::builtin(SensorModel::MachineVision).figures()
    };
    let exposure = Exposure::new(&[1.0, 0.1], 2, 2).unwrap();
    let watts = photon_energy(WAVELENGTH);
    let flux = Matrix::from_fn(30, 20, |p, l| (10 * p + 1000 * l) as f64 * watts);
    let [one, four] = [1, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| expose(figures, &flux, &exposure, 5))
    });
    assert_eq!(one, four);
    let mut other = flux.clone();
    other.column_mut(3).fill(0.0);
    let other = expose(figures, &other, &exposure, 5);
    for l in (0..20).filter(|l| *l != 3) {
        assert_eq!(one.flux.column(l), other.flux.column(l));
    }
    assert_ne!(one.flux, expose(figures, &flux, &exposure, 6).flux);
}

#[test]
fn a_series_takes_the_longest_that_is_not_saturated_and_marks_what_none_can_hold() {
    let figures = Figures {
        full_well: 1000.0,
        ..Figures::IDEAL
    };
    let watts = photon_energy(WAVELENGTH);
    let flux = Matrix::from_row_slice(1, 4, &[999.0, 5000.0, 5e4, 5e5].map(|e| e * watts));
    let exposure = Exposure::new(&[0.01, 1.0, 0.1], 1, 0).unwrap();
    let exposed = expose(figures, &flux, &exposure, 1);
    assert_eq!(exposed.bracket, [0, 1, 2, 2]);
    let within = [Range::Within; 3];
    assert_eq!(exposed.range[..3], within);
    assert_eq!(exposed.range[3], Range::Saturated);
    for l in 0..3 {
        assert!((exposed.flux[l] / flux[l] - 1.0).abs() < 1e-14);
    }
    // Cut off at 1000 electrons in 10 ms.
    assert!((exposed.flux[3] / (1e5 * watts) - 1.0).abs() < 1e-14);
}

/// Entries have noise of their own; only the dark frames of a pixel are shared, so that two spots
/// correlate by their part of the variance.
#[test]
fn spots_share_their_dark_frames_and_nothing_else() {
    let figures = *Sensor::builtin(SensorModel::Dslr).figures();
    let pixels = 100_000;
    let watts = photon_energy(WAVELENGTH) / figures.quantum_efficiency;
    let flux = Matrix::from_element(pixels, 2, 100.0 * watts);
    for (dark_frames, shared) in [(0, 0.0), (1, 1.0)] {
        let exposure = Exposure::new(&[1.0], 1, dark_frames).unwrap();
        let exposed = expose(figures, &flux, &exposure, 11);
        // Electrons²: read noise and rounding in both, shot noise of the light only in one.
        let rest = 17.63f64.powi(2) + 4.1 * 4.1 / 12.0 + 0.5;
        let correlation = shared * rest / (rest + 100.0 + shared * rest);
        let z = |p: usize, l: usize| {
            (exposed.flux[(p, l)] - flux[(p, l)] - (1.0 - shared) * 0.5 * watts)
                / exposed.stderr[(p, l)]
        };
        let found = (0..pixels).map(|p| z(p, 0) * z(p, 1)).sum::<f64>() / pixels as f64;
        // Var(xy) = 1 + r² for normal numbers of correlation r.
        let error = ((1.0 + correlation * correlation) / pixels as f64).sqrt();
        let off = (found - correlation) / error;
        assert!(
            normal_two_sided(off) > SIGNIFICANCE,
            "{found} of {correlation}"
        );
        // Neighbouring pixels have nothing in common.
        let found =
            (1..pixels).map(|p| z(p, 0) * z(p - 1, 0)).sum::<f64>() / (pixels as f64).sqrt();
        assert!(normal_two_sided(found) > SIGNIFICANCE, "{found}");
    }
}
