//! What of a spot lies within a convex figure of its plane.

use std::f64::consts::TAU;

use crate::model::spot::{density, radial, reach};
use crate::num::quadrature::Rule;
use crate::scene::Profile;

/// Sides of a figure whose ends are nearer than this part of a spot's reach meet.
pub(super) const CORNER: f64 = 1e-9;

/// What of the side of a figure lies within a spot.
pub(super) struct Chord {
    ends: [[f64; 2]; 2],
    /// The direction of the side, the figure on its left.
    pub along: [f64; 2],
    /// Distance of the side from the middle of the spot.
    away: f64,
}

impl Chord {
    /// Places on it with lengths. A narrow profile is widest at the foot, from which the rule goes
    /// to both ends.
    pub(super) fn nodes(&self, rule: &Rule) -> Vec<([f64; 2], f64)> {
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
pub(super) fn chords(reach: f64, corners: &[[f64; 2]]) -> Vec<Chord> {
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

/// A point within both a spot and a convex figure: its middle, or the mean of the ends of what of
/// the figure's sides lies within and of the arcs between. None where they do not meet.
pub(super) fn inside(corners: &[[f64; 2]], chords: &[Chord], reach: f64) -> Option<[f64; 2]> {
    let turn = |(k, a): (usize, &[f64; 2])| {
        let b = corners[(k + 1) % corners.len()];
        a[0] * b[1] - a[1] * b[0]
    };
    if corners.iter().enumerate().map(turn).all(|side| side > 0.0) {
        return Some([0.0; 2]);
    }
    let mut points: Vec<[f64; 2]> = chords.iter().flat_map(|chord| chord.ends).collect();
    for (k, chord) in chords.iter().enumerate() {
        if let Some((from, turn)) = arc(chord, &chords[(k + 1) % chords.len()], reach) {
            let (sin, cos) = libm::sincos(from + 0.5 * turn);
            points.push([reach * cos, reach * sin]);
        }
    }
    let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64;
    (!points.is_empty()).then(|| [mean(0), mean(1)])
}

/// The rim of a spot between two sides that cut it, its first angle and how far it goes; none
/// between sides that meet within the spot.
fn arc(side: &Chord, next: &Chord, reach: f64) -> Option<(f64, f64)> {
    let ([_, from], [until, _]) = (side.ends, next.ends);
    let meet = libm::hypot(until[0] - from[0], until[1] - from[1]) < CORNER * reach;
    let [from, until] = [from, until].map(|[x, y]| libm::atan2(y, x));
    (!meet).then(|| (from, (until - from).rem_euclid(TAU)))
}

/// Offsets and shares of the power of what of a spot lies within a convex figure, its corners
/// counterclockwise: triangles from a point within to each side that cuts the spot, and sectors to
/// the rim between these, on all of which the profile is smooth. A rule over all of the spot would
/// jump there. None where no side cuts the spot.
pub(super) fn nodes_within(
    profile: Profile,
    n: usize,
    corners: &[[f64; 2]],
) -> Option<Vec<([f64; 2], f64)>> {
    let reach = reach(profile);
    let along = along_side(profile, n);
    let chords = chords(reach, corners);
    let [x, y] = inside(corners, &chords, reach).filter(|_| !chords.is_empty())?;
    let mut nodes = Vec::new();
    // From the point within to a point of the boundary, which goes on by `step`.
    let mut reach_to = |[u, v]: [f64; 2], [du, dv]: [f64; 2]| {
        let (u, v) = (u - x, v - y);
        let area = (u * dv - v * du).abs();
        for (t, w) in along.on(0.0, 1.0) {
            let at = [x + t * u, y + t * v];
            let share = w * t * area * density(profile, libm::hypot(at[0], at[1]));
            nodes.push((at, share));
        }
    };
    for (k, chord) in chords.iter().enumerate() {
        for (at, w) in chord.nodes(&along) {
            reach_to(at, chord.along.map(|x| w * x));
        }
        let Some((from, turn)) = arc(chord, &chords[(k + 1) % chords.len()], reach) else {
            continue;
        };
        let around = Rule::gauss_legendre(2 + libm::ceil(2.0 * n as f64 * turn / TAU) as usize);
        for (phi, w) in around.on(from, from + turn) {
            let (sin, cos) = libm::sincos(phi);
            let step = w * reach;
            reach_to([reach * cos, reach * sin], [-step * sin, step * cos]);
        }
    }
    Some(nodes)
}

/// The rule along a side, of twice the nodes from middle to rim: the light that the side takes as
/// it moves is as exact as that of the whole.
pub(super) fn along_side(profile: Profile, n: usize) -> Rule {
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
        // The rest, which the middle does not lie in.
        for e in [1e-9, 0.07, 0.3, 0.49] {
            let found = share(
                Profile::Disc { radius: r },
                8,
                &box_to([e, 9.0], [-7.0, 8.0]),
            );
            let rest = r * r - e * e;
            let want = 0.5 - (e * rest.sqrt() / (r * r) + libm::asin(e / r)) * FRAC_1_PI;
            let moment = 2.0 / 3.0 * rest.powf(1.5) * FRAC_1_PI / (r * r);
            assert!((found[0] - want).abs() < 1e-10, "{e}: {found:?} {want}");
            assert!((found[1] - moment).abs() < 1e-10, "{e}: {found:?} {moment}");
            let gaussian = Profile::Gaussian { radius: r };
            let found = share(gaussian, 8, &box_to([e, 9.0], [0.1, 0.8]))[0];
            let want = (1.0 - below(e)) * (below(0.8) - below(0.1));
            assert!((found - want).abs() < 1e-9, "{e}: {found} for {want}");
        }
        let far = box_to([-9.0, 9.0], [-9.0, 9.0]);
        assert!(nodes_within(Profile::Disc { radius: r }, 8, &far).is_none());
    }
}
