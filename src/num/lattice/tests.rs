use super::*;
use crate::num::stream::{Key, Sampling};

fn chance(seed: u64) -> Stream {
    let key = Key {
        seed,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    Stream::new(Sampling::Pcg, key)
}

/// A basis of integers whose vectors are long and nearly parallel, and a target.
fn skewed(n: usize, random: &mut Stream) -> (DMatrix<f64>, DVector<f64>) {
    let mut basis = DMatrix::from_fn(n + 2, n, |i, j| if i == j { 2.0 } else { 0.0 });
    for row in n..n + 2 {
        for j in 0..n {
            basis[(row, j)] = (random.uniform() * 2000.0).round();
        }
    }
    let target = DVector::from_fn(n + 2, |i, _| {
        if i < n {
            1.0
        } else {
            3000.0 * random.uniform()
        }
    });
    (basis, target)
}

/// The definition of Lenstra, Lenstra and Lovász; U is of integers and undone by integers; and B U
/// has the lengths and angles of T.
#[test]
fn reduced_bases_are_what_they_are_said_to_be() {
    let random = &mut chance(1);
    for n in [2, 5, 12, 30] {
        let (basis, target) = skewed(n, random);
        let found = Lattice::new(&basis, &target, None).unwrap().unwrap();
        let (t, u) = (&found.t, &found.u);
        for i in 0..n {
            for k in i + 1..n {
                assert!(t[(i, k)].abs() <= 0.501 * t[(i, i)].abs(), "{n} {i} {k}");
                assert_eq!(t[(k, i)], 0.0);
            }
            if i + 1 < n {
                let next = t[(i, i + 1)].hypot(t[(i + 1, i + 1)]);
                assert!(
                    DELTA * t[(i, i)].powi(2) <= next.powi(2) * (1.0 + 1e-9),
                    "{n} {i}"
                );
            }
        }
        assert!(u.iter().all(|z| z.fract() == 0.0));
        assert!((u.determinant().abs() - 1.0).abs() < 1e-6);
        let short = &basis * u;
        let off = (short.tr_mul(&short) - t.tr_mul(t)).amax() / t.norm_squared();
        assert!(off < 1e-12, "{n}: {off}");
        // The longest of the reduced basis is far shorter than the shortest that was given.
        if n > 5 {
            let longest = |m: &DMatrix<f64>| m.column_iter().map(|c| c.norm()).fold(0.0, f64::max);
            assert!(longest(&short) < 0.2 * longest(&basis), "{n}");
        }
        // From itself nothing is left to do.
        let again = Lattice::new(&basis, &target, Some(&found))
            .unwrap()
            .unwrap();
        assert_eq!(again.u, found.u);
    }
}

/// Against all points of a box: the nearest comes first, and the next ones in order.
#[test]
fn the_nearest_points_are_those_of_all() {
    let random = &mut chance(2);
    for _ in 0..6 {
        let n = 5;
        let basis = DMatrix::from_fn(n, n, |i, j| {
            let own = if i == j { 1.5 } else { 0.0 };
            own + 2.0 * random.normal()
        });
        let target = &basis * DVector::from_fn(n, |_, _| 2.0 * random.uniform() - 1.0);
        let distance = |z: &[f64]| (&basis * DVector::from_row_slice(z) - &target).norm();
        let mut all: Vec<(f64, Vec<f64>)> = (0..13usize.pow(5))
            .map(|at| {
                (0..5)
                    .map(|j| (at / 13usize.pow(j) % 13) as f64 - 6.0)
                    .collect()
            })
            .map(|z: Vec<f64>| (distance(&z), z))
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let lattice = Lattice::new(&basis, &target, None).unwrap().unwrap();
        let found = lattice.nearest(400);
        for (found, (expected, point)) in found.iter().zip(&all).take(5) {
            assert!(
                (distance(found) - expected).abs() < 1e-9,
                "{found:?} {point:?}"
            );
        }
    }
}

/// Points are drawn with the probability that is told, and Σ exp(−½ ‖B z − t‖²) estimated by them
/// is that of all points.
#[test]
fn points_of_chance_have_the_probability_that_is_told() {
    let random = &mut chance(3);
    let basis = DMatrix::from_row_slice(3, 2, &[2.4, 5.9, 0.3, -1.9, 0.8, 0.5]);
    let target = DVector::from_row_slice(&[0.7, -1.1, 0.4]);
    let lattice = Lattice::new(&basis, &target, None).unwrap().unwrap();
    let log = |z: &[f64]| -0.5 * (&basis * DVector::from_row_slice(z) - &target).norm_squared();
    let side = |z: usize| z as f64 - 60.0;
    let all = (0..121 * 121).map(|at| libm::exp(log(&[side(at / 121), side(at % 121)])));
    let (sum, draws) = (all.sum::<f64>(), 40_000);
    let (mut first, mut second, mut seen) = (0.0, 0.0, std::collections::BTreeMap::new());
    for _ in 0..draws {
        let Drawn {
            point,
            log_probability,
        } = lattice.draw(random);
        let weight = libm::exp(log(&point) - log_probability);
        first += weight / f64::from(draws);
        second += weight * weight / f64::from(draws);
        let key = [point[0] as i64, point[1] as i64];
        seen.entry(key).or_insert((0.0, log_probability)).0 += 1.0;
    }
    let error = ((second - first * first) / f64::from(draws)).sqrt();
    assert!((first - sum).abs() < 4.0 * error, "{first} {sum} ± {error}");
    assert!(error > 0.0 && error < 0.01 * sum);
    for (point, (count, log)) in seen {
        let expected = f64::from(draws) * libm::exp(log);
        let off = (count - expected) / expected.max(1.0).sqrt();
        assert!(off.abs() < 5.0, "{point:?}: {count} {expected}");
    }
}

/// One dimension, by Poisson's sum: Σ_z exp(−½ (b z − t)²) = √(2π)/b (1 + 2 e^(−2π²/b²) cos(2π t/b)
/// + …).
#[test]
fn sums_in_one_dimension_are_poissons() {
    let random = &mut chance(4);
    let (b, t) = (1.7, 0.6);
    let one = |x: f64| DVector::from_element(1, x);
    let lattice = Lattice::new(&DMatrix::from_element(1, 1, b), &one(t), None);
    let lattice = lattice.unwrap().unwrap();
    let pi = std::f64::consts::PI;
    let term = |k: f64| libm::exp(-2.0 * (pi * k / b).powi(2)) * libm::cos(2.0 * pi * k * t / b);
    let expected = (2.0 * pi).sqrt() / b * (1.0 + 2.0 * (term(1.0) + term(2.0)));
    for _ in 0..20 {
        let drawn = lattice.draw(random);
        let off = b * drawn.point[0] - t;
        let found = libm::exp(-0.5 * off * off - drawn.log_probability);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// What double precision cannot hold is told, not returned; nor is what is no basis.
#[test]
fn what_cannot_be_reduced_is_told() {
    let random = &mut chance(5);
    let (mut basis, target) = skewed(12, random);
    basis
        .rows_mut(12, 2)
        .apply(|x| *x *= 1e15 + random.uniform());
    let found = Lattice::new(&basis, &target, None).unwrap();
    if let Some(found) = found {
        let short = &basis * &found.u;
        let off = (short.tr_mul(&short) - found.t.tr_mul(&found.t)).amax();
        assert!(off < 1e-3 * found.t.norm_squared());
    }
    let flat = DMatrix::from_element(3, 2, 1.0);
    assert!(
        Lattice::new(&flat, &DVector::zeros(3), None)
            .unwrap()
            .is_none()
    );
    let bad = DMatrix::from_element(3, 2, f64::NAN);
    assert!(Lattice::new(&bad, &DVector::zeros(3), None).is_err());
}

/// Weights by multiplication are the exponentials that they stand for, of flat and of steep laws.
#[test]
fn weights_of_integers_are_the_normal_law_s() {
    for square in [1e-3, 0.04, 1.0, 9.0, 39.0, 41.0, 1e4, 1e9] {
        for centre in [0.0, 0.5, -0.5, 0.3, -7.49, 1e6 + 0.25] {
            let log = |z: f64| -0.5 * square * (z - centre) * (z - centre);
            let top = log(centre.round());
            let mut choices = Vec::new();
            weigh(&mut choices, steep(square.sqrt()), centre);
            let mut least = 1.0_f64;
            for (&(z, weight), near) in choices.iter().zip(around(centre)) {
                let direct = libm::exp(log(z) - top);
                assert!(
                    z == near && (weight / direct - 1.0).abs() < 1e-11,
                    "{square} {centre} {z}"
                );
                least = least.min(weight);
            }
            let count = choices.len();
            let side = (2.0 * NEGLIGIBLE / square).sqrt();
            assert!(
                ((count as f64) - 2.0 * side).abs() <= 2.0,
                "{square}: {count}"
            );
            assert!(least > libm::exp(-NEGLIGIBLE) * (1.0 - 1e-11));
        }
    }
}
