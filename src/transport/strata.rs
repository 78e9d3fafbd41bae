//! Points on the surfaces that light meets between wall and wall.

use std::f64::consts::FRAC_1_PI;

use super::form::form;
use super::hidden::HiddenArea;
use crate::geometry::{Basis, DVec3, Ray, ShapeId, SurfacePoint};
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::warp;
use crate::scene::Scene;

/// A point drawn from its stratum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub shape: ShapeId,
    pub point: SurfacePoint,
    /// Points per area, all strata together: N_c/A_c in texture cell c, plus what the anchor sends there. Σ f(y_k)/density_k over a block
    /// estimates ∫ f dA over all surfaces (the balance heuristic). Infinite for a point that counts nothing.
    pub density: f64,
}

/// How the surfaces are divided: by texture cells, each with points in proportion to its area times albedo, at least one; dark ones with
/// none, which is exact. No edge of a texture lies within a stratum, so within each the integrand is smooth whatever the direction of
/// the edges. Where there are more cells than points, or a net over all of them is stratified by each of them anyhow, one stratum drawn
/// from the distribution of area times albedo.
///
/// Where a surface comes close to what the camera sees, area alone would seldom hit what matters: as many points again are then sent out
/// from an anchor in the middle of the view, by the cosine.
#[derive(Debug)]
pub(super) struct Strata<'a> {
    scene: &'a Scene,
    sampling: Sampling,
    kind: Kind,
    /// By shape: the points per area of its cells; empty where none are drawn.
    grids: Vec<Grid>,
    anchor: Option<Anchor>,
}

#[derive(Clone, Debug, Default)]
struct Grid {
    count: [usize; 2],
    density: Vec<f64>,
}

/// A point in view from which directions are drawn by the cosine.
#[derive(Debug)]
struct Anchor {
    position: DVec3,
    normal: DVec3,
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
            position: point.position,
            normal: point.normal,
            shape: hit.shape,
            points,
        })
    }

    /// Points per area at y on `shape`: N·cosθ·cosθ′/(π d²) where the anchor sees y.
    fn density(&self, scene: &Scene, shape: ShapeId, y: &SurfacePoint) -> f64 {
        let Some((form, ray)) = form((self.position, self.normal), (y.position, y.normal)) else {
            return 0.0;
        };
        let ends = [Some(self.shape), Some(shape)];
        match scene.bvh().blocked(&ray, ends) {
            true => 0.0,
            false => f64::from(self.points) * FRAC_1_PI * form,
        }
    }

    /// What is seen along the direction of u; `None` where there is nothing.
    fn sample(&self, scene: &Scene, u: [f64; 2]) -> Option<(ShapeId, SurfacePoint)> {
        let local = warp::cosine_hemisphere(u);
        let direction = Basis::around(self.normal).to_world(local).normalize();
        let ray = Ray::new(self.position, direction);
        let hit = scene.bvh().closest(&ray, Some(self.shape))?;
        Some((hit.shape, scene.bvh().point(&ray, hit)))
    }
}

#[derive(Debug)]
enum Kind {
    Cells(Vec<Cell>),
    Distribution { area: HiddenArea, points: u32 },
}

#[derive(Debug)]
struct Cell {
    shape: ShapeId,
    /// Its corner and width in the surface's parameters.
    corner: [f64; 2],
    width: [f64; 2],
    area: f64,
    points: u32,
}

impl Cell {
    fn density(&self) -> f64 {
        f64::from(self.points) / self.area
    }
}

/// Whether surfaces come close to what the camera sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Near {
    Nothing,
    Something,
}

/// Cells of all surfaces beyond which no stratum is made of each.
const MOST_CELLS: usize = 1 << 20;

/// The stratum of the anchor's points, beyond those of any cells.
const ANCHOR: usize = u32::MAX as usize;

/// Which of count\[0\] × count\[1\] cells a place lies in.
fn index(count: [usize; 2], uv: [f64; 2]) -> usize {
    let cell = |d: usize| ((uv[d] * count[d] as f64) as usize).min(count[d] - 1);
    cell(0) + cell(1) * count[0]
}

