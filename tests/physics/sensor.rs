//! The sensor chain against the distributions that each stage must follow, and against its own law.

use phicam::matrix::Matrix;
use phicam::num::statistics::{chi_square_sf, normal_two_sided};
use phicam::num::units::photon_energy;
use phicam::scene::{Glare, Scene, SensorModel, Spread};
use phicam::sensor::{
    Exposed, Exposure, Figures, Light, Range, Sensor, ShotNoise, entering_lens, glare,
};

const WAVELENGTH: f64 = 632.8e-9;
/// Probability with which each of these tests may reject a right program; the seeds are fixed.
const SIGNIFICANCE: f64 = 1e-4;
/// Samples of a distribution: a matrix of a thousand by a thousand.
const SIDE: usize = 1000;

/// Φ of the standard normal distribution.
fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

/// e^(k ln μ − μ − ln k!).
fn poisson(count: f64, mean: f64) -> f64 {
    libm::exp(count * libm::log(mean) - mean - libm::lgamma(count + 1.0))
}

/// A million entries of `mean` photons in a second.
fn uniform(mean: f64) -> Matrix {
    Matrix::from_element(SIDE, SIDE, mean * photon_energy(WAVELENGTH))
}

fn expose(figures: Figures, flux: &Matrix, exposure: &Exposure, seed: u64) -> Exposed {
    let light = Light::new(flux, WAVELENGTH).unwrap();
    Sensor::new(figures)
        .unwrap()
        .expose(&light, exposure, seed)
        .unwrap()
}

/// The counts of a million single frames of one second.
fn counts(figures: Figures, mean: f64) -> (Vec<f64>, Exposed) {
    let exposure = Exposure::new(&[1.0], 1, 0).unwrap();
    let exposed = expose(figures, &uniform(mean), &exposure, 7);
    (exposed.counts[0].iter().copied().collect(), exposed)
}

/// χ² of numbers in the bins (−∞, e0), [e0, e1), … [en, ∞) whose probabilities are given.
fn agrees(samples: &[f64], edges: &[f64], probabilities: &[f64]) {
    assert_eq!(edges.len() + 1, probabilities.len());
    let total: f64 = probabilities.iter().sum();
    assert!((total - 1.0).abs() < 1e-6, "probabilities sum to {total}");
    let mut found = vec![0.0; probabilities.len()];
    for x in samples {
        found[edges.partition_point(|e| e <= x)] += 1.0;
    }
    let n = samples.len() as f64;
    let chi2: f64 = (found.iter().zip(probabilities))
        .map(|(f, p)| {
            assert!(n * p >= 5.0, "a bin with {} expected", n * p);
            (f - n * p) * (f - n * p) / (n * p)
        })
        .sum();
    let p = chi_square_sf(chi2, (probabilities.len() - 1) as f64);
    assert!(
        p > SIGNIFICANCE,
        "χ² {chi2} in {} bins: p = {p}",
        probabilities.len()
    );
}

/// The sample variance against `variance`; `excess` is the distribution's excess kurtosis.
fn variance_agrees(samples: &[f64], variance: f64, excess: f64) {
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let found = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    let z = (found / variance - 1.0) / ((2.0 + excess) / n).sqrt();
    assert!(
        normal_two_sided(z) > SIGNIFICANCE,
        "variance {found} of {variance}: z = {z}"
    );
}

fn shot_only() -> Figures {
    Figures {
        shot_noise: ShotNoise::Poisson,
        ..Figures::IDEAL
    }
}

