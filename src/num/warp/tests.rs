use std::f64::consts::PI;

use super::*;
use crate::num::statistics::chi_square_sf;
use crate::num::stream::{Key, Sampling, Stream};

/// Inverse of [`cosine_hemisphere`].
fn cosine_hemisphere_inverse(w: [f64; 3]) -> Point2 {
    disc_inverse([w[0], w[1]])
}

/// Inverse of [`gaussian_spot`].
fn gaussian_spot_inverse(p: Point2) -> Point2 {
    let u = -libm::expm1(-2.0 * (p[0] * p[0] + p[1] * p[1]));
    let phi = libm::atan2(p[1], p[0]);
    [
        u,
        if phi < 0.0 {
            phi / TAU + 1.0
        } else {
            phi / TAU
        },
    ]
}

/// Density of [`sphere`] per steradian: 1/(4π).
fn sphere_density() -> f64 {
    1.0 / (4.0 * PI)
}

/// Density of [`triangle`] per unit area of its (b₁, b₂) plane: 2 inside. Per area of a triangle in
/// space it is 1 over that area.
fn triangle_density(b: Point2) -> f64 {
    if b[0] >= 0.0 && b[1] >= 0.0 && b[0] + b[1] <= 1.0 {
        2.0
    } else {
        0.0
    }
}

/// Inverse of [`triangle`].
fn triangle_inverse(b: Point2) -> Point2 {
    let r = b[0] + b[1];
    // All of u₁ maps to the first vertex.
    [r * r, if r > 0.0 { b[1] / r } else { 0.0 }]
}