impl<'a> Strata<'a> {
    /// Divides `shapes` for blocks of about `size` points; `near` tells whether any of them may be close to what the camera sees.
    pub(super) fn new(
        scene: &'a Scene,
        shapes: &[ShapeId],
        near: Near,
        sampling: Sampling,
        size: u32,
    ) -> Self {
        let mut cells = Vec::new();
        let mut weights = Vec::new();
        // More cells than this are never strata of their own: their list, which may be long, is not made.
        let many = shapes
            .iter()
            .map(|s| scene.surfaces[*s as usize].smooth_cells())
            .map(|[nu, nv]| nu * nv)
            .sum::<usize>()
            > MOST_CELLS;
        for &shape in shapes.iter().filter(|_| !many) {
            let surface = &scene.surfaces[shape as usize];
            let [nu, nv] = surface.smooth_cells();
            let area = surface.shape.area() / (nu * nv) as f64;
            for cell in 0..nu * nv {
                let weight = surface.cell_weight(cell) * area;
                if weight > 0.0 {
                    let at = |i: usize, n: usize| i as f64 / n as f64;
                    cells.push(Cell {
                        shape,
                        corner: [at(cell % nu, nu), at(cell / nu, nv)],
                        width: [1.0 / nu as f64, 1.0 / nv as f64],
                        area,
                        points: 0,
                    });
                    weights.push(weight);
                }
            }
        }
        let whole = HiddenArea::of(scene, shapes);
        let many = many && !whole.is_empty();
        if cells.is_empty() && !many {
            // No light is met between the walls, but footprints and beams have to be sampled all the same.
            let area = scene.surfaces[0].shape.area();
            cells.push(Cell {
                shape: 0,
                corner: [0.0; 2],
                width: [1.0; 2],
                area,
                points: 0,
            });
            weights.push(area);
        }
        let total: f64 = weights.iter().sum();
        let round = |points: f64| match sampling {
            Sampling::Pcg => (points.ceil() as u32).max(1),
            Sampling::Sobol => (points.ceil() as u32).max(1).next_power_of_two(),
        };
        let anchor = match near {
            Near::Nothing => None,
            Near::Something => Anchor::new(scene, round(f64::from(size) / 2.0)),
        };
        let size = if anchor.is_some() {
            size.div_ceil(2)
        } else {
            size
        };
        // A share of exactly a power of two must not become the next by rounding.
        let share = |w: f64| f64::from(size) * w / total * (1.0 - 1e-9);
        let together = many
            || cells.len() > size as usize
            || sampling == Sampling::Sobol && whole.is_dyadic(size);
        let kind = if together {
            Kind::Distribution {
                area: whole,
                points: round(f64::from(size)),
            }
        } else {
            for (cell, w) in cells.iter_mut().zip(&weights) {
                cell.points = round(share(*w));
            }
            Kind::Cells(cells)
        };
        let mut grids = vec![Grid::default(); scene.surfaces.len()];
        if let Kind::Cells(cells) = &kind {
            for cell in cells {
                let count = cell.width.map(|w| (1.0 / w).round() as usize);
                let grid = &mut grids[cell.shape as usize];
                grid.count = count;
                grid.density.resize(count[0] * count[1], 0.0);
                grid.density[index(count, cell.corner.map(|c| c + 1e-9))] = cell.density();
            }
        }
        Self {
            scene,
            sampling,
            kind,
            grids,
            anchor,
        }
    }

    /// Points per area that the cells, or their distribution, put at a place of `shape`.
    fn area_density(&self, shape: ShapeId, uv: [f64; 2]) -> f64 {
        match &self.kind {
            Kind::Distribution { area, points } => f64::from(*points) * area.density(shape, uv),
            Kind::Cells(_) => {
                let grid = &self.grids[shape as usize];
                match grid.density.is_empty() {
                    true => 0.0,
                    false => grid.density[index(grid.count, uv)],
                }
            }
        }
    }

    /// The point drawn by area with the density that the anchor adds to `density`.
    fn drawn(&self, shape: ShapeId, point: SurfacePoint, density: f64) -> Drawn {
        let anchor = self.anchor.as_ref();
        let further = anchor.map_or(0.0, |a| a.density(self.scene, shape, &point));
        Drawn {
            shape,
            point,
            density: density + further,
        }
    }

    /// The point in a direction from the anchor; where there is none, or none whose light is asked for, one that counts nothing.
    fn seen_from(&self, anchor: &Anchor, u: [f64; 2]) -> Drawn {
        let nothing = || Drawn {
            shape: anchor.shape,
            point: self.scene.surfaces[anchor.shape as usize]
                .shape
                .at([0.5; 2]),
            density: f64::INFINITY,
        };
        let Some((shape, point)) = anchor.sample(self.scene, u) else {
            return nothing();
        };
        let by_area = self.area_density(shape, point.uv);
        let by_cosine = form(
            (anchor.position, anchor.normal),
            (point.position, point.normal),
        )
        .map_or(0.0, |(form, _)| f64::from(anchor.points) * FRAC_1_PI * form);
        match by_cosine > 0.0 {
            true => Drawn {
                shape,
                point,
                density: by_area + by_cosine,
            },
            false => nothing(),
        }
    }

    /// Points in every block.
    pub(super) fn block_size(&self) -> usize {
        let by_area: usize = match &self.kind {
            Kind::Cells(cells) => cells.iter().map(|c| c.points as usize).sum(),
            Kind::Distribution { points, .. } => *points as usize,
        };
        by_area + self.anchor.as_ref().map_or(0, |a| a.points as usize)
    }

    /// Draws the points of a block, a function of their key alone, and hands each to `visit` with the other two dimensions of its
    /// set and the stream that goes on from there.
    pub(super) fn visit(&self, key: Key, mut visit: impl FnMut(Drawn, [f64; 2], &mut Stream)) {
        let mut draw = |stratum: usize, count: u32, place: &dyn Fn([f64; 2]) -> Drawn| {
            let mut stream = Stream::of_stratum(self.sampling, key, stratum as u32);
            for index in 0..count {
                stream.start(index);
                let [u, v, a, b] = stream.next_four();
                visit(place([u, v]), [a, b], &mut stream);
            }
        };
        match &self.kind {
            Kind::Cells(cells) => {
                for (stratum, cell) in cells.iter().enumerate() {
                    let shape = &self.scene.surfaces[cell.shape as usize].shape;
                    draw(stratum, cell.points, &|u| {
                        let at = |d: usize| cell.corner[d] + cell.width[d] * u[d];
                        self.drawn(cell.shape, shape.at([at(0), at(1)]), cell.density())
                    });
                }
            }
            Kind::Distribution { area, points } => draw(0, *points, &|u| {
                let (shape, point, density) = area.sample(self.scene, u);
                self.drawn(shape, point, f64::from(*points) * density)
            }),
        }
        if let Some(anchor) = &self.anchor {
            draw(ANCHOR, anchor.points, &|u| self.seen_from(anchor, u));
        }
    }
}
