//! Each axis of noise against what it says of itself.

use super::*;
use crate::lab::studies::noise::named_sensor::NamedSensor;
use crate::scene::{SensorModel, Spread};

fn exact() -> Matrix {
    Matrix::from_fn(12, 36, |p, l| 1e-15 * (1.0 + p as f64 + 0.37 * l as f64))
}

fn stage(axis: &NoiseAxis, exact: &Matrix) -> Stage {
    Stage::new(axis, &Scene::load("bench").unwrap(), exact.clone()).unwrap()
}

/// √(mean of ((Φ − exact)/σ)²) over entries and `seeds`.
fn spread(stage: &Stage, level: f64, seeds: u64) -> f64 {
    let squares: f64 = (0..seeds)
        .map(|seed| {
            let taken = stage.photograph(level, seed).unwrap();
            let error = (taken.phi - &stage.exact).component_div(&taken.stderr);
            error.norm_squared() / error.len() as f64
        })
        .sum();
    (squares / seeds as f64).sqrt()
}

/// The relative noise of an entry is 1/√(its photons), and the photons are `level` on average.
#[test]
fn photons_make_shot_noise() {
    let exact = exact();
    let stage = stage(&NoiseAxis::Photons, &exact);
    for level in [30.0, 1e6, 1e18] {
        let told = stage.photograph(level, 1).unwrap().stderr;
        for (at, x) in exact.iter().enumerate() {
            let photons = level * x / exact.mean();
            assert!((told[at] / x * photons.sqrt() - 1.0).abs() < 1e-12);
        }
        assert_eq!(told, stage.stderr(level).unwrap());
    }
    // 432·40 squares of nearly normal numbers: five standard errors of the root of their mean.
    let limit = 5.0 / (2.0 * 432.0 * 40.0f64).sqrt();
    for level in [30.0, 1e6] {
        let found = spread(&stage, level, 40);
        assert!((found - 1.0).abs() < limit, "{level:e}: {found}");
    }
}

/// A count is the brightest entry over 80 % of the range; the recovery is told count/√12, no
/// entry is wrong by more than half a count, and over entries and offsets the errors spread as
/// told.
#[test]
fn bits_make_rounding_alone() {
    let exact = exact();
    let stage = stage(&NoiseAxis::Bits, &exact);
    for (bits, top) in [(4.0, 15.0), (10.0, 1023.0), (24.0, 16_777_215.0)] {
        let count = exact.max() / (0.8 * top);
        let taken = stage.photograph(bits, 3).unwrap();
        let sigma = count / 12f64.sqrt();
        assert!(taken.stderr.iter().all(|s| (s / sigma - 1.0).abs() < 1e-12));
        assert!((taken.phi - &exact).amax() <= count * (0.5 + 1e-6));
        // Squares of even errors have a variance of 0.8 of theirs; offsets are common to the
        // entries of a draw, so draws alone count.
        let limit = 5.0 * (0.8f64 / 400.0).sqrt() / 2.0;
        let found = spread(&stage, bits, 400);
        assert!((found - 1.0).abs() < limit, "{bits}: {found}");
    }
}

/// Without any noise of the sensor what is there beyond the signal is the glare, of the size
/// asked for, and the recovery is not told.
#[test]
fn glare_is_a_bias() {
    let scene = Scene::load("bench").unwrap();
    let spots = scene.laser.spots.len();
    let exact = Matrix::from_element(scene.camera.pixels(), spots, 2e-15);
    let sensor = NamedSensor::builtin;
    for spread in [Spread::Uniform, Spread::Falloff(1.0)] {
        let axis = NoiseAxis::Glare(sensor(SensorModel::Ideal), spread);
        let stage = stage(&axis, &exact);
        for level in [1e-3, 2.0] {
            let taken = stage.photograph(level, 1).unwrap();
            let more = (taken.phi - &exact).sum() / exact.sum();
            assert!((more / level - 1.0).abs() < 1e-9, "{level}: {more}");
            assert!(taken.stderr.iter().all(|s| *s == 0.0));
        }
    }
    // With noise: a real sensor is told of that of signal and glare, at half of its well.
    let axis = NoiseAxis::Glare(sensor(SensorModel::Ccd), Spread::Uniform);
    let stage = stage(&axis, &exact);
    let taken = stage.photograph(1.0, 1).unwrap();
    let light = &exact + stage.shot(1.0, 0.0).unwrap().glare.unwrap();
    let relative = taken.stderr.max() / light.max();
    assert!(
        (relative * 35_000f64.sqrt() - 1.0).abs() < 0.02,
        "{relative}"
    );
}

