//! Warps: measure-preserving maps from the unit square, each with its density and its inverse.
//!
//! Every warp is three functions: the map of a point of [0, 1)², the density of the result with respect to the
//! measure that the name states, and the inverse map.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, PI, TAU};

/// A point of the plane.
pub type Point2 = [f64; 2];

/// Unit square → unit disc, uniform in area (concentric map of Shirley and Chiu, 1997).
pub fn disc(u: Point2) -> Point2 {
    let [a, b] = [2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0];
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let (r, phi) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else {
        (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b))
    };
    let (sin, cos) = libm::sincos(phi);
    [r * cos, r * sin]
}

/// Density of [`disc`] per unit area: 1/π inside the unit circle.
pub fn disc_density(p: Point2) -> f64 {
    if p[0] * p[0] + p[1] * p[1] <= 1.0 {
        FRAC_1_PI
    } else {
        0.0
    }
}

/// Inverse of [`disc`].
pub fn disc_inverse(p: Point2) -> Point2 {
    let r = (p[0] * p[0] + p[1] * p[1]).sqrt();
    // φ in [−π/4, 7π/4), so that each quarter of the square is one branch.
    let mut phi = libm::atan2(p[1], p[0]);
    if phi < -FRAC_PI_4 {
        phi += TAU;
    }
    let quarter = phi / FRAC_PI_4;
    let [a, b] = if quarter < 1.0 {
        [r, quarter * r]
    } else if quarter < 3.0 {
        [-(quarter - 2.0) * r, r]
    } else if quarter < 5.0 {
        [-r, -(quarter - 4.0) * r]
    } else {
        [(quarter - 6.0) * r, -r]
    };
    [0.5 * (a + 1.0), 0.5 * (b + 1.0)]
}

/// Unit square → upper hemisphere (z > 0), density cosθ/π per steradian (Malley's method).
pub fn cosine_hemisphere(u: Point2) -> [f64; 3] {
    let [x, y] = disc(u);
    [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
}

/// Density of [`cosine_hemisphere`] per steradian.
pub fn cosine_hemisphere_density(cos_theta: f64) -> f64 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Inverse of [`cosine_hemisphere`].
pub fn cosine_hemisphere_inverse(w: [f64; 3]) -> Point2 {
    disc_inverse([w[0], w[1]])
}

/// Unit square → plane, density 2/(πw²)·exp(−2r²/w²): the profile of a Gaussian beam whose intensity has fallen to
/// 1/e² at radius w = 1. Multiply by w.
pub fn gaussian_spot(u: Point2) -> Point2 {
    // P(r) = 1 − exp(−2r²), inverted; log1p keeps u → 0 exact and u < 1 keeps r finite.
    let r = (-0.5 * libm::log1p(-u[0])).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    [r * cos, r * sin]
}

/// Density of [`gaussian_spot`] per unit area (w = 1).
pub fn gaussian_spot_density(p: Point2) -> f64 {
    2.0 * FRAC_1_PI * libm::exp(-2.0 * (p[0] * p[0] + p[1] * p[1]))
}

/// Inverse of [`gaussian_spot`].
pub fn gaussian_spot_inverse(p: Point2) -> Point2 {
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

/// Unit square → unit sphere, uniform per steradian.
pub fn sphere(u: Point2) -> [f64; 3] {
    let z = 1.0 - 2.0 * u[0];
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    [r * cos, r * sin, z]
}

/// Density of [`sphere`] per steradian: 1/(4π).
pub fn sphere_density() -> f64 {
    1.0 / (4.0 * PI)
}

/// Inverse of [`sphere`].
pub fn sphere_inverse(w: [f64; 3]) -> Point2 {
    let phi = libm::atan2(w[1], w[0]);
    [
        0.5 * (1.0 - w[2]),
        if phi < 0.0 {
            phi / TAU + 1.0
        } else {
            phi / TAU
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::statistics::chi_square_sf;
    use crate::num::stream::{Key, Sampling, Stream};

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

    /// χ² of the warped points over a grid of bins in `coordinates` (both in [0, 1)), against the density
    /// integrated over each bin by the midpoint rule.
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
    fn every_warp_returns_by_its_inverse() {
        for u in points(2000) {
            for (name, back) in [
                ("disc", disc_inverse(disc(u))),
                ("cosine", cosine_hemisphere_inverse(cosine_hemisphere(u))),
                ("gaussian", gaussian_spot_inverse(gaussian_spot(u))),
                ("sphere", sphere_inverse(sphere(u))),
            ] {
                for d in 0..2 {
                    // The maps and their inverses are a few roundings long; acos-like cancellation near the
                    // poles costs half the digits at worst.
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
}
