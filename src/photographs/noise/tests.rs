use super::*;
use crate::num::stream::{Key, Sampling, Stream};

fn stream(pixel: u32) -> Stream {
    let key = Key {
        seed: 5,
        spot: 0,
        pixel,
        block: 0,
    };
    Stream::new(Sampling::Pcg, key)
}

/// Four repeats of 4096 pixels: Poisson electrons at 0.5 counts each, 2 counts of read noise,
/// rounded. Gain and read noise come back within four of their errors, and the line fits.
fn repeats(bend: f64) -> Vec<Repeated> {
    (0..4096u32)
        .map(|pixel| {
            let mut stream = stream(pixel);
            let electrons = f64::from(pixel) * 0.1;
            let frames: Vec<f64> = (0..4)
                .map(|_| {
                    let light = 0.5 * stream.poisson(electrons);
                    let drift = bend * electrons * electrons * stream.normal();
                    (light + drift + 2.0 * stream.normal()).round()
                })
                .collect();
            let mean = frames.iter().sum::<f64>() / 4.0;
            Repeated {
                signal: mean,
                beside: 0.5 * electrons,
                variance: frames.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 3.0,
                rounding: 1.0 / 12.0,
                freedom: 3.0,
            }
        })
        .collect()
}

/// A stated noise is contradicted by as much as the repeats scatter more than it says, or less; the
/// right one, and one that is off by less than a tenth, are not.
#[test]
fn repeats_contradict_a_stated_noise() {
    let repeats = repeats(0.0);
    let of = |gain: f64, read: f64| contradicted(&repeats, CameraNoise::new(gain, read).unwrap());
    assert_eq!([of(0.5, 2.0), of(0.51, 2.0)], [None; 2]);
    // The mean of (0.5 s + 4)/(g s + σ²) over the light s, 0 to 205 counts.
    for (gain, read) in [(0.05, 2.0), (2.0, 2.0), (0.5, 20.0)] {
        let ratio = |s: f64| (0.5 * s + 4.0) / (gain * s + read * read);
        let want = (0..4096).map(|k| ratio(0.05 * f64::from(k))).sum::<f64>() / 4096.0;
        let found = of(gain, read).unwrap();
        assert!(
            (found / want - 1.0).abs() < 0.05,
            "{gain} {read}: {found} for {want}"
        );
    }
    assert_eq!(contradicted(&[], CameraNoise::new(1.0, 1.0).unwrap()), None);
}

#[test]
fn gain_and_read_noise_come_back() {
    let fit = photon_transfer(repeats(0.0), false).unwrap();
    let CameraNoise {
        gain,
        read_variance,
        ..
    } = fit.noise;
    assert!(
        (gain - 0.5).abs() < 4.0 * fit.gain_error && fit.gain_error < 0.02,
        "{fit:?}"
    );
    assert!(
        (read_variance - 4.0).abs() < 4.0 * fit.read_variance_error,
        "{fit:?}"
    );
    assert!(fit.p > 1e-3 && fit.groups == GROUPS, "{fit:?}");
    // Light that flickers has a variance that is no line.
    assert!(photon_transfer(repeats(1e-4), false).unwrap().p < 1e-6);
    // Frames that are all the same say nothing.
    let still = repeats(0.0)
        .into_iter()
        .map(|r| Repeated { variance: 0.0, ..r });
    assert!(photon_transfer(still.collect(), false).is_err());
}

/// Gain 0.5 and 20 counts² of read noise, pairs of photographs of 2048 pixels, 100 to 300 counts:
/// over 60 draws what the line says of 60, 200 and 900 counts scatters as much as it says itself.
#[test]
fn the_line_says_how_well_it_knows_a_variance() {
    let lights = [60.0, 200.0, 900.0];
    let [mut scatter, mut stated] = [[0.0; 3]; 2];
    for draw in 0..60 {
        let mut stream = stream(draw);
        let of = |k: u32| {
            let signal = 100.0 + 200.0 * f64::from(k) / 2048.0;
            let normal = stream.normal();
            Repeated {
                signal,
                beside: signal,
                variance: (0.5 * signal + 20.0) * normal * normal,
                rounding: 0.0,
                freedom: 1.0,
            }
        };
        let fit = photon_transfer((0..2048).map(of).collect(), true).unwrap();
        for (k, light) in lights.into_iter().enumerate() {
            let found = fit.noise.gain * light + fit.noise.read_variance;
            let off = found / (0.5 * light + 20.0) - 1.0;
            scatter[k] += off * off;
            stated[k] += fit.unknown(light, 0.0) * (off + 1.0) * (off + 1.0);
        }
    }
    for (scatter, stated) in scatter.into_iter().zip(stated) {
        assert!(
            (0.5..1.7).contains(&(scatter / stated)),
            "{scatter} {stated}"
        );
    }
    assert!(
        stated[1] < 0.2 * stated[2] && stated[1] < 0.2 * stated[0],
        "{stated:?}"
    );
}

