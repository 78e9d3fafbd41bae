//! Each stage alone: a million samples against the distribution that theory gives.

use phicam::matrix::Matrix;
use phicam::num::statistics::{chi_square_sf, normal_two_sided};
use phicam::num::units::photon_energy;
use phicam::scene::SensorModel;
use phicam::sensor::{Exposed, Exposure, Figures, Light, Range, Sensor, ShotNoise, Stated};

use super::{SIGNIFICANCE, WAVELENGTH, expose};

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

/// Every count of a converter that rounds normal numbers: from noise below a step to noise of
/// several.
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

/// Of entries that are not marked the mean is the light's, however near to 0 counts it lies: those
/// whose frames or dark frames come near are marked, all of them where none is far.
#[test]
fn what_is_not_marked_is_right_near_zero_counts() {
    let figures = Figures {
        read_noise: 8.0,
        bits: Some(16),
        offset: 10.0,
        ..Figures::IDEAL
    };
    let right = |figures: Figures, mean: f64, dark_frames: u32| {
        let exposure = Exposure::new(&[1.0], 4, dark_frames).unwrap();
        let light = uniform(mean).resize(SIDE, 30, 0.0);
        let exposed = expose(figures, &light, &exposure, 9);
        let marked = exposed.range.iter().zip(&exposed.flux);
        let kept: Vec<f64> = marked
            .filter(|(range, _)| **range == Range::Within)
            .map(|(_, flux)| *flux)
            .collect();
        let truth = light[0];
        let n = kept.len() as f64;
        if n > 1.0 {
            let off = kept.iter().sum::<f64>() / n / truth - 1.0;
            let sigma = 8.02 / mean / 2.0;
            assert!(off.abs() < 4.0 * sigma / n.sqrt(), "{mean}: {off} of {n}");
        }
        kept.len()
    };
    // Eight deviations of a metering frame are 64 counts, 54 above the offset.
    assert_eq!(right(figures, 3.0, 0), 0);
    for mean in [30.0, 45.0, 54.0] {
        right(figures, mean, 0);
    }
    let all = right(figures, 110.0, 0);
    assert_eq!(all, 30 * SIDE);
    assert_eq!(right(figures, 110.0, 16), 0);
    let raised = Figures {
        offset: 100.0,
        ..figures
    };
    assert_eq!(right(raised, 110.0, 16), 30 * SIDE);
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
        let exposed = ideal.expose(&light, &exposure, Stated::Oracle, 1).unwrap();
        for (out, clean) in exposed.flux.iter().zip(&flux) {
            assert!((out / clean - 1.0).abs() < 1e-14, "{out} of {clean}");
        }
        assert!((exposed.flux.sum() / flux.sum() - 1.0).abs() < 1e-14);
        assert_eq!(exposed.stderr.max(), 0.0);
        assert_eq!(exposed.count(Range::Within), flux.len());
    }
}
