//! Points on the surfaces that light meets between the first and the last wall, stratified by area.

use std::f64::consts::FRAC_1_PI;

use super::area::{AreaSampler, SurfaceInteraction};
use super::vertex::{Oriented, geometry_term};
use crate::geometry::{Basis, Facets, Interaction, Ray, Shape, ShapeId};
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::warp;
use crate::scene::{Scene, Surface};

/// A point drawn from its stratum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub shape: ShapeId,
    pub point: Interaction,
    /// Points per area, all strata together: N_c/A_c in texture cell c, plus what the anchor sends
    /// there. Σ f(y_k)/density_k over a block estimates ∫ f dA over all surfaces (the balance
    /// heuristic). Infinite for a point that counts nothing.
    pub density: f64,
}

impl Drawn {
    pub(super) fn oriented(&self) -> Oriented {
        (self.point.position, self.point.normal)
    }
}

/// How the surfaces are divided: by texture cells, each with points in proportion to its area times
/// albedo, at least one; dark ones with none, which is exact. No edge of a texture lies within a
/// stratum, so within each the integrand is smooth whatever the direction of the edges. One
/// stratum, drawn from the distribution of area times albedo, where there are more cells than
/// points, or where a net over all of them is stratified by each of them already.
///
/// Where a surface comes close to what the camera sees, area alone would seldom hit what matters:
/// half of the points then follow a guess of what matters, and as many are sent out from an anchor
/// in the middle of the view, by the cosine.
#[derive(Debug)]
pub(super) struct Strata<'a> {
    scene: &'a Scene,
    sampling: Sampling,
    division: Division,
    anchor: Option<Anchor>,
}

#[derive(Debug)]
enum Division {
    Cells {
        cells: Vec<Cell>,
        /// By shape: the points per area of each of its cells; none where none are drawn.
        density: Vec<Vec<f64>>,
    },
    Distribution {
        area: AreaSampler,
        points: u32,
    },
}

#[derive(Debug)]
struct Cell {
    shape: ShapeId,
    /// Which of the smooth cells of its surface it is.
    index: usize,
    /// Its corner and its width in the parameters of the shape.
    corner: [f64; 2],
    width: [f64; 2],
    area: f64,
    points: u32,
}

impl Cell {
    fn density(&self) -> f64 {
        f64::from(self.points) / self.area
    }

    /// A cell of a surface, no points in it yet.
    fn new(shape: ShapeId, surface: &Surface, index: usize) -> Self {
        let (corner, width, area) = match &surface.shape {
            Shape::Instance(body) if !body.is_patch() => {
                let edges = body.facets().map_or(&[0.0, 1.0][..], Facets::edges);
                let along = edges[index + 1] - edges[index];
                ([edges[index], 0.0], [along, 1.0], body.area() * along)
            }
            shape => {
                let [nu, nv] = surface.smooth_cells();
                let at = |i: usize, n: usize| i as f64 / n as f64;
                let corner = [at(index % nu, nu), at(index / nu, nv)];
                let area = shape.area() / (nu * nv) as f64;
                (corner, [at(1, nu), at(1, nv)], area)
            }
        };
        Self {
            shape,
            index,
            corner,
            width,
            area,
            points: 0,
        }
    }
}

/// A point in view from which directions are drawn by the cosine.
#[derive(Debug)]
struct Anchor {
    oriented: Oriented,
    shape: ShapeId,
    points: u32,
}

impl Anchor {
    /// What the middle of the view shows.
    fn new(scene: &Scene, points: u32) -> Option<Self> {
        let camera = &scene.camera;
        let line = Ray::between(camera.position, camera.view.at([0.5, 0.5]).position)?;
        let ray = Ray::new(line.origin, line.direction);
        let hit = scene.bvh().closest(&ray, None)?;
        let point = scene.bvh().point(&ray, hit);
        (point.normal.dot(line.direction) < 0.0).then_some(Self {
            oriented: (point.position, point.normal),
            shape: hit.shape,
            points,
        })
    }

