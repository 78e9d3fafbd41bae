//! Spots that hang over the end of a flat wall with straight edges.
//!
//! What of such a spot lies on the wall is triangles from its middle to each side that cuts it, and
//! sectors between these. As the spot moves by v against the wall, it loses ∫ f v·n ds over those
//! sides, f its power per area.

use std::f64::consts::TAU;

use super::spot::{self, density, profile_nodes, radial, reach};
use super::wall_point::{self, WallPoint};
use crate::geometry::{Basis, DVec3, Shape};
use crate::num::quadrature::Rule;
use crate::scene::{Profile, Scene};

/// Sides of a figure whose ends are nearer than this part of a spot's reach meet.
const CORNER: f64 = 1e-9;
/// Points of the wall's end are taken this part of their offset, on the wall.
const INSIDE: f64 = 1.0 - 1e-9;

/// The wall as each spot of this profile lights it, to its end, by `n` nodes from middle to rim;
/// nothing where a surface shines.
pub(super) fn lit(scene: &Scene, profile: Profile, n: usize) -> Vec<Vec<WallPoint>> {
    let mut spots = spot::lit(scene, profile, n);
    for (l, lit) in spots.iter_mut().enumerate() {
        if let Some(own) = to_its_end(scene, l, profile, n) {
            *lit = own;
        }
    }
    spots
}

/// The wall as a spot lights it that ends where the wall does ([`nodes_to_its_end`]).
pub(super) fn to_its_end(
    scene: &Scene,
    spot: usize,
    profile: Profile,
    n: usize,
) -> Option<Vec<WallPoint>> {
    let nodes = nodes_to_its_end(scene, spot, profile, n)?;
    let basis = Basis::around(scene.laser.spots[spot].target.normal);
    let lit =
        |([x, y], w): ([f64; 2], f64)| wall_point::lit(scene, spot, basis.to_world([x, y, 0.0]), w);
    Some(nodes.into_iter().map(lit).collect())
}

/// How many points [`lit`] has.
pub(super) fn count(scene: &Scene, profile: Profile, n: usize) -> usize {
    if scene.laser.is_shining() {
        return 0;
    }
    let whole = profile_nodes(profile, n).len();
    let own = |l| nodes_to_its_end(scene, l, profile, n).map_or(whole, |nodes| nodes.len());
    (0..scene.laser.spots.len()).map(own).sum()
}

/// Points of the end of the wall across a spot, each lit by f, W length⁻², and the normals there
/// outwards times the length that each stands for.
pub(super) fn ends(
    scene: &Scene,
    spot: usize,
    profile: Profile,
    n: usize,
) -> Vec<(WallPoint, DVec3)> {
    let Some(corners) = corners(scene, spot) else {
        return Vec::new();
    };
    let along = along_side(profile, n);
    let basis = Basis::around(scene.laser.spots[spot].target.normal);
    let chords = chords(reach(profile), &corners).into_iter();
    let nodes = chords.flat_map(|chord| {
        let node = |(at, w): ([f64; 2], f64)| {
            let [x, y] = at.map(|x| INSIDE * x);
            let power = density(profile, libm::hypot(x, y));
            let point = wall_point::lit(scene, spot, basis.to_world([x, y, 0.0]), power);
            let [s, t] = chord.along;
            (point, basis.to_world([t, -s, 0.0]) * w)
        };
        chord
            .nodes(&along)
            .into_iter()
            .map(node)
            .collect::<Vec<_>>()
    });
    nodes.collect()
}

/// The corners of the flat wall with straight edges about a spot, from its middle,
/// counterclockwise. None of another wall, and where the middle is not on it.
fn corners(scene: &Scene, spot: usize) -> Option<[[f64; 2]; 4]> {
    let spot = scene.laser.spots.get(spot)?;
    let Shape::Parallelogram(wall) = &scene.surfaces[spot.surface as usize].shape else {
        return None;
    };
    let basis = Basis::around(spot.target.normal);
    let mut corners = wall.corners().map(|c| {
        let local = basis.to_local(c - spot.target.position);
        [local.x, local.y]
    });
    let turn = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    if turn(corners[0], corners[1]) < 0.0 {
        corners.reverse();
    }
    let mut sides = (0..4).map(|k| turn(corners[k], corners[(k + 1) % 4]));
    sides.all(|side| side > 0.0).then_some(corners)
}

/// Offsets and shares of the power of a spot that hangs over the end of a flat wall with straight
/// edges, of what lies on it. None of other spots.
fn nodes_to_its_end(
    scene: &Scene,
    spot: usize,
    profile: Profile,
    n: usize,
) -> Option<Vec<([f64; 2], f64)>> {
    nodes_within(profile, n, &corners(scene, spot)?)
}

/// What of the side of a figure lies within a spot.
struct Chord {
    ends: [[f64; 2]; 2],
    /// The direction of the side, the figure on its left.
    along: [f64; 2],
    /// Distance of the side from the middle of the spot.
    away: f64,
}

impl Chord {
    /// Places on it with lengths. A narrow profile is widest at the foot, from which the rule goes
    /// to both ends.
    fn nodes(&self, rule: &Rule) -> Vec<([f64; 2], f64)> {
        let [from, until] = self
            .ends
            .map(|[x, y]| x * self.along[0] + y * self.along[1]);
        let [s, t] = self.along;
        let at = |u: f64| [self.away * t + u * s, u * t - self.away * s];
        let parts = [from, 0.0f64.clamp(from, until), until];
        let parts = parts.windows(2).filter(|part| part[0] < part[1]);
        parts
            .flat_map(|part| rule.on(part[0], part[1]))
            .map(|(u, w)| (at(u), w))
            .collect()
    }
}