/// Of 4000 draws the mean over the entries, exact/(1 + s ξ) apart, is normal: mean 1, standard
/// deviation s and fourth moment 3 s⁴, each within five of its errors. Entries differ from
/// their draw's scale by the noise that is told, and joint methods are told s.
#[test]
fn a_scale_is_common_to_all_entries() {
    let exact = exact();
    let stage = stage(&NoiseAxis::Scale, &exact);
    let (s, draws) = (0.03, 4000u32);
    let mut moments = [0.0; 3];
    for seed in 0..u64::from(draws) {
        let taken = stage.photograph(s, seed).unwrap();
        let ratio = taken.phi.component_div(&exact);
        let off = (ratio.mean() - 1.0) / s;
        for (power, moment) in [1, 2, 4].into_iter().zip(&mut moments) {
            *moment += off.powi(power) / f64::from(draws);
        }
        let left = (ratio / (1.0 + s * off)).add_scalar(-1.0);
        let rms = (left.norm_squared() / left.len() as f64).sqrt();
        assert!((rms / 1e-3 - 1.0).abs() < 0.2, "{seed}: {rms}");
        assert!((taken.stderr.component_div(&taken.phi).mean() / 1e-3 - 1.0).abs() < 0.01);
        assert_eq!(taken.scale_error, Some(s));
    }
    // Variances of ξ, ξ² and ξ⁴: 1, 2 and 96.
    let expected = [(0.0, 1.0), (1.0, 2.0), (3.0, 96.0)];
    for (found, (mean, variance)) in moments.into_iter().zip(expected) {
        let error = (variance / f64::from(draws)).sqrt();
        assert!((found - mean).abs() < 5.0 * error, "{moments:?}");
    }
    // Of a scale known to its own size some draws leave no light, and say so.
    let dark = (0..100).filter_map(|seed| stage.photograph(1.0, seed).err());
    let dark: Vec<String> = dark.collect();
    assert!(
        (5..30).contains(&dark.len()) && dark[0].contains("no light"),
        "{dark:?}"
    );
}

/// The frames that a scene gives its sensor are averaged: a hundred have a tenth of the error
/// of one, a hundred dark frames that of one.
#[test]
fn the_scenes_frames_are_taken() {
    let exact = Matrix::from_element(12, 36, 2e-15);
    let error = |frames: u32| {
        let sensor = format!(
            "\n[sensor]\nmodel = \"ccd\"\nexposure = 0.1\nframes = {frames}\ndark_frames = {frames}\n"
        );
        let text = Scene::load("bench").unwrap().text + &sensor;
        let scene = Scene::from_toml("own", &text).unwrap();
        let axis = NoiseAxis::Exposure(NamedSensor::studied(None, &scene).unwrap());
        assert!(frames == 1 || axis.label().sensor.unwrap().contains("frames 100"));
        stage(&axis, &exact).stderr(0.1).unwrap().mean()
    };
    let ratio = error(1) / error(100);
    assert!((ratio - 10.0).abs() < 1e-6, "{ratio}");
}

/// What the size of the standard errors is said to be on an axis it is, of every entry.
#[test]
fn standard_errors_grow_as_the_axis_says() {
    let exact = exact();
    for (axis, [a, b]) in [
        (NoiseAxis::Relative, [1e-9, 0.1]),
        (NoiseAxis::Photons, [1e12, 3.0]),
        (NoiseAxis::Bits, [24.0, 5.0]),
    ] {
        let stage = stage(&axis, &exact);
        let [low, high] = [a, b].map(|level| stage.stderr(level).unwrap());
        let ratio = axis.size(b).unwrap() / axis.size(a).unwrap();
        assert!(ratio > 1.0);
        for (l, h) in low.iter().zip(high.iter()) {
            assert!((h / l / ratio - 1.0).abs() < 1e-12, "{axis:?}");
        }
    }
}
