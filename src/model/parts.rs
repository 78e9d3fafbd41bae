//! Hidden surfaces and footprints cut into parts that are far apart for their size.
//!
//! The integrand goes like 1/R⁴ of the distance R between a wall point and a hidden point. A
//! product rule of n nodes a side on a part of radius r converges like ρ^(−2n), ρ = y + √(1 + y²),
//! y the distance in units of r: parts that light or sight come closer to than their own diameter
//! are cut in four until none is left, ever smaller towards the near end; and the farther a part
//! is for its size, the fewer nodes it gets. Triangles are cut along the edges of their texture,
//! discs where their parameters have a kink.

mod edges;
mod footprint;

use std::borrow::Cow;

use super::cells::HiddenCell;
use super::kernel::HiddenPoint;
use super::place::{Place, area_of, grid, grid_of_disc, on_triangle, triangles, within};
use crate::geometry::{DVec3, Shape, ShapeId};
use crate::num::quadrature::Rule;
use crate::scene::{Division, Element, Scene, Surface};
pub(super) use footprint::{Crossed, Figure, FootprintPart, Footprints};

/// Distance from the middle of a part to what it is far from, in radii of the part.
const FAR: f64 = 2.0;
/// Cuts of one cell of a texture, and of one footprint.
const MOST_CUTS: u32 = 40;
const MOST_FOOTPRINT_CUTS: u32 = 5;
/// Parts that cutting may add to all hidden surfaces together, and to one footprint.
const MOST_ADDED: usize = 6_000;
const MOST_FOOTPRINT_PARTS: usize = 64;
/// Connections between wall points and hidden points beyond which no finer rule is tried.
pub(super) const MOST_CONNECTIONS: f64 = 2e8;
/// What an integration may cost, in connections, where the hidden surfaces and the walls are
/// refined apart.
pub(super) const MOST_APART: f64 = 4e9;

/// Nodes a side of a part that is [`FAR`] by level of refinement, and the last level.
pub(super) const NODES: [f64; 8] = [2.0, 4.0, 7.0, 10.0, 14.0, 19.0, 26.0, 34.0];
pub(super) const LAST_LEVEL: usize = NODES.len() - 1;

/// Nodes a side at `level` of a part whose middle is `distance` of its radii away, so that parts
/// far and near converge alike: n ∝ 1/ln ρ. Each level has more than the one before.
fn nodes_a_side(distance: f64, level: usize) -> usize {
    let rate = |y: f64| libm::log(y + libm::hypot(1.0, y));
    let share = rate(FAR) / rate(distance.clamp(0.6 * FAR, 1e9));
    let needed = |level: usize| ((NODES[level] * share).ceil() as usize).max(1);
    (0..=level)
        .map(|l| needed(l) + level - l)
        .max()
        .unwrap_or(1)
}

/// A ball of the wall that is lit or seen as one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub middle: DVec3,
    pub radius: f64,
}

/// Balls, and the box around them.
struct Balls<'a> {
    all: &'a [Ball],
    low: DVec3,
    high: DVec3,
}

impl<'a> Balls<'a> {
    fn new(all: &'a [Ball]) -> Self {
        let corner = |sign: f64| {
            all.iter()
                .map(move |b| b.middle + DVec3::splat(sign * b.radius))
        };
        Self {
            all,
            low: corner(-1.0).fold(DVec3::INFINITY, DVec3::min),
            high: corner(1.0).fold(DVec3::NEG_INFINITY, DVec3::max),
        }
    }

    /// Distance from a part of this middle and radius to the nearest of them that is not larger
    /// than twice the part (that one is cut itself), in radii of the part; at least so much where
    /// that is far enough.
    fn distance(&self, middle: DVec3, radius: f64) -> f64 {
        let rough = (middle - middle.clamp(self.low, self.high)).length() / radius;
        if rough >= 2.0 * FAR {
            return rough;
        }
        let small = self.all.iter().filter(|b| 0.5 * b.radius < radius);
        let apart = small.map(|b| ((middle - b.middle).length() - b.radius) / radius);
        apart.fold(f64::INFINITY, f64::min)
    }
}

