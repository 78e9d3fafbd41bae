//! What a spot of the laser lights, as nodes.

use std::f64::consts::{FRAC_1_PI, TAU};

use super::wall_point::{self, WallPoint};
use crate::geometry::Basis;
use crate::num::quadrature::Rule;
use crate::scene::{Profile, Scene};

/// The Gaussian profile is cut at this many of its 1/e² radii, beyond which lies e^−32 of the
/// power.
const GAUSSIAN_REACH: f64 = 4.0;

/// How far from its target a spot lights the wall.
pub(super) fn reach(profile: Profile) -> f64 {
    match profile {
        Profile::Ideal | Profile::Shining { .. } => 0.0,
        Profile::Disc { radius } => radius,
        Profile::Gaussian { radius } => GAUSSIAN_REACH * radius,
    }
}

/// The wall as each spot of this profile lights it, by `n` nodes from middle to rim; nothing
/// where a surface shines.
pub(super) fn lit(scene: &Scene, profile: Profile, n: usize) -> Vec<Vec<WallPoint>> {
    let spots = scene.laser.spots.len();
    if scene.laser.is_shining() {
        return vec![Vec::new(); spots];
    }
    let offsets = profile_nodes(profile, n);
    let lit = |l: usize| {
        let basis = Basis::around(scene.laser.spots[l].target.normal);
        let lit = |([x, y], w): &([f64; 2], f64)| {
            wall_point::lit(scene, l, basis.to_world([*x, *y, 0.0]), *w)
        };
        offsets.iter().map(lit).collect()
    };
    (0..spots).map(lit).collect()
}

/// Power per area at a distance r from the middle, of a spot of power 1: 1/(πR²) to its rim, or
/// 2/(πw²) e^(−2r²/w²).
pub(super) fn density(profile: Profile, r: f64) -> f64 {
    match profile {
        Profile::Disc { radius } if r <= radius => FRAC_1_PI / (radius * radius),
        Profile::Disc { .. } | Profile::Ideal | Profile::Shining { .. } => 0.0,
        Profile::Gaussian { radius: w } => {
            2.0 * FRAC_1_PI / (w * w) * libm::exp(-2.0 * (r / w) * (r / w))
        }
    }
}

/// Nodes of Gauss and Legendre from the middle to the rim.
pub(super) fn radial(profile: Profile, n: usize) -> usize {
    match profile {
        Profile::Gaussian { .. } => 4 * n,
        _ => n,
    }
}

/// Share of the power within r of the middle: (r/R)² to the rim of a disc, 1 − e^(−2r²/w²).
pub(super) fn power_within(profile: Profile, r: f64) -> f64 {
    match profile {
        Profile::Ideal | Profile::Shining { .. } => 1.0,
        Profile::Disc { radius } => (r / radius).min(1.0).powi(2),
        Profile::Gaussian { radius: w } => -libm::expm1(-2.0 * (r / w) * (r / w)),
    }
}

/// Radii between which rings lie that hold as much of the power as the rule by `radial` nodes gives
/// each of these, from 0 to the rim.
pub(super) fn rings(profile: Profile, radial: usize) -> Vec<f64> {
    let reach = reach(profile);
    let within = |share: f64| match profile {
        Profile::Gaussian { radius: w } => w * (-0.5 * libm::log1p(-share)).sqrt(),
        _ => reach * share.sqrt(),
    };
    let mut sum = 0.0;
    let mut found = vec![0.0];
    for (r, w) in Rule::gauss_legendre(radial).on(0.0, reach) {
        sum += w * TAU * r * density(profile, r);
        // All within rounding.
        found.push(if sum < 1.0 {
            within(sum).min(reach)
        } else {
            reach
        });
    }
    found[radial] = reach;
    found
}

/// Offsets in the wall's plane and shares of the power; the shares add up to 1 (a Gaussian's to 1 −
/// e^−32).
pub(super) fn profile_nodes(profile: Profile, n: usize) -> Vec<([f64; 2], f64)> {
    let reach = reach(profile);
    if reach == 0.0 {
        return vec![([0.0, 0.0], 1.0)];
    }
    // Radially Gauss–Legendre in r, with r dr; around the circle the trapezoidal rule, exact for
    // low orders.
    let (radial, around) = (radial(profile, n), 2 * n);
    let mut nodes = Vec::with_capacity(radial * around);
    for (r, w) in Rule::gauss_legendre(radial).on(0.0, reach) {
        let share = w * TAU * r * density(profile, r);
        for k in 0..around {
            let (sin, cos) = libm::sincos(TAU * (k as f64 + 0.5) / around as f64);
            nodes.push(([r * cos, r * sin], share / around as f64));
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ dP = 1 and ∫ r² dP = ½R² (disc), ½w² (Gaussian of 1/e² radius w).
    #[test]
    fn profiles_have_their_moments() {
        for (profile, second) in [
            (Profile::Disc { radius: 0.25 }, 0.5 * 0.0625),
            (Profile::Gaussian { radius: 0.25 }, 0.5 * 0.0625),
        ] {
            let nodes = profile_nodes(profile, 8);
            let total: f64 = nodes.iter().map(|(_, w)| w).sum();
            let moment: f64 = nodes.iter().map(|([x, y], w)| w * (x * x + y * y)).sum();
            assert!((total - 1.0).abs() < 1e-10, "{profile:?}: {total}");
            assert!(
                (moment / second - 1.0).abs() < 1e-10,
                "{profile:?}: {moment}"
            );
        }
    }
}
