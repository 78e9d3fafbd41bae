use std::f64::consts::{PI, TAU};

use super::*;
use crate::num::statistics::chi_square_sf;
use crate::num::stream::{Key, Sampling, Stream};
use crate::scene::material::zoo;

const ACROSS: usize = 16;
const AROUND: usize = 24;
/// Sub-cells a side of each cell, over which the density is integrated.
const SUB: usize = 64;

/// θ and φ in their cells. The polar angle is measured from the mirror direction, where sharp lobes
/// are: dω = sinθ dθ dφ about any pole.
fn cell(pole: (DVec3, DVec3, DVec3), w: DVec3) -> (usize, usize) {
    let (x, y, z) = pole;
    let theta = w.cross(z).length().atan2(w.dot(z));
    let phi = w.dot(y).atan2(w.dot(x)) / TAU + 0.5;
    // θ = π s³.
    let s = (theta / PI).cbrt();
    (
        (s * ACROSS as f64) as usize,
        ((phi * AROUND as f64) as usize).min(AROUND - 1),
    )
}

/// Probability of each cell by midpoints, and of all.
fn probabilities(
    m: &Material,
    albedo: f64,
    wo: DVec3,
    pole: (DVec3, DVec3, DVec3),
) -> (Vec<f64>, f64) {
    let (x, y, z) = pole;
    let mut cells = vec![0.0; ACROSS * AROUND];
    for a in 0..ACROSS * SUB {
        let s = (a as f64 + 0.5) / (ACROSS * SUB) as f64;
        let theta = PI * s.powi(3);
        let slope = 3.0 * PI * s * s / (ACROSS * SUB) as f64;
        for b in 0..AROUND * SUB {
            let phi = TAU * ((b as f64 + 0.5) / (AROUND * SUB) as f64 - 0.5);
            let w = x * (theta.sin() * phi.cos()) + y * (theta.sin() * phi.sin()) + z * theta.cos();
            let solid = theta.sin() * slope * TAU / (AROUND * SUB) as f64;
            cells[a / SUB * AROUND + b / SUB] += wi_density(m, albedo, wo, w) * solid;
        }
    }
    let total = cells.iter().sum();
    (cells, total)
}

/// χ² of sampled directions over cells, and the accepted share beside the integral of the density.
#[test]
#[ignore = "slow"]
fn samples_follow_their_density() {
    let n = 100_000u32;
    for (name, m) in zoo() {
        for (k, theta) in [0.05, 0.9, 1.5f64].into_iter().enumerate() {
            let azimuth = 0.7 + k as f64;
            let wo = DVec3::new(
                theta.sin() * azimuth.cos(),
                theta.sin() * azimuth.sin(),
                theta.cos(),
            );
            let z = DVec3::new(-wo.x, -wo.y, wo.z);
            let x = z.any_orthonormal_vector();
            let pole = (x, z.cross(x), z);
            let (expected, total) = probabilities(&m, 0.6, wo, pole);
            assert!(total <= 1.0 + 1e-3, "{name}: {total}");
            let key = Key {
                seed: 3,
                spot: 0,
                pixel: k as u32,
                block: 0,
            };
            let mut stream = Stream::new(Sampling::Pcg, key);
            let mut counts = vec![0.0; ACROSS * AROUND];
            let mut accepted = 0.0;
            for _ in 0..n {
                let [a, b, choice, _] = stream.next_four();
                if let Some(w) = sample_wi(&m, 0.6, wo, [a, b], choice) {
                    assert!(w.z >= 0.0 && (w.length() - 1.0).abs() < 1e-9, "{name}: {w}");
                    let (i, j) = cell(pole, w);
                    counts[i * AROUND + j] += 1.0;
                    accepted += 1.0;
                }
            }
            let n = f64::from(n);
            let error = (total * (1.0 - total).max(0.0) / n).sqrt();
            assert!(
                (accepted / n - total).abs() < 5.0 * error + 1e-3,
                "{name} at {theta}: accepted {}, density adds up to {total}",
                accepted / n
            );
            let (mut chi2, mut cells) = (0.0, 0.0);
            let (mut rare, mut rare_count) = (n * (1.0 - total).max(0.0), n - accepted);
            for (p, count) in expected.iter().zip(&counts) {
                if p * n > 10.0 {
                    chi2 += (count - p * n).powi(2) / (p * n);
                    cells += 1.0;
                } else {
                    rare += p * n;
                    rare_count += count;
                }
            }
            if rare > 10.0 {
                chi2 += (rare_count - rare).powi(2) / rare;
                cells += 1.0;
            }
            let p = chi_square_sf(chi2, cells - 1.0);
            assert!(
                p > 1e-5,
                "{name} at {theta}: χ² {chi2} of {cells} cells, p = {p}"
            );
        }
    }
}