    /// Points per area at y if the anchor sees it, N·cosθ·cosθ′/(π d²), with the segment to y.
    fn density(&self, y: &Interaction) -> Option<(f64, Ray)> {
        let (term, ray) = geometry_term(self.oriented, (y.position, y.normal))?;
        Some((f64::from(self.points) * FRAC_1_PI * term, ray))
    }

    /// What is seen along the direction of u; `None` where there is nothing.
    fn sample(&self, scene: &Scene, u: [f64; 2]) -> Option<SurfaceInteraction> {
        let (position, normal) = self.oriented;
        let local = warp::cosine_hemisphere(u);
        let ray = Ray::new(position, Basis::around(normal).to_world(local).normalize());
        let hit = scene.bvh().closest(&ray, Some(self.shape))?;
        Some(SurfaceInteraction::hit(scene, &ray, hit))
    }
}

/// Cells of all surfaces beyond which no stratum is made of each.
const MOST_CELLS: usize = 1 << 20;

/// The stratum of the anchor's points, beyond those of any cells.
const ANCHOR: u32 = u32::MAX;

/// The cells of `shapes` that are not black, each with its area times albedo; `None` if they are
/// too many.
fn cells(scene: &Scene, shapes: &[ShapeId]) -> Option<Vec<(Cell, f64)>> {
    let surfaces = || shapes.iter().map(|s| (*s, &scene.surfaces[*s as usize]));
    let all = surfaces().map(|(_, s)| s.smooth_cells().iter().product::<usize>());
    if all.sum::<usize>() > MOST_CELLS {
        return None;
    }
    let mut cells = Vec::new();
    for (shape, surface) in surfaces() {
        let [nu, nv] = surface.smooth_cells();
        cells.extend((0..nu * nv).filter_map(|index| {
            let cell = Cell::new(shape, surface, index);
            let weight = surface.cell_weight(index) * cell.area;
            (weight > 0.0).then_some((cell, weight))
        }));
    }
    Some(cells)
}

impl<'a> Strata<'a> {
    /// Divides `shapes` for blocks of about `size` points; `close` samples them where any of them
    /// may be close to what the camera sees.
    pub(super) fn new(
        scene: &'a Scene,
        shapes: &[ShapeId],
        close: Option<AreaSampler>,
        (sampling, size): (Sampling, u32),
    ) -> Self {
        let round = |points: f64| match sampling {
            Sampling::Pcg => (points.ceil() as u32).max(1),
            Sampling::Sobol => (points.ceil() as u32).max(1).next_power_of_two(),
        };
        let anchor = close
            .as_ref()
            .and_then(|_| Anchor::new(scene, round(f64::from(size) / 2.0)));
        let size = if anchor.is_some() {
            size.div_ceil(2)
        } else {
            size
        };
        let mut cells = cells(scene, shapes).filter(|_| close.is_none());
        let area = close.unwrap_or_else(|| AreaSampler::new(scene, shapes));
        if area.is_empty() {
            // No light is met between the walls, but footprints and beams have to be sampled all
            // the same.
            let area = scene.surfaces[0].shape.area();
            let cell = Cell {
                shape: 0,
                index: 0,
                corner: [0.0; 2],
                width: [1.0; 2],
                area,
                points: 0,
            };
            cells = Some(vec![(cell, area)]);
        }
        let one_net = sampling == Sampling::Sobol && area.is_dyadic(size);
        let few = |cells: &Vec<_>| cells.len() <= size as usize && !one_net;
        let division = match cells.filter(few) {
            None => Division::Distribution {
                area,
                points: round(f64::from(size)),
            },
            Some(cells) => {
                let total: f64 = cells.iter().map(|(_, w)| w).sum();
                let mut density = vec![Vec::new(); scene.surfaces.len()];
                let with_points = cells.into_iter().map(|(mut cell, w)| {
                    // A share of exactly a power of two must not become the next by rounding.
                    let share = f64::from(size) * w / total * (1.0 - 1e-9);
                    cell.points = round(share);
                    let grid = &mut density[cell.shape as usize];
                    let [nu, nv] = scene.surfaces[cell.shape as usize].smooth_cells();
                    grid.resize(nu * nv, 0.0);
                    grid[cell.index] = cell.density();
                    cell
                });
                let cells = with_points.collect();
                Division::Cells { cells, density }
            }
        };
        Self {
            scene,
            sampling,
            division,
            anchor,
        }
    }