/// The hidden surfaces of a scene, Lambertian, in parts.
pub(super) struct HiddenParts<'a> {
    surfaces: Vec<Cow<'a, Surface>>,
    /// Which surfaces of the scene they are.
    ids: Vec<ShapeId>,
    /// Surface and place of each part, and its distance in radii.
    parts: Vec<(usize, Place, f64)>,
    /// Surfaces with too many cells, and into how many elements a side they are divided instead at
    /// level 0: each with its mean albedo, and a node in its middle.
    coarse: Vec<usize>,
    coarse_side: usize,
    /// How often each part was cut in four.
    halvings: u32,
}

impl<'a> HiddenParts<'a> {
    /// The cells of the textures and the triangles of the meshes, cut where `near` is near.
    pub(super) fn new(scene: &'a Scene, near: &[Ball]) -> Self {
        let hidden = scene.hidden();
        let walls = 4.0 * near.len() as f64;
        let mut found = Self {
            ids: scene.hidden().map(|(id, _)| id as ShapeId).collect(),
            surfaces: hidden.map(|(_, s)| s.lambertian_equivalent()).collect(),
            parts: Vec::new(),
            coarse: Vec::new(),
            coarse_side: ((0.25 * MOST_CONNECTIONS / walls).sqrt() as usize).clamp(8, 256),
            halvings: 0,
        };
        // Four nodes a part and as many a footprint must be few enough.
        let most = (0.25 * MOST_APART / walls) as usize;
        let mut whole = Vec::new();
        for (index, surface) in found.surfaces.iter().enumerate() {
            match &surface.shape {
                _ if surface.division == Division::Cells && cells(surface) > most => {
                    found.coarse.push(index);
                }
                Shape::Instance(body) if !body.is_exact_patch() => {
                    whole.extend(triangles(body).into_iter().map(|place| (index, place)));
                }
                Shape::Disc(_) => {
                    let cells = grid_of_disc(surface.albedo.smooth_cells());
                    whole.extend(cells.into_iter().map(|place| (index, place)));
                }
                _ => {
                    let cells = grid(surface.albedo.smooth_cells());
                    whole.extend(cells.map(|place| (index, place)));
                }
            }
        }
        // Generation by generation, so that what is too much is left out at the finest.
        let near = Balls::new(near);
        let mut room = MOST_ADDED;
        for generation in 0..=MOST_CUTS {
            let mut next = Vec::new();
            for (index, place) in whole {
                let (middle, radius) = place.ball(&found.surfaces[index]);
                let distance = near.distance(middle, radius);
                let close = distance < FAR && room >= 3 && generation < MOST_CUTS;
                if close {
                    room -= 3;
                    next.extend(place.quarters().map(|quarter| (index, quarter)));
                } else {
                    found.parts.push((index, place, distance));
                }
            }
            whole = next;
        }
        found
    }

    /// The same, each part in four.
    pub(super) fn quartered(self) -> Self {
        let parts = self.parts.iter();
        let quarters = parts.flat_map(|(index, place, distance)| {
            place
                .quarters()
                .map(|quarter| (*index, quarter, 2.0 * distance))
        });
        Self {
            parts: quarters.collect(),
            coarse_side: 2 * self.coarse_side,
            halvings: self.halvings + 1,
            ..self
        }
    }

    /// Each part once, by its middle.
    pub(super) fn cells(&self) -> Vec<HiddenCell> {
        let cell = |index: usize, place: &Place| {
            let surface = &*self.surfaces[index];
            let (element, corners) = place.cell(surface)?;
            let cell = HiddenCell::new((self.ids[index], surface), &element, corners)?;
            Some(cell.viewed_from(place, self.halvings))
        };
        let parts = self.parts.iter();
        let parts = parts.filter_map(|(index, place, _)| cell(*index, place));
        let coarse = self.coarse.iter().flat_map(|index| {
            let surface = &self.surfaces[*index];
            let elements = surface.divided([self.coarse_side; 2]).into_iter();
            elements.filter_map(|e| HiddenCell::new((self.ids[*index], surface), &e, None))
        });
        parts.chain(coarse).collect()
    }