/// f cosθ/p averages to the directional albedo found by quadrature.
#[test]
fn the_estimator_has_its_mean() {
    let n = 40_000u32;
    for (name, m) in zoo() {
        for theta in [0.3, 1.2f64] {
            let wo = DVec3::new(theta.sin(), 0.0, theta.cos());
            let key = Key {
                seed: 8,
                spot: 0,
                pixel: 0,
                block: 0,
            };
            let mut stream = Stream::new(Sampling::Pcg, key);
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                let [a, b, choice, _] = stream.next_four();
                let value = sample_wi(&m, 0.6, wo, [a, b], choice).map_or(0.0, |w| {
                    let p = wi_density(&m, 0.6, wo, w);
                    if p > 0.0 {
                        m.brdf(0.6, w, wo) * w.z / p
                    } else {
                        0.0
                    }
                });
                sum += value;
                squares += value * value;
            }
            let mean = sum / f64::from(n);
            let error = ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
            let exact = m.directional_albedo(0.6, wo);
            assert!(
                (mean - exact).abs() < 5.0 * error + 1e-4,
                "{name}: {mean} ± {error}, {exact}"
            );
            // No material is so badly sampled that its estimator varies by more than twice its
            // mean.
            assert!(
                error * f64::from(n).sqrt() < 2.0 * mean,
                "{name}: {error}, {mean}"
            );
        }
    }
}

#[test]
fn lambertian_is_the_cosine() {
    let u = [0.3, 0.8];
    let w = sample_wi(&Material::Lambertian, 0.5, DVec3::Z, u, 0.9).unwrap();
    assert_eq!(w.to_array(), warp::cosine_hemisphere(u));
    let p = wi_density(&Material::Lambertian, 0.5, DVec3::Z, w);
    assert_eq!(p, w.z * FRAC_1_PI);
}

/// A floor below the wall sees the hidden surface alone, from afar: area points serve it, but only
/// where they lie on all that it sees.
#[test]
fn area_points_that_miss_a_hidden_surface_do_not_serve_alone() {
    let more = r#"
        [[surface]]
        name = "floor"
        role = "occluder"
        rectangle = { corner = [0, -40, -5], u = [10, 0, 0], v = [0, 10, 0] }
        material = { lambertian = 0.5 }
        [[surface]]
        name = "side"
        role = "occluder"
        rectangle = { corner = [0, -20, 1], u = [0, 0, 5], v = [10, 0, 0] }
        material = { lambertian = 0.5 }
    "#;
    let text = include_str!("../../../scenes/bench.toml").to_owned() + more;
    let scene = Scene::from_toml("floor", &text).unwrap();
    let of_floor = |sampled: &[ShapeId]| {
        let path = PathSampler::new(&scene, &[0], || AreaSampler::new(&scene, sampled));
        path.strategies[2]
    };
    assert_eq!(of_floor(&[1, 3]), Strategy::Area);
    assert_eq!(of_floor(&[3]), Strategy::Both);
    assert_eq!(of_floor(&[]), Strategy::Area);
}
