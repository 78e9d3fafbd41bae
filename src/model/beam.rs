//! What of the laser's beams reaches the wall past what stands in the way.
//!
//! Of a spot that is cut the light is followed along lines from its middle outwards, on each from
//! edge to edge. With S(r) the share of the spot's power within r, the free part from a to b of a
//! line within a cell of the spot has S(b) − S(a) of the light of that line, and the cell the mean
//! over its lines, at the middle of that light.

use std::f64::consts::TAU;

use super::overhang::to_its_end;
use super::spot::{density, lit, power_within, radial, reach, rings};
use super::wall_point::{self, WallPoint};
use crate::geometry::{Basis, Ray, Shape};
use crate::num::quadrature::Rule;
use crate::scene::{Profile, Scene};

/// Places of a spot's rim at which an edge is looked for, at least, and of those of a line.
const RIM: usize = 64;
const OF_PLACES: usize = 2;
/// Lines from the middle of a spot that is cut, at least, halvings of the angle between two of
/// them, and what they may differ by.
const LINES: usize = 128;
const TURNS: u32 = 8;
const EVEN: f64 = 1e-3;
/// Places along a line at which light and shadow are told apart, fewest and most, and of the
/// narrowest thing in the way; halvings of the distance of two that differ.
const PLACES: [usize; 2] = [64, 2048];
const OF_NARROWEST: f64 = 4.0;
const HALVINGS: u32 = 24;

/// A part of a spot, as it lights the wall with nothing in the way, and as what arrives of it does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lit {
    pub whole: WallPoint,
    pub left: WallPoint,
}

impl Lit {
    /// All of it arrives, or nothing.
    fn uncut(whole: WallPoint, arrives: bool) -> Self {
        let weight = if arrives { whole.weight } else { 0.0 };
        let left = WallPoint { weight, ..whole };
        Self { whole, left }
    }

    /// All of it arrives.
    pub(super) fn free(whole: WallPoint) -> Self {
        Self::uncut(whole, true)
    }
}

/// The parts of each spot by `nodes` from its middle to its rim. Of a spot without a size, and of
/// one whose nodes and rim all are reached or all are not, all arrives or nothing.
pub(super) fn reached(scene: &Scene, nodes: usize) -> Vec<Vec<Lit>> {
    let profile = scene.laser.profile;
    let places = places(scene, reach(profile));
    let is_free = |w: &WallPoint| {
        let ray = Ray::between(scene.laser.position, w.position);
        ray.is_some_and(|ray| !scene.bvh().blocked(&ray, [None, w.surface]))
    };
    let around = match places {
        few if few == PLACES[0] => RIM,
        many => OF_PLACES * many,
    };
    let rim = |k: usize| {
        let (sin, cos) = libm::sincos(TAU * k as f64 / around as f64);
        [cos, sin].map(|x| reach(profile) * x)
    };
    let spot = |(l, points): (usize, Vec<WallPoint>)| -> Vec<Lit> {
        let basis = Basis::around(scene.laser.spots[l].target.normal);
        let at = |[x, y]: [f64; 2], share: f64| {
            wall_point::lit(scene, l, basis.to_world([x, y, 0.0]), share)
        };
        let Some(arrives) = points.first().map(&is_free) else {
            return Vec::new();
        };
        let is_cut = points.len() > 1
            && (points.iter().any(|point| is_free(point) != arrives)
                || (0..around).any(|k| is_free(&at(rim(k), 1.0)) != arrives));
        if !is_cut {
            let points = to_its_end(scene, l, profile, nodes).unwrap_or(points);
            let all = points.into_iter();
            return all.map(|whole| Lit::uncut(whole, arrives)).collect();
        }
        let is_lit = |place| {
            let point = at(place, 1.0);
            point.surface.is_some() && is_free(&point)
        };
        let cells = cells(profile, (nodes, places), is_lit);
        let both = points.into_iter().zip(cells);
        both.map(|(whole, (share, middle))| match share {
            0.0 => Lit::uncut(whole, false),
            _ => Lit {
                whole,
                left: at(middle, share),
            },
        })
        .collect()
    };
    let spots = lit(scene, profile, nodes).into_iter().enumerate();
    spots.map(spot).collect()
}

