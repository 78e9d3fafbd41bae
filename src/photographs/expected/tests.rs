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
        let slope = Matrix::from_element(pixels, spots, 1.0);
        let found = expected(&variance, &slope, &left_out).unwrap().unwrap();
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

/// Where light is plenty variances stay to less than their own noise, and where none of it comes
/// from light they stay to the bit; few spots tell nothing.
#[test]
fn plenty_of_light_stays() {
    let [mean, _] = counted(1, 30, 20);
    let (plenty, left_out) = (mean * 1e8, Matrix::zeros(30, 20));
    let slope = Matrix::from_element(30, 20, 1.0);
    let found = expected(&plenty, &slope, &left_out).unwrap().unwrap();
    for (x, exact) in found.iter().zip(&plenty) {
        assert!((x - exact).abs() < exact.sqrt(), "{x} {exact}");
    }
    let none = Matrix::zeros(30, 20);
    assert_eq!(
        expected(&plenty, &none, &left_out).unwrap().unwrap(),
        plenty
    );
    let few = |m: &Matrix| m.columns(0, 7).into_owned();
    assert!(
        expected(&few(&plenty), &few(&slope), &few(&left_out))
            .unwrap()
            .is_none()
    );
}