    /// Number of nodes at `level`.
    pub(super) fn count(&self, level: usize) -> usize {
        let parts = self.parts.iter();
        parts
            .map(|(.., y)| nodes_a_side(*y, level).pow(2))
            .sum::<usize>()
            + self.coarse.len() * (self.coarse_side << level).pow(2)
    }

    /// Nodes of a rule over all of it: n × n a part, a triangle's folded onto it from the square by
    /// (u, v) → (1 − u, u·(1 − v), u·v), whose area element is twice the triangle's area times u;
    /// with one node its centroid. Each with its share of the area · albedo/π, length².
    pub(super) fn nodes(&self, level: usize) -> Vec<(HiddenPoint, f64)> {
        let mut found = Vec::with_capacity(self.count(level));
        let mut rules: Vec<Option<Vec<_>>> = Vec::new();
        let mut add = |surface: &Surface, element: &Element| {
            if element.albedo > 0.0 && element.area > 0.0 {
                let weight = element.area * element.albedo * std::f64::consts::FRAC_1_PI;
                found.push((HiddenPoint::new(surface, element), weight));
            }
        };
        for (index, place, distance) in &self.parts {
            let surface = &*self.surfaces[*index];
            let n = nodes_a_side(*distance, level);
            if rules.len() <= n {
                rules.resize(n + 1, None);
            }
            let square = &*rules[n].get_or_insert_with(|| plane_nodes(n).collect());
            match (place, &surface.shape) {
                (Place::Triangle { id, corners }, Shape::Instance(body)) => {
                    for (weights, share) in folded(n, square) {
                        let element = on_triangle(surface, body, *id, corners, weights, share);
                        add(surface, &element);
                    }
                }
                (Place::Triangle { .. }, _) => {}
                (Place::Wedge { corners }, shape) => {
                    let whole = shape.area() * area_of(corners);
                    for (weights, share) in folded(n, square) {
                        let point = surface.element_at(within(corners, weights));
                        let area = share * whole;
                        add(surface, &Element { area, ..point });
                    }
                }
                (Place::Cell { from, size }, shape) => {
                    let area = shape.area() * size[0] * size[1];
                    for ([a, b], w) in square {
                        let uv = [from[0] + a * size[0], from[1] + b * size[1]];
                        let point = surface.element_at(uv);
                        let area = w * area;
                        add(surface, &Element { area, ..point });
                    }
                }
            }
        }
        for index in &self.coarse {
            let surface = &self.surfaces[*index];
            let elements = surface.divided([self.coarse_side << level; 2]);
            elements.iter().for_each(|e| add(surface, e));
        }
        found
    }
}

/// Barycentric nodes of a triangle with their shares of its area.
fn folded(n: usize, square: &[([f64; 2], f64)]) -> Vec<([f64; 3], f64)> {
    if n == 1 {
        return vec![([1.0 / 3.0; 3], 1.0)];
    }
    let fold = |([u, v], w): &([f64; 2], f64)| ([1.0 - u, u * (1.0 - v), u * v], 2.0 * u * w);
    square.iter().map(fold).collect()
}

/// Cells of a hidden surface within which it is smooth: of its texture, or the triangles.
fn cells(surface: &Surface) -> usize {
    match &surface.shape {
        Shape::Instance(body) if !body.is_exact_patch() => body.facet_count(),
        _ => surface.albedo.smooth_cells().iter().product(),
    }
}

/// Product rule on the unit square; the weights add up to 1.
fn plane_nodes(n: usize) -> impl Iterator<Item = ([f64; 2], f64)> {
    let rule = Rule::gauss_legendre(n);
    let pairs: Vec<(f64, f64)> = rule.on(0.0, 1.0).collect();
    (0..n * n).map(move |i| {
        let ((a, wa), (b, wb)) = (pairs[i % n], pairs[i / n]);
        ([a, b], wa * wb)
    })
}