    /// Points per area that the cells, or their distribution, put at a point.
    fn area_density(&self, at: &SurfaceInteraction) -> f64 {
        match &self.division {
            Division::Distribution { area, points } => f64::from(*points) * area.density(at),
            Division::Cells { density, .. } => match &density[at.shape as usize] {
                grid if grid.is_empty() => 0.0,
                grid => grid[at.cell(self.scene)],
            },
        }
    }

    /// Points per area at a point that others drew, all strata together.
    pub(super) fn density(&self, at: &SurfaceInteraction) -> f64 {
        self.by_area(at, self.area_density(at)).density
    }

    /// The point drawn by area with `density`, and with what the anchor adds to it where it sees
    /// the point.
    fn by_area(&self, at: &SurfaceInteraction, density: f64) -> Drawn {
        let SurfaceInteraction { shape, point, .. } = *at;
        let from_anchor = self.anchor.as_ref().and_then(|anchor| {
            let (density, ray) = anchor.density(&point)?;
            let ends = [Some(anchor.shape), Some(shape)];
            (!self.scene.bvh().blocked(&ray, ends)).then_some(density)
        });
        Drawn {
            shape,
            point,
            density: density + from_anchor.unwrap_or(0.0),
        }
    }

    /// The point in a direction from the anchor; one that counts nothing where there is none.
    fn by_anchor(&self, anchor: &Anchor, u: [f64; 2]) -> Drawn {
        let seen = anchor.sample(self.scene, u).and_then(|at| {
            let (density, _) = anchor.density(&at.point).filter(|(d, _)| *d > 0.0)?;
            Some(Drawn {
                shape: at.shape,
                point: at.point,
                density: self.area_density(&at) + density,
            })
        });
        seen.unwrap_or_else(|| Drawn {
            shape: anchor.shape,
            point: self.scene.surfaces[anchor.shape as usize]
                .shape
                .at([0.5; 2]),
            density: f64::INFINITY,
        })
    }

    /// Points in every block.
    pub(super) fn block_size(&self) -> usize {
        let by_area: usize = match &self.division {
            Division::Cells { cells, .. } => cells.iter().map(|c| c.points as usize).sum(),
            Division::Distribution { points, .. } => *points as usize,
        };
        by_area + self.anchor.as_ref().map_or(0, |a| a.points as usize)
    }

    /// Draws the points of a block, a function of their key alone, and hands each to `visit` with
    /// the other two dimensions of its set and the stream that goes on from there.
    pub(super) fn visit(&self, key: Key, mut visit: impl FnMut(Drawn, [f64; 2], &mut Stream)) {
        let mut draw = |stratum: u32, count: u32, place: &dyn Fn([f64; 2]) -> Drawn| {
            let mut stream = Stream::of_stratum(self.sampling, key, stratum);
            for index in 0..count {
                stream.start(index);
                let [u, v, a, b] = stream.next_four();
                visit(place([u, v]), [a, b], &mut stream);
            }
        };
        match &self.division {
            Division::Cells { cells, .. } => {
                for (stratum, cell) in (0..).zip(cells) {
                    let (corner, width) = (cell.corner, cell.width);
                    draw(stratum, cell.points, &|u| {
                        let uv = std::array::from_fn(|d| corner[d] + width[d] * u[d]);
                        self.by_area(
                            &SurfaceInteraction::at(self.scene, cell.shape, uv),
                            cell.density(),
                        )
                    });
                }
            }
            Division::Distribution { area, points } => draw(0, *points, &|u| {
                let (point, density) = area.sample(self.scene, u);
                self.by_area(&point, f64::from(*points) * density)
            }),
        }
        if let Some(anchor) = &self.anchor {
            draw(ANCHOR, anchor.points, &|u| self.by_anchor(anchor, u));
        }
    }
}