/// Places along a line of length `reach`, so that no flat thing or ball falls between two.
fn places(scene: &Scene, reach: f64) -> usize {
    let width = |shape: &Shape| match shape {
        Shape::Parallelogram(p) => p.u().length().min(p.v().length()),
        Shape::Disc(d) => d.radius(),
        Shape::Sphere(s) => s.radius,
        Shape::Instance(_) => f64::INFINITY,
    };
    let narrowest = scene.surfaces.iter().map(|s| width(&s.shape));
    let narrowest = narrowest.fold(f64::INFINITY, f64::min);
    let [fewest, most] = PLACES;
    ((OF_NARROWEST * reach / narrowest) as usize).clamp(fewest, most)
}

/// A line from the middle of a spot outwards.
struct Line {
    angle: f64,
    /// Its free parts, by distance from the middle.
    free: Vec<[f64; 2]>,
    /// Share of its light in them.
    share: f64,
}

/// Share of the power in each cell of a spot that `is_lit` lets through, and the middle of it; the
/// cells lie about the nodes of its rule, and hold as much.
fn cells(
    profile: Profile,
    (nodes, places): (usize, usize),
    is_lit: impl Fn([f64; 2]) -> bool,
) -> Vec<(f64, [f64; 2])> {
    let around = 2 * nodes;
    let rings = rings(profile, radial(profile, nodes));
    let rule = Rule::gauss_legendre(4);
    let within = |[a, b]: [f64; 2]| power_within(profile, b) - power_within(profile, a);
    let line = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        let free = free((reach(profile), places), |r| is_lit([r * cos, r * sin]));
        let share = free.iter().map(|part| within(*part)).sum();
        Line { angle, free, share }
    };
    let mut found = vec![(0.0, [0.0; 2]); around * (rings.len() - 1)];
    let mut add = |sector: usize, line: &Line, weight: f64| {
        let (sin, cos) = libm::sincos(line.angle);
        for (i, ring) in rings.windows(2).enumerate() {
            for [from, until] in &line.free {
                let (a, b) = (from.max(ring[0]), until.min(ring[1]));
                if a < b {
                    let far = |(r, w): (f64, f64)| w * r * TAU * r * density(profile, r);
                    let along = rule.on(a, b).map(far).sum::<f64>() * weight;
                    let (share, moment) = &mut found[i * around + sector];
                    *share += within([a, b]) * weight;
                    moment[0] += along * cos;
                    moment[1] += along * sin;
                }
            }
        }
    };
    let parts = LINES.div_ceil(around);
    for sector in 0..around {
        let at = |i: usize| line(TAU * (sector * parts + i) as f64 / (around * parts) as f64);
        let mut from = at(0);
        for i in 1..=parts {
            let until = at(i);
            let mut own = |line: &Line, weight: f64| add(sector, line, weight);
            between([&from, &until], TURNS, &line, &mut own);
            from = until;
        }
    }
    for (share, moment) in &mut found {
        if *share > 0.0 {
            *moment = moment.map(|m| m / *share);
        }
    }
    found
}

/// Simpson's rule over the lines between two, in halves where the middle one has another share than
/// the mean of both.
fn between(
    [a, b]: [&Line; 2],
    halvings: u32,
    line: &dyn Fn(f64) -> Line,
    add: &mut dyn FnMut(&Line, f64),
) {
    let middle = line(0.5 * (a.angle + b.angle));
    if halvings > 0 && (middle.share - 0.5 * (a.share + b.share)).abs() > EVEN {
        between([a, &middle], halvings - 1, line, add);
        between([&middle, b], halvings - 1, line, add);
    } else {
        let sixth = (b.angle - a.angle) / (6.0 * TAU);
        add(a, sixth);
        add(&middle, 4.0 * sixth);
        add(b, sixth);
    }
}

/// The free parts of 0 to `reach`, from edge to edge; those that none of the places falls into are
/// missed.
fn free((reach, places): (f64, usize), is_lit: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let at = |k: usize| reach * k as f64 / places as f64;
    let mut found = Vec::new();
    let (mut from, mut was) = (0.0, is_lit(0.0));
    for k in 1..=places {
        if is_lit(at(k)) == was {
            continue;
        }
        let (mut a, mut b) = (at(k - 1), at(k));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (a + b);
            if is_lit(middle) == was {
                a = middle;
            } else {
                b = middle;
            }
        }
        let edge = 0.5 * (a + b);
        if was {
            found.push([from, edge]);
        }
        (from, was) = (edge, !was);
    }
    if was {
        found.push([from, reach]);
    }
    found
}

#[cfg(test)]
mod tests;
