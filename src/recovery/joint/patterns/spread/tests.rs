use super::*;
use crate::num::quadrature::Rule;
use crate::recovery::bench::normal_stream;
use crate::recovery::joint::patterns::fields;
use nalgebra::DMatrix;

/// By hand: (0, √(0.003·0.01)], … of 0.3.
const BEFOREHAND: [f64; 5] = [0.018_257, 0.039_478, 0.124_839, 0.394_776, 0.422_650];
const SHOWN: [f64; 4] = [0.2, 0.8, 0.2, 0.8];

/// P(s) of the patterns of 2 × 2 elements where neighbours may be alike, by all patterns.
fn if_alike() -> [f64; 16] {
    let bonds = |s: usize| -> f64 {
        let each = [(0, 1), (2, 3), (0, 2), (1, 3)];
        let one = |(a, b): (usize, usize)| if s >> a & 1 == s >> b & 1 { 1.0 } else { -1.0 };
        each.map(one).iter().sum()
    };
    let mut all = [0.0; 16];
    for k in 0..11 {
        let own = |s: usize| libm::exp(0.1 * f64::from(k) * bonds(s));
        let z: f64 = (1..15).map(own).sum();
        for (s, of) in all.iter_mut().enumerate().take(15).skip(1) {
            *of += own(s) / z / 11.0;
        }
    }
    all
}

/// ln of Σ P(s) 2 ∫∫ N(d; R ℓ, 1 + R S Rᵀ) da db over all patterns s, but for (2π)⁻², S the
/// variances of elements about their levels; and E (x − shown)², by Gauss–Legendre on 60 × 60
/// levels and inverses of whole matrices.
fn by_hand(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    variances: [f64; 4],
    beforehand: &[f64; 16],
) -> (f64, DVector<f64>) {
    let one = DMatrix::<f64>::identity(4, 4);
    let own = DMatrix::from_diagonal(&DVector::from_row_slice(&variances));
    let covariance = &one + r * &own * r.transpose();
    let det = covariance.determinant();
    let inverse = covariance.try_inverse().unwrap();
    let gain = &own * r.transpose() * &inverse;
    let variance = (&one - &gain * r) * &own;
    let rule = Rule::gauss_legendre(60);
    let (mut sum, mut square) = (0.0, DVector::zeros(4));
    for (pattern, share) in beforehand.iter().enumerate() {
        for (a, wa) in rule.on(0.0, 1.0) {
            for (b, wb) in rule.on(a, 1.0) {
                let level = DVector::from_fn(4, |j, _| if pattern >> j & 1 == 1 { b } else { a });
                let left = d - r * &level;
                let log = -0.5 * left.dot(&(&inverse * &left)) - 0.5 * libm::log(det);
                let weight = 2.0 * wa * wb * share * libm::exp(log);
                let x = &level + &gain * &left;
                sum += weight;
                let off = |j: usize| (x[j] - SHOWN[j]).powi(2) + variance[(j, j)];
                square += DVector::from_fn(4, |j, _| off(j)) * weight;
            }
        }
    }
    (libm::log(sum), square / sum)
}

/// Elements exactly on two levels and elements that are not: the probability of exact levels and
/// the errors are those of the whole sums, every pattern as likely or neighbours alike.
#[test]
fn errors_are_those_of_all_patterns_levels_and_spreads() {
    let mut normal = normal_stream(3);
    let mixing = DMatrix::from_fn(4, 4, |_, _| normal());
    let sizes = [vec![Fields::even(4)], Fields::alike(&[[2, 2]])];
    for (truth, noise) in [
        ([0.2, 0.8, 0.2, 0.8], 0.05),
        ([0.1, 0.7, 0.3, 0.9], 0.05),
        ([0.2, 0.8, 0.2, 0.8], 0.5),
        ([0.2, 0.2, 0.8, 0.8], 0.8),
    ] {
        let r = &mixing / noise;
        let d = &r * DVector::from_row_slice(&truth) + DVector::from_fn(4, |_, _| normal());
        let shown = DVector::from_row_slice(&SHOWN);
        let light = [false, true, false, true];
        for (sizes, beforehand) in sizes.iter().zip([[1.0 / 16.0; 16], if_alike()]) {
            let likelihood = PatternLikelihood::new(&r, &d, None);
            let exact = fields::sum(&likelihood, sizes, &[], (4000, None));
            let exact = exact.unwrap().unwrap();
            let found = sum(&likelihood, (sizes, &exact), (&light, &shown)).unwrap();
            let of = |variances: [f64; 4]| by_hand(&r, &d, variances, &beforehand);
            let own = of([0.0; 4]);
            let mut parts: Vec<(f64, (f64, DVector<f64>))> = SPREADS
                .iter()
                .zip(BEFOREHAND)
                .map(|(tau, before)| (0.5 * before, of([tau * tau; 4])))
                .collect();
            // Single elements that are of neither level.
            parts.extend((0..4).map(|apart| {
                let variances = std::array::from_fn(|j| if j == apart { 0.09 } else { 0.0 });
                (0.0625, of(variances))
            }));
            let likeliest = SPREADS
                .iter()
                .position(|tau| *tau == found.likeliest)
                .unwrap();
            let tau = found.likeliest;
            parts.extend((0..4).map(|apart| {
                let more = |j: usize| if j == apart { 0.09 } else { 0.0 };
                let variances = std::array::from_fn(|j| tau * tau + more(j));
                (0.0625 * BEFOREHAND[likeliest], of(variances))
            }));
            let others: Vec<f64> = parts
                .iter()
                .map(|(before, (log, _))| before * libm::exp(log - own.0))
                .collect();
            let all = 1.0 + others.iter().sum::<f64>();
            let sum = |factor: f64, count: usize| {
                let each = parts[..count].iter().zip(&others);
                let (mut all, mut square) = (1.0, own.1.clone());
                each.for_each(|((_, (_, of)), weight)| {
                    all += factor * weight;
                    square += of * (factor * weight);
                });
                square / all
            };
            // The larger of those with and without single elements.
            let square = sum(1.0, parts.len()).sup(&sum(2.0, SPREADS.len()));
            let told = format!("{truth:?} {noise}: {} {}", found.exact, all.recip());
            assert!((found.exact - all.recip()).abs() < 0.03, "{told}");
            for (own, expected) in found.error.iter().zip(square.iter()) {
                assert!(
                    (own / expected.sqrt() - 1.0).abs() < 0.1,
                    "{told} {own} {expected}"
                );
            }
        }
    }
}
