//! Spots that hang over the end of a flat wall with straight edges.
//!
//! What of such a spot lies on one wall is triangles from a point of it to each side that cuts it,
//! and sectors between these. As the spot moves by v against the wall, it loses ∫ f v·n ds over
//! those sides, f its power per area.

mod figure;

use super::place::{CORNERS, halved};
use super::spot::{self, density, profile_nodes, reach};
use super::wall_point::{self, WallPoint};
use crate::geometry::{Basis, DVec3, Shape};
use crate::scene::{Profile, Scene, Spot};
use figure::{CORNER, along_side, chords, inside, nodes_within};

/// Half the side of a square about a spot over its reach.
const BEYOND: f64 = 1.01;
/// Figures into which a spot is cut, at most.
const MOST_FIGURES: usize = 256;
/// Points of a wall's end are taken this part of their way from within, on the wall.
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

/// Points of the ends of walls across a spot, each lit by f, W length⁻², and the normals there
/// outwards times the length that each stands for.
pub(super) fn ends(
    scene: &Scene,
    spot: usize,
    profile: Profile,
    n: usize,
) -> Vec<(WallPoint, DVec3)> {
    let of_one = || corners(scene, spot).map(|corners| vec![corners.to_vec()]);
    let figures = figures(scene, spot, profile)
        .or_else(of_one)
        .unwrap_or_default();
    let along = along_side(profile, n);
    let reach = reach(profile);
    let basis = Basis::around(scene.laser.spots[spot].target.normal);
    let sides = figures.iter().flat_map(|figure| {
        let chords = chords(reach, figure);
        let within = inside(figure, &chords, reach).unwrap_or_default();
        chords.into_iter().map(move |chord| (chord, within))
    });
    let nodes = sides.flat_map(|(chord, within)| {
        let node = |(at, w): ([f64; 2], f64)| {
            let [x, y] = [0, 1].map(|i| within[i] + INSIDE * (at[i] - within[i]));
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
/// edges, of what lies on it and on other walls. None of other spots.
fn nodes_to_its_end(
    scene: &Scene,
    spot: usize,
    profile: Profile,
    n: usize,
) -> Option<Vec<([f64; 2], f64)>> {
    if let Some(figures) = figures(scene, spot, profile) {
        let nodes = figures.iter().flat_map(|f| nodes_within(profile, n, f));
        return Some(nodes.flatten().collect());
    }
    nodes_within(profile, n, &corners(scene, spot)?)
}

/// Convex figures about the middle of a spot, in each of which its beam meets one wall of those
/// that are flat with straight edges, and one cell of its texture: between the planes through the
/// laser and the edges of walls and cells. None where it meets no other wall than its own and no
/// other cell, and where these are too many.
fn figures(scene: &Scene, spot: usize, profile: Profile) -> Option<Vec<Vec<[f64; 2]>>> {
    let reach = reach(profile);
    if reach == 0.0 {
        return None;
    }
    let own = scene.laser.spots.get(spot)?;
    let (aim, basis) = (aims(scene, own), Basis::around(own.target.normal));
    let mut figures = vec![
        CORNERS
            .map(|at| at.map(|x| BEYOND * reach * (2.0 * x - 1.0)))
            .to_vec(),
    ];
    let sides = scene.relays().filter_map(|(_, wall)| match &wall.shape {
        Shape::Parallelogram(wall) => Some(wall.sides()),
        _ => None,
    });
    let seams = scene
        .relays()
        .filter_map(|(id, wall)| Some((id, wall.seams()?)));
    let seams = seams.flat_map(|(id, seams)| seams.into_iter().map(move |ends| (ends, Some(id))));
    let mut is_motley = false;
    for (line, seam) in sides.flatten().map(|ends| (ends, None)).chain(seams) {
        let height = height(scene, line, &aim);
        if crosses(&height, reach) {
            let halves = figures.iter().flat_map(|f| halved(f, &height));
            figures = halves.filter(|f| f.len() > 2).collect();
            is_motley |= seam == Some(own.surface as usize);
        }
        if figures.len() > MOST_FIGURES {
            return None;
        }
    }
    if figures.len() < 2 {
        return None;
    }
    let wall = |figure: &Vec<[f64; 2]>| {
        let [x, y] = inside(figure, &chords(reach, figure), reach)?;
        wall_point::lit(scene, spot, basis.to_world([x, y, 0.0]), 1.0).surface
    };
    let lit = figures.into_iter().filter_map(|f| Some((wall(&f)?, f)));
    let lit: Vec<_> = lit.collect();
    let is_other = lit.iter().any(|(id, _)| *id != own.surface);
    (is_other || is_motley).then(|| lit.into_iter().map(|(_, figure)| figure).collect())
}

/// The places of a spot's plane, from the laser.
fn aims(scene: &Scene, spot: &Spot) -> impl Fn([f64; 2]) -> DVec3 {
    let (target, laser) = (spot.target.position, scene.laser.position);
    let basis = Basis::around(spot.target.normal);
    move |[x, y]| target + basis.to_world([x, y, 0.0]) - laser
}

/// Their height over the plane through the laser and a line.
fn height(
    scene: &Scene,
    [a, b]: [DVec3; 2],
    aim: &impl Fn([f64; 2]) -> DVec3,
) -> impl Fn([f64; 2]) -> f64 {
    let laser = scene.laser.position;
    let edge = (a - laser).cross(b - laser);
    move |at| edge.dot(aim(at))
}

/// Whether a line at which this height is 0 crosses a spot: one that touches it leaves nothing
/// beyond.
fn crosses(height: impl Fn([f64; 2]) -> f64, reach: f64) -> bool {
    let [middle, along, up] = [[0.0; 2], [1.0, 0.0], [0.0, 1.0]].map(height);
    let slope = libm::hypot(along - middle, up - middle);
    middle.abs() < (1.0 - CORNER) * slope * reach
}

/// Whether the albedo may jump within what is taken of a spot in one: too many cells of a texture
/// lie there, or those of a wall that is no parallelogram.
pub(super) fn is_motley(scene: &Scene, spot: usize, profile: Profile) -> bool {
    let reach = reach(profile);
    if reach == 0.0 || figures(scene, spot, profile).is_some() {
        return false;
    }
    let own = &scene.laser.spots[spot];
    let aim = aims(scene, own);
    let crossed = |seam| crosses(height(scene, seam, &aim), reach);
    let seams = scene.surfaces[own.surface as usize].seams();
    seams.is_none_or(|seams| seams.into_iter().any(crossed))
}

#[cfg(test)]
mod tests;