#[test]
fn shot_noise_is_poisson_at_every_mean() {
    for mean in [0.3, 3.7, 9.99, 10.01, 40.0, 5e4, 1e7] {
        let (samples, _) = counts(shot_only(), mean);
        let reach = 9.0 * mean.sqrt() + 30.0;
        let lowest = (mean - reach).floor().max(0.0);
        let step = (mean.sqrt() / 10.0).ceil();
        // Bins of `step` counts; those with less than ten expected go to the tails.
        let bins: Vec<(f64, f64)> = (0..)
            .map(|i| lowest + step * f64::from(i))
            .take_while(|low| *low < mean + reach)
            .map(|low| {
                let own = (0..step as u32).map(|i| poisson(low + f64::from(i), mean));
                (low, own.sum())
            })
            .collect();
        let kept: Vec<(f64, f64)> = bins.iter().copied().filter(|b| b.1 > 1e-5).collect();
        let (first, last) = (kept[0], kept[kept.len() - 1]);
        let below: f64 = bins.iter().filter(|b| b.0 <= first.0).map(|b| b.1).sum();
        let above: f64 = bins.iter().filter(|b| b.0 >= last.0).map(|b| b.1).sum();
        let edges: Vec<f64> = kept[1..].iter().map(|b| b.0).collect();
        let mut probabilities = vec![below];
        probabilities.extend(kept[1..kept.len() - 1].iter().map(|b| b.1));
        probabilities.push(above);
        agrees(&samples, &edges, &probabilities);
        variance_agrees(&samples, mean, 1.0 / mean);
        assert!(samples.iter().all(|x| x.fract() == 0.0));
    }
}

#[test]
fn read_noise_is_normal() {
    let figures = Figures {
        read_noise: 5.0,
        ..Figures::IDEAL
    };
    let (samples, _) = counts(figures, 1000.0);
    let edges: Vec<f64> = (-40..=40)
        .map(|i| 1000.0 + 5.0 * f64::from(i) / 10.0)
        .collect();
    let cdf: Vec<f64> = edges
        .iter()
        .map(|e| normal_cdf((e - 1000.0) / 5.0))
        .collect();
    let mut probabilities = vec![cdf[0]];
    probabilities.extend(cdf.windows(2).map(|c| c[1] - c[0]));
    probabilities.push(normal_cdf(-4.0));
    agrees(&samples, &edges, &probabilities);
    // The same as a test of the variance alone: (n − 1)s²/σ² has the χ² distribution, both tails.
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let chi2 = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 25.0;
    let p = chi_square_sf(chi2, n - 1.0);
    assert!(p.min(1.0 - p) > 0.5 * SIGNIFICANCE, "{chi2}");
}

/// Every count of a converter that rounds normal numbers: from noise below a step to noise of several.
#[test]
fn quantisation_rounds_as_the_normal_distribution_says() {
    for deviation in [0.3, 0.7, 4.0] {
        let gain = 3.0;
        let figures = Figures {
            read_noise: deviation * gain,
            gain,
            bits: Some(12),
            offset: 20.0,
            ..Figures::IDEAL
        };
        let (samples, exposed) = counts(figures, 301.0);
        assert_eq!(exposed.count(Range::Within), samples.len());
        let mean = 301.0 / gain + 20.0;
        let lowest = (mean - 4.0 * deviation).round();
        let highest = (mean + 4.0 * deviation).round();
        let cdf = |x: f64| normal_cdf((x - 0.5 - mean) / deviation);
        let edges: Vec<f64> = (lowest as i32 + 1..=highest as i32)
            .map(f64::from)
            .collect();
        let mut probabilities = vec![cdf(edges[0])];
        probabilities.extend(edges.windows(2).map(|e| cdf(e[1]) - cdf(e[0])));
        probabilities.push(1.0 - cdf(highest));
        agrees(&samples, &edges, &probabilities);
        assert!(samples.iter().all(|x| x.fract() == 0.0));
        if deviation > 0.5 {
            let variance = deviation * deviation + 1.0 / 12.0;
            variance_agrees(&samples, variance, 0.0);
        }
    }
}

