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
use crate::geometry::{Basis, Ray};
use crate::num::quadrature::Rule;
use crate::scene::{Profile, Scene};

/// Places of a spot's rim at which an edge is looked for.
const RIM: usize = 64;
/// Lines from the middle of a spot that is cut, at least, halvings of the angle between two of
/// them, and what they may differ by.
const LINES: usize = 128;
const TURNS: u32 = 8;
const EVEN: f64 = 1e-3;
/// Places along a line at which light and shadow are told apart, and halvings of the distance of
/// two that differ.
const PLACES: usize = 64;
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
    let is_free = |w: &WallPoint| {
        let ray = Ray::between(scene.laser.position, w.position);
        ray.is_some_and(|ray| !scene.bvh().blocked(&ray, [None, w.surface]))
    };
    let rim = |k: usize| {
        let (sin, cos) = libm::sincos(TAU * k as f64 / RIM as f64);
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
                || (0..RIM).any(|k| is_free(&at(rim(k), 1.0)) != arrives));
        if !is_cut {
            let points = to_its_end(scene, l, profile, nodes).unwrap_or(points);
            let all = points.into_iter();
            return all.map(|whole| Lit::uncut(whole, arrives)).collect();
        }
        let is_lit = |place| {
            let point = at(place, 1.0);
            point.surface.is_some() && is_free(&point)
        };
        let cells = cells(profile, nodes, is_lit);
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
    nodes: usize,
    is_lit: impl Fn([f64; 2]) -> bool,
) -> Vec<(f64, [f64; 2])> {
    let around = 2 * nodes;
    let rings = rings(profile, radial(profile, nodes));
    let rule = Rule::gauss_legendre(4);
    let within = |[a, b]: [f64; 2]| power_within(profile, b) - power_within(profile, a);
    let line = |angle: f64| {
        let (sin, cos) = libm::sincos(angle);
        let free = free(reach(profile), |r| is_lit([r * cos, r * sin]));
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

/// The free parts of 0 to `reach`, from edge to edge; those that no place falls into are missed.
fn free(reach: f64, is_lit: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let at = |k: usize| reach * k as f64 / PLACES as f64;
    let mut found = Vec::new();
    let (mut from, mut was) = (0.0, is_lit(0.0));
    for k in 1..=PLACES {
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
mod tests {
    use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2};

    use super::*;

    /// A plate half way up whose shadow ends at x = e: of a disc of radius r it leaves
    /// ½ + (e √(r² − e²)/r² + asin(e/r))/π, of a Gaussian of 1/e² radius w what is below e of a
    /// normal distribution of deviation w/2; wherever e lies, to 1e-4, though a node is 3 %. The
    /// middle of what is left is that of the light below e, −⅔ (r² − e²)^1.5/(π r²) and −w/√(8π)
    /// e^(−2e²/w²) over it.
    #[test]
    fn a_beam_loses_what_an_edge_cuts_off() {
        let scene = |profile: &str, e: f64| {
            let text = format!(
                "name = \"cut\"\nunit = \"in\"\nmax_bounces = 3\n\
                 [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [0, 0, 10]\n\
                 spot_diameter = 1.0\nprofile = \"{profile}\"\n\
                 spots = {{ layout = \"list\", points = [[0, 0], [-9, 1], [9, 0]] }}\n\
                 [camera]\nposition = [-20, 2, 10]\naperture_area = 0.05\npixels = [2, 2]\n\
                 view = {{ x = [-3, -2], y = [-1, 1] }}\n\
                 [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
                 rectangle = {{ corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0] }}\n\
                 [[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
                 rectangle = {{ corner = [{}, -20, 5], u = [20, 0, 0], v = [0, 40, 0] }}\n\
                 material = {{ lambertian = 0.0 }}\n",
                0.5 * e
            );
            Scene::from_toml("cut", &text).unwrap()
        };
        for e in [-0.41, -0.2, -0.013, 0.0, 0.07, 0.33, 0.47] {
            for profile in ["disc", "gaussian"] {
                let scene = scene(profile, e);
                let all = reached(&scene, 4);
                let power = |spot: &[Lit], of: fn(&Lit) -> WallPoint| -> [f64; 2] {
                    let each = || spot.iter().map(of);
                    let moment = |w: WallPoint| w.weight * w.position.x;
                    [each().map(|w| w.weight).sum(), each().map(moment).sum()]
                };
                let shares: Vec<f64> = all
                    .iter()
                    .map(|spot| power(spot, |l| l.left)[0] / power(spot, |l| l.whole)[0])
                    .collect();
                let r = 0.5f64;
                let rest = r * r - e * e;
                let [want, moment] = if profile == "disc" {
                    let area = e * rest.sqrt() / (r * r) + libm::asin(e / r);
                    let moment = -2.0 / 3.0 * rest.powf(1.5) / (r * r);
                    [0.5 + area * FRAC_1_PI, moment * FRAC_1_PI]
                } else {
                    let x = e / (0.5 * r);
                    let height = libm::exp(-0.5 * x * x) / TAU.sqrt();
                    [0.5 * libm::erfc(-x * FRAC_1_SQRT_2), -0.5 * r * height]
                };
                let off = (shares[0] - want).abs();
                assert!(off < 1e-4, "{profile} {e}: {} for {want}", shares[0]);
                let [left, along] = power(&all[0], |l| l.left);
                let off = (along / left * want - moment).abs();
                assert!(
                    off < 1e-4,
                    "{profile} {e}: {} for {moment}",
                    along / left * want
                );
                assert_eq!(shares[1..], [1.0, 0.0], "{profile} {e}");
            }
        }
    }
}