/// Of each side of a figure about the middle of a spot, its corners counterclockwise, what lies
/// within its reach.
fn chords(reach: f64, corners: &[[f64; 2]]) -> Vec<Chord> {
    let chord = |(k, a): (usize, &[f64; 2])| {
        let b = corners[(k + 1) % corners.len()];
        let to = [b[0] - a[0], b[1] - a[1]];
        let length = libm::hypot(to[0], to[1]);
        let along = to.map(|x| x / length);
        let away = a[0] * along[1] - a[1] * along[0];
        let foot = -(a[0] * along[0] + a[1] * along[1]);
        let half = (reach * reach - away * away).max(0.0).sqrt();
        let (from, until) = ((foot - half).max(0.0), (foot + half).min(length));
        let at = |s: f64| [0, 1].map(|i| a[i] + s * along[i]);
        let ends = [from, until].map(at);
        (from < until).then_some(Chord { ends, along, away })
    };
    corners.iter().enumerate().filter_map(chord).collect()
}

/// Offsets and shares of the power of what of a spot lies within a convex figure about its middle,
/// its corners counterclockwise: triangles from the middle to each side that cuts the spot, and
/// sectors between these by radius and angle, on all of which the profile is smooth. A rule over
/// all of the spot would jump there. None where all of the spot lies within.
fn nodes_within(profile: Profile, n: usize, corners: &[[f64; 2]]) -> Option<Vec<([f64; 2], f64)>> {
    let reach = reach(profile);
    let along = along_side(profile, n);
    let chords = chords(reach, corners);
    if chords.is_empty() {
        return None;
    }
    let mut nodes = Vec::new();
    for (k, chord) in chords.iter().enumerate() {
        for ([x, y], w) in chord.nodes(&along) {
            for (t, v) in along.on(0.0, 1.0) {
                let share = w * v * t * chord.away * density(profile, t * libm::hypot(x, y));
                nodes.push(([t * x, t * y], share));
            }
        }
        let [_, from] = chord.ends;
        let [until, _] = chords[(k + 1) % chords.len()].ends;
        // Sides that meet within the spot leave no sector between them.
        if libm::hypot(until[0] - from[0], until[1] - from[1]) < CORNER * reach {
            continue;
        }
        let [from, until] = [from, until].map(|[x, y]| libm::atan2(y, x));
        let turn = (until - from).rem_euclid(TAU);
        let around = Rule::gauss_legendre(2 + libm::ceil(2.0 * n as f64 * turn / TAU) as usize);
        for (phi, w) in around.on(from, from + turn) {
            let (sin, cos) = libm::sincos(phi);
            for (r, v) in along.on(0.0, reach) {
                nodes.push(([r * cos, r * sin], w * v * r * density(profile, r)));
            }
        }
    }
    Some(nodes)
}

/// The rule along a side, of twice the nodes from middle to rim: the light that the side takes as
/// it moves is as exact as that of the whole.
fn along_side(profile: Profile, n: usize) -> Rule {
    Rule::gauss_legendre(2 * radial(profile, n))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_PI;

    use super::*;

    /// What lies below x = e of a disc of radius r is ½ + (e √(r² − e²)/r² + asin(e/r))/π of it,
    /// its moment ∫ x dP −⅔ (r² − e²)^1.5/(π r²); of a Gaussian of 1/e² radius w, in a rectangle
    /// whose sides cut it, a product of normal distributions of deviation w/2. The corner of a
    /// rectangle at the middle's own distance leaves no less.
    #[test]
    fn a_spot_ends_where_its_wall_does() {
        let r = 0.5f64;
        let share = |profile, n, figure: &[[f64; 2]]| -> [f64; 2] {
            let nodes = nodes_within(profile, n, figure).unwrap();
            [0, 1].map(|k| {
                nodes
                    .iter()
                    .map(|([x, _], w)| if k == 0 { *w } else { x * w })
                    .sum()
            })
        };
        let box_to =
            |x: [f64; 2], y: [f64; 2]| [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        for e in [1e-9, 1e-3, 0.07, 0.3, 0.499] {
            let found = share(
                Profile::Disc { radius: r },
                8,
                &box_to([-9.0, e], [-7.0, 8.0]),
            );
            let rest = r * r - e * e;
            let want = 0.5 + (e * rest.sqrt() / (r * r) + libm::asin(e / r)) * FRAC_1_PI;
            let moment = -2.0 / 3.0 * rest.powf(1.5) * FRAC_1_PI / (r * r);
            assert!(
                (found[0] - want).abs() < 1e-10,
                "{e}: {} for {want}",
                found[0]
            );
            assert!(
                (found[1] - moment).abs() < 1e-10,
                "{e}: {} for {moment}",
                found[1]
            );
        }
        let below = |e: f64| 0.5 * libm::erfc(-e / (0.5 * r) * std::f64::consts::FRAC_1_SQRT_2);
        for (x, y) in [
            ([-9.0, 0.2], [-9.0, 9.0]),
            ([-9.0, 0.1], [-0.3, 9.0]),
            ([-0.4, 0.01], [-0.2, 0.7]),
        ] {
            let gaussian = Profile::Gaussian { radius: r };
            let found = share(gaussian, 8, &box_to(x, y))[0];
            let want = (below(x[1]) - below(x[0])) * (below(y[1]) - below(y[0]));
            assert!(
                (found - want).abs() < 1e-9,
                "{x:?} {y:?}: {found} for {want}"
            );
        }
        let far = box_to([-9.0, 9.0], [-9.0, 9.0]);
        assert!(nodes_within(Profile::Disc { radius: r }, 8, &far).is_none());
    }
}