/// An offset of 100 counts in the light, for want of dark frames: 4 − 0.5·100 at light 0. The gain
/// is 0.5 still, the line fits, and the variance of a photograph is the same as with dark frames.
#[test]
fn an_offset_moves_the_line_and_leaves_the_gain() {
    const OFFSET: f64 = 100.0;
    let raised = repeats(0.0).into_iter().map(|r| Repeated {
        signal: r.signal + OFFSET,
        beside: r.beside + OFFSET,
        ..r
    });
    let raised: Vec<_> = raised.collect();
    let fit = photon_transfer(raised.clone(), true).unwrap();
    let below = photon_transfer(repeats(0.0), false).unwrap();
    assert!(
        (fit.noise.gain - 0.5).abs() < 4.0 * fit.gain_error,
        "{fit:?}"
    );
    assert!(
        (fit.noise.read_variance + 46.0).abs() < 4.0 * fit.read_variance_error,
        "{fit:?}"
    );
    assert!(fit.p > 1e-3, "{fit:?}");
    let rounding = [1.0 / 12.0, 1.0];
    let (found, due) = (
        fit.noise.of_mean([OFFSET + 50.0, 0.0], rounding, 1),
        below.noise.of_mean([OFFSET + 50.0, OFFSET], rounding, 1),
    );
    assert!((found / due - 1.0).abs() < 1e-6, "{found} {due}");
    // A flat field with dark frames of its own has its variance by the same line.
    let flat = fit.noise.of_mean([OFFSET + 50.0, OFFSET], rounding, 1);
    assert_eq!(flat, found);
    // Held at 0, the line would be another, and would not fit.
    let held = photon_transfer(raised, false).unwrap();
    assert!(held.noise.gain < 0.4 && held.p < 1e-6, "{held:?}");
    // Below the offset there is no negative variance.
    assert!(fit.noise.of_mean([10.0, 0.0], rounding, 1) > 0.0);
}

/// Floating-point photographs: 32 groups, no rounding; four see no light and hardly vary. The
/// others vary by 0.5·s − 0.1, so that the line without bounds is below 0 where there is no light.
#[test]
fn groups_without_light_leave_the_line_finite() {
    let of = |variance: fn(f64) -> f64| -> Vec<Repeated> {
        (0..1024u32)
            .map(|pixel| {
                let light = f64::from(pixel / 32) - 3.0;
                Repeated {
                    signal: light,
                    beside: light,
                    variance: variance(light),
                    rounding: 0.0,
                    freedom: 3.0,
                }
            })
            .collect()
    };
    let fit = photon_transfer(of(|s| (0.5 * s - 0.1).max(1e-9)), false).unwrap();
    assert!((fit.noise.gain - 0.5).abs() < 0.05, "{fit:?}");
    assert!(fit.chi2.is_finite() && fit.p.is_finite(), "{fit:?}");
    // No numbers, no line.
    let error = photon_transfer(of(|s| if s > 20.0 { f64::INFINITY } else { 1.0 }), false);
    assert!(error.unwrap_err().to_string().contains("no line fits"));
}

/// The mean square error of means of rounded normal values about their truth, which lies
/// anywhere between two integers: by sampling.
#[test]
fn the_variance_of_a_mean_is_that_of_samples() {
    for (sigma, frames) in [(0.0, 4), (0.2, 4), (0.5, 3), (2.0, 5)] {
        let noise = CameraNoise::new(0.0, sigma).unwrap();
        let mut sum = 0.0;
        const N: u32 = 40_000;
        for k in 0..N {
            let mut stream = stream(k);
            let truth = f64::from(k) / f64::from(N);
            let mean = (0..frames)
                .map(|_| (truth + sigma * stream.normal()).round())
                .sum::<f64>()
                / frames as f64;
            sum += (mean - truth) * (mean - truth);
        }
        let found = sum / f64::from(N);
        let due = noise.of_mean([0.0; 2], [1.0 / 12.0, 1.0], frames);
        assert!(
            (due / found - 1.0).abs() < 0.05,
            "σ {sigma}: {due} for {found}"
        );
    }
}