/// How often the highest count, the lowest and the full well are reached.
#[test]
fn saturation_is_as_frequent_as_its_tail() {
    let figures = Figures {
        read_noise: 8.0,
        bits: Some(8),
        offset: 10.0,
        ..Figures::IDEAL
    };
    let share = |found: usize, p: f64| {
        let n = (SIDE * SIDE) as f64;
        let z = (found as f64 - n * p) / (n * p * (1.0 - p)).sqrt();
        assert!(
            normal_two_sided(z) > SIGNIFICANCE,
            "{found} of {n}·{p}: z = {z}"
        );
    };
    let (samples, exposed) = counts(figures, 240.0);
    share(exposed.count(Range::Saturated), normal_cdf(-4.5 / 8.0));
    assert!(
        (samples.iter().zip(&exposed.range))
            .all(|(x, r)| (*x == 255.0) == (*r == Range::Saturated))
    );
    let (samples, exposed) = counts(figures, 3.0);
    share(exposed.count(Range::Floored), normal_cdf(-13.5 / 8.0));
    assert!(samples.iter().all(|x| *x >= 0.0));
    let figures = Figures {
        full_well: 110.0,
        ..shot_only()
    };
    let (samples, exposed) = counts(figures, 100.0);
    let tail: f64 = 1.0 - (0..=110).map(|k| poisson(f64::from(k), 100.0)).sum::<f64>();
    share(exposed.count(Range::Saturated), tail);
    assert!(samples.iter().all(|x| *x <= 110.0));
}

#[test]
fn energy_is_conserved_through_the_ideal_sensor() {
    let flux = Matrix::from_fn(64, 50, |p, l| {
        let exponent = -20.0 + 0.3 * p as f64 + 0.05 * l as f64;
        libm::exp10(exponent) * (1.0 + 0.1 * libm::sin((p * 50 + l) as f64))
    });
    let ideal = Sensor::builtin(SensorModel::Ideal);
    for (time, frames, dark, wavelength) in [
        (1.0, 1, 0, 632.8e-9),
        (1e-3, 7, 3, 405e-9),
        (3600.0, 10, 1, 1064e-9),
    ] {
        let light = Light::new(&flux, wavelength).unwrap();
        let exposure = Exposure::new(&[time], frames, dark).unwrap();
        let exposed = ideal.expose(&light, &exposure, 1).unwrap();
        for (out, clean) in exposed.flux.iter().zip(&flux) {
            assert!((out / clean - 1.0).abs() < 1e-14, "{out} of {clean}");
        }
        assert!((exposed.flux.sum() / flux.sum() - 1.0).abs() < 1e-14);
        assert_eq!(exposed.stderr.max(), 0.0);
        assert_eq!(exposed.count(Range::Within), flux.len());
    }
}

