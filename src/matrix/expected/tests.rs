use super::*;
use crate::num::stream::{Key, Sampling, Stream};

/// Photographs of three directions, 10 to 60 electrons an entry, and counts of them.
fn counted(seed: u64, pixels: usize, spots: usize) -> [Matrix; 2] {
    let mean = Matrix::from_fn(pixels, spots, |p, l| {
        let [p, l] = [p as f64 / pixels as f64, l as f64 / spots as f64];
        let shape = (1.0 + p) * (1.0 + l) + 0.5 * libm::sin(6.0 * p) * libm::cos(5.0 * l);
        10.0 * (shape + 2.0 * p * p * (1.0 - l) * (1.0 - l))
    });
    let counts = Matrix::from_fn(pixels, spots, |p, l| {
        let key = Key {
            seed,
            spot: l as u32,
            pixel: p as u32,
            block: 0,
        };
        Stream::new(Sampling::Pcg, key).poisson(mean[(p, l)])
    });
    [mean, counts]
}

/// Of counts the variance is the mean: weighted by what is expected the common factor of 24 draws
/// is 1 and χ² is the number of entries, each within four of their standard errors; by the counts
/// themselves, one electron added to none, it is the closed form μ − 1 of each, and χ² too large.
/// An entry that is left out tells nothing and has none.
#[test]
fn expected_light_weighs_without_bias() {
    let (pixels, spots, draws) = (60, 40, 24);
    let (mut own, mut by_counts) = ([0.0; 2], [0.0; 2]);
    let mut information = 0.0;
    for seed in 0..draws {
        let [mean, counts] = counted(seed, pixels, spots);
        let mut left_out = Matrix::zeros(pixels, spots);
        for l in 0..spots {
            left_out[(l, l)] = 4.0;
        }
        let mut variance = counts.clone();
        variance.zip_apply(&left_out, |v, flag| *v = if flag != 0.0 { 1e9 } else { *v });
        let found = expected(&variance, &variance, Some(&left_out))
            .unwrap()
            .unwrap();
        let factor = |variance: &Matrix| {
            let at = (0..variance.len()).filter(|at| left_out[*at] == 0.0);
            let [x, all, chi2] = at.fold([0.0; 3], |[x, all, chi2], at| {
                let by = mean[at] / variance[at];
                let off = counts[at] - mean[at];
                [
                    x + by * off,
                    all + by * mean[at],
                    chi2 + off * off / variance[at],
                ]
            });
            [x / all, chi2]
        };
        assert_eq!(found[(3, 3)], 0.0);
        let [x, chi2] = factor(&found);
        own = [own[0] + x / draws as f64, own[1] + chi2 / draws as f64];
        let [x, chi2] = factor(&counts.map(|n| n.max(1.0)));
        by_counts = [
            by_counts[0] + x / draws as f64,
            by_counts[1] + chi2 / draws as f64,
        ];
        information = mean.sum();
    }
    let entries = (pixels * spots - spots) as f64;
    let of_factor = 1.0 / (information * draws as f64).sqrt();
    let of_chi2 = (2.0 / entries / draws as f64).sqrt();
    assert!(own[0].abs() < 4.0 * of_factor, "{own:?} {of_factor}");
    assert!(
        (own[1] / entries - 1.0).abs() < 4.0 * of_chi2,
        "{own:?} {of_chi2}"
    );
    assert!(by_counts[0] < -20.0 * of_factor, "{by_counts:?}");
    assert!(
        by_counts[1] / entries - 1.0 > 10.0 * of_chi2,
        "{by_counts:?}"
    );
}

/// Where light is plenty it stays to less than its noise, and where there is no noise to the bit;
/// few columns tell nothing.
#[test]
fn plenty_of_light_stays() {
    let [mean, _] = counted(1, 30, 20);
    let plenty = mean * 1e8;
    let found = expected(&plenty, &plenty, None).unwrap().unwrap();
    for (x, exact) in found.iter().zip(&plenty) {
        assert!((x - exact).abs() < exact.sqrt(), "{x} {exact}");
    }
    let none = Matrix::zeros(30, 20);
    assert_eq!(expected(&plenty, &none, None).unwrap().unwrap(), plenty);
    // A pixel that sees nothing leaves the others what they are.
    let mut dark = plenty.clone();
    dark.row_mut(4).fill(0.0);
    let found = expected(&dark, &dark, None).unwrap().unwrap();
    assert!(found.row(4).amax() == 0.0 && (&found - &dark).amax() < plenty.amax().sqrt());
    let few = plenty.columns(0, 7).into_owned();
    assert!(expected(&few, &few, None).unwrap().is_none());
}

/// Of 20 % noise the common factor by weights of what is expected is 1 within four of its standard
/// errors, where weights by the entries themselves make it 1 − 2 ε² and less; of few spots that is
/// told: 2 ε √N.
#[test]
fn relative_noise_weighs_without_bias() {
    let (noise, draws) = (0.2, 24);
    let (mut own, mut by_entries, mut entries) = (0.0, 0.0, 0.0);
    for seed in 0..draws {
        let [mean, _] = counted(0, 60, 40);
        let phi = Matrix::from_fn(60, 40, |p, l| {
            let key = Key {
                seed,
                spot: l as u32,
                pixel: p as u32,
                block: 1,
            };
            mean[(p, l)] * (1.0 + noise * Stream::new(Sampling::Pcg, key).normal())
        });
        let factor = |stderr: &Matrix| {
            let weight = stderr.map(|s| 1.0 / (s * s));
            let with = |x: &Matrix| weight.component_mul(x).dot(&mean);
            with(&phi) / with(&mean) - 1.0
        };
        let (stderr, too_dark) = relative_errors(&phi, noise, None).unwrap();
        assert_eq!(too_dark, 0.0);
        own += factor(&stderr) / draws as f64;
        by_entries += factor(&phi.map(|x| noise * x.abs().max(0.1))) / draws as f64;
        entries = phi.len() as f64;
        let few = phi.columns(0, 4).into_owned();
        let (_, too_dark) = relative_errors(&few, noise, None).unwrap();
        assert!((too_dark - 0.4 * 240f64.sqrt()).abs() < 1e-9);
    }
    let error = noise / (entries * draws as f64).sqrt();
    assert!(own.abs() < 4.0 * error, "{own} {error}");
    assert!(by_entries < -2.0 * noise * noise, "{by_entries} {error}");
}