fn points(n: u32) -> impl Iterator<Item = Point2> {
    let key = Key {
        seed: 11,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    (0..n).map(move |_| {
        let x = stream.next_four();
        [x[0], x[1]]
    })
}

/// χ² of the warped points over a grid of bins in `coordinates` (both in [0, 1)), against the
/// density integrated over each bin by the midpoint rule.
fn chi_square(
    coordinates: impl Fn(Point2) -> Point2,
    bin_probability: impl Fn(Point2, f64) -> f64,
) {
    const BINS: usize = 12;
    const SUB: usize = 40;
    let n = 200_000;
    let mut counts = [[0.0; BINS]; BINS];
    for u in points(n) {
        let [a, b] = coordinates(u);
        counts[(a * BINS as f64) as usize][(b * BINS as f64) as usize] += 1.0;
    }
    let step = 1.0 / (BINS * SUB) as f64;
    let (mut chi2, mut bins, mut total) = (0.0, 0.0, 0.0);
    for (i, row) in counts.iter().enumerate() {
        for (j, count) in row.iter().enumerate() {
            let mut p = 0.0;
            for k in 0..SUB * SUB {
                let a = (i * SUB + k / SUB) as f64 * step + 0.5 * step;
                let b = (j * SUB + k % SUB) as f64 * step + 0.5 * step;
                p += bin_probability([a, b], step * step);
            }
            total += p;
            let expected = p * f64::from(n);
            if expected > 5.0 {
                chi2 += (count - expected) * (count - expected) / expected;
                bins += 1.0;
            } else {
                assert!(*count < expected + 25.0);
            }
        }
    }
    assert!((total - 1.0).abs() < 2e-3, "density integrates to {total}");
    let p = chi_square_sf(chi2, bins - 1.0);
    assert!(p > 1e-4, "chi2 {chi2} over {bins} bins, p = {p}");
}

#[test]
fn disc_follows_its_density() {
    // Bins in (r², φ/2π): dA = ½ d(r²) dφ.
    chi_square(
        |u| {
            let [x, y] = disc(u);
            [
                (x * x + y * y).min(1.0 - 1e-12),
                (libm::atan2(y, x) / TAU + 0.5).min(1.0 - 1e-12),
            ]
        },
        |[a, b], cell| {
            let (r, phi) = (a.sqrt(), (b - 0.5) * TAU);
            disc_density([r * phi.cos(), r * phi.sin()]) * 0.5 * TAU * cell
        },
    );
}

#[test]
fn cosine_hemisphere_follows_its_density() {
    // Bins in (cosθ, φ/2π): dω = dcosθ dφ.
    chi_square(
        |u| {
            let [x, y, z] = cosine_hemisphere(u);
            [
                z.min(1.0 - 1e-12),
                (libm::atan2(y, x) / TAU + 0.5).min(1.0 - 1e-12),
            ]
        },
        |[a, _], cell| cosine_hemisphere_density(a) * TAU * cell,
    );
}

#[test]
fn gaussian_spot_follows_its_density() {
    // Bins over the square [−2, 2]², in which all but 2·erfc(2√2) ≈ 1.3e-4 of the power lies.
    chi_square(
        |u| gaussian_spot(u).map(|x| (x / 4.0 + 0.5).clamp(0.0, 1.0 - 1e-12)),
        |p, cell| gaussian_spot_density(p.map(|x| (x - 0.5) * 4.0)) * 16.0 * cell,
    );
}

#[test]
fn sphere_follows_its_density() {
    chi_square(
        |u| {
            let [x, y, z] = sphere(u);
            [
                (0.5 * (1.0 + z)).min(1.0 - 1e-12),
                (libm::atan2(y, x) / TAU + 0.5).min(1.0 - 1e-12),
            ]
        },
        |_, cell| sphere_density() * 2.0 * TAU * cell,
    );
}

#[test]
fn triangle_follows_its_density() {
    // Bins in (s, t) = (b₁ + b₂, b₂/(b₁ + b₂)): db₁ db₂ = s ds dt.
    chi_square(
        |u| {
            let [a, b] = triangle(u);
            assert!(a >= 0.0 && b >= 0.0 && a + b <= 1.0);
            [a + b, b / (a + b)].map(|x| x.min(1.0 - 1e-12))
        },
        |[s, t], cell| triangle_density([s * (1.0 - t), s * t]) * s * cell,
    );
}

/// Means 1/3, mean squares 1/6 and mean product 1/12 of the uniform triangle, by integration.
#[test]
fn triangle_has_its_moments() {
    let n = 200_000;
    let mut sums = [0.0; 5];
    for u in points(n) {
        let [a, b] = triangle(u);
        for (sum, x) in sums.iter_mut().zip([a, b, a * a, b * b, a * b]) {
            *sum += x / f64::from(n);
        }
    }
    let [a, b, aa, bb, ab] = sums;
    // Standard errors: √(1/18/n) = 5e-4 of the means; those of the second moments are smaller. Five
    // of them.
    for (found, exact) in [
        (a, 1.0 / 3.0),
        (b, 1.0 / 3.0),
        (aa, 1.0 / 6.0),
        (bb, 1.0 / 6.0),
        (ab, 1.0 / 12.0),
    ] {
        assert!((found - exact).abs() < 2.7e-3, "{found} {exact}");
    }
}

#[test]
fn every_warp_returns_by_its_inverse() {
    for u in points(2000) {
        for (name, back) in [
            ("disc", disc_inverse(disc(u))),
            ("cosine", cosine_hemisphere_inverse(cosine_hemisphere(u))),
            ("gaussian", gaussian_spot_inverse(gaussian_spot(u))),
            ("sphere", sphere_inverse(sphere(u))),
            ("triangle", triangle_inverse(triangle(u))),
        ] {
            for d in 0..2 {
                // The maps and their inverses are a few roundings long; acos-like cancellation near
                // the poles costs half the digits at worst.
                assert!((u[d] - back[d]).abs() < 1e-7, "{name}: {u:?} -> {back:?}");
            }
        }
    }
}

#[test]
fn the_corners_of_the_square_stay_finite() {
    let edge = 1.0 - f64::EPSILON / 2.0;
    for u in [
        [0.0, 0.0],
        [edge, 0.0],
        [0.0, edge],
        [edge, edge],
        [0.5, 0.5],
    ] {
        assert!(
            disc(u)
                .iter()
                .chain(&gaussian_spot(u))
                .chain(&triangle(u))
                .all(|x| x.is_finite())
        );
        assert!(
            cosine_hemisphere(u)
                .iter()
                .chain(&sphere(u))
                .all(|x| x.is_finite())
        );
    }
}