/// z of every column: pixels are the repetitions, each spot is a level of light (electrons in a second).
fn law_holds(figures: Figures, levels: &[f64], exposure: &Exposure, ambient: f64) {
    let pixels = 20_000;
    let watts = photon_energy(WAVELENGTH) / figures.quantum_efficiency;
    let flux = Matrix::from_fn(pixels, levels.len(), |_, l| levels[l] * watts);
    let light = Light::new(&flux, WAVELENGTH)
        .unwrap()
        .with_ambient(ambient * watts)
        .unwrap();
    let sensor = Sensor::new(figures).unwrap();
    let exposed = sensor.expose(&light, exposure, 3).unwrap();
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

/// Averaging, dark frames, ambient light, relative noise and a series, in every built-in sensor that has noise.
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

/// Without noise to dither it, rounding is the same in every frame: averaging 64 of them gains nothing.
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

/// Φlaser·(ρ/π)·cos²θ·A/R² of the bench, where laser and lens stand 15 in. before the wall and look along its normal.
#[test]
fn the_spot_lights_the_lens_as_the_closed_form_says() {
    let scene = Scene::load("bench").unwrap();
    for (flux, spot) in entering_lens(&scene).iter().zip(&scene.laser.spots) {
        let [x, y, _] = spot.target.position.to_array();
        let r2 = (x + 20.0) * (x + 20.0) + (y - 10.0) * (y - 10.0) + 225.0;
        let exact = 5e-3 * 0.8 / std::f64::consts::PI * (225.0 / r2) * 0.05 / r2;
        assert!((flux / exact - 1.0).abs() < 1e-13, "{flux} {exact}");
    }
}

#[test]
fn scattered_light_is_the_stated_part_and_falls_off_as_stated() {
    let scene = Scene::load("bench").unwrap();
    let entering = entering_lens(&scene);
    for spread in [Spread::Uniform, Spread::Falloff(0.7)] {
        let fraction = 1e-3;
        let scattered = glare(&scene, Glare { fraction, spread });
        for (l, all) in entering.iter().enumerate() {
            let column = scattered.column(l);
            assert!((column.sum() / (fraction * all) - 1.0).abs() < 1e-13);
            let Spread::Falloff(d0) = spread else {
                assert!(column.iter().all(|x| *x == column[0]));
                continue;
            };
            // The spots lie in the view's plane, so that each is its own image. Pixels of 3.25/16 in.
            let spot = scene.laser.spots[l].target.position;
            let law = |column: usize, row: usize| {
                let centre = |i: usize, low: f64| low + (i as f64 + 0.5) * 3.25 / 16.0;
                let (dx, dy) = (centre(column, 3.25) - spot.x, centre(row, 2.75) - spot.y);
                d0 * d0 / (d0 * d0 + dx * dx + dy * dy)
            };
            for (c, r) in [(0, 0), (15, 0), (3, 14)] {
                let ratio = column[c + 16 * r] / column[7 + 16 * 7];
                assert!((ratio / (law(c, r) / law(7, 7)) - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// A board in the beam: its back is black; its front is what the lens sees instead.
#[test]
fn what_stands_in_the_beam_is_lit_in_place_of_the_wall() {
    let board = |edges: &str| {
        let bench = Scene::load("bench").unwrap().text;
        let text = format!(
            "{bench}\n[[surface]]\nname = \"board\"\nrole = \"occluder\"\n\
             rectangle = {{ corner = [-15.5, 0, 12], {edges} }}\nmaterial = {{ lambertian = 0.5 }}\n"
        );
        Scene::from_toml("board", &text).unwrap_or_else(|e| panic!("{e}"))
    };
    // Every beam passes (x, y, 12) with x = −20 + 0.2·(20 + x_spot), from −16 to −14: the board covers part of them.
    let back = board("u = [0, 20, 0], v = [2, 0, 0]");
    let front = board("u = [2, 0, 0], v = [0, 20, 0]");
    let free = entering_lens(&Scene::load("bench").unwrap());
    let (dark, bright) = (entering_lens(&back), entering_lens(&front));
    let mut met = 0;
    for (l, spot) in front.laser.spots.iter().enumerate() {
        let [x, y, _] = spot.target.position.to_array();
        let (bx, by) = (-20.0 + 0.2 * (x + 20.0), 10.0 + 0.2 * (y - 10.0));
        if !(-15.5..=-13.5).contains(&bx) {
            assert_eq!((dark[l], bright[l]), (free[l], free[l]));
            continue;
        }
        met += 1;
        let r2 = (bx + 20.0) * (bx + 20.0) + (by - 10.0) * (by - 10.0) + 9.0;
        let exact = 5e-3 * 0.5 / std::f64::consts::PI * (9.0 / r2) * 0.05 / r2;
        assert_eq!(dark[l], 0.0);
        assert!(
            (bright[l] / exact - 1.0).abs() < 1e-9,
            "{} {exact}",
            bright[l]
        );
    }
    assert!(met > 10 && met < free.len(), "{met}");
}

/// Entries have noise of their own; only the dark frames of a pixel are shared, so that two spots correlate by their part of the variance.
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
