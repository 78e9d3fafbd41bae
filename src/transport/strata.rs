//! Points on the surfaces that light meets between wall and wall.

use super::hidden::HiddenArea;
use crate::geometry::{ShapeId, SurfacePoint};
use crate::num::stream::{Key, Sampling, Stream};
use crate::scene::Scene;

/// A point drawn from its stratum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    pub shape: ShapeId,
    pub point: SurfacePoint,
    /// Points per area: N_c/A_c in stratum c, so that Σ f(y_k)/density_k over a block estimates ∫ f dA over all surfaces.
    pub density: f64,
}

/// How the surfaces are divided: by texture cells, each with points in proportion to its area times albedo, at least one; dark ones with
/// none, which is exact. No edge of a texture lies within a stratum, so within each the integrand is smooth whatever the direction of
/// the edges. Where there are more cells than points, one stratum drawn from the distribution of area times albedo.
#[derive(Debug)]
pub(super) struct Strata<'a> {
    scene: &'a Scene,
    sampling: Sampling,
    kind: Kind,
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

impl<'a> Strata<'a> {
    /// Divides `shapes` for blocks of about `size` points.
    pub(super) fn new(scene: &'a Scene, shapes: &[ShapeId], sampling: Sampling, size: u32) -> Self {
        let mut cells = Vec::new();
        let mut weights = Vec::new();
        for &shape in shapes {
            let surface = &scene.surfaces[shape as usize];
            let [nu, nv] = surface.albedo.smooth_cells();
            let area = surface.shape.area() / (nu * nv) as f64;
            for cell in 0..nu * nv {
                let weight = surface.albedo.cell_mean(cell) * area;
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
        if cells.is_empty() {
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
        // A share of exactly a power of two must not become the next by rounding.
        let share = |w: f64| f64::from(size) * w / total * (1.0 - 1e-9);
        let kind = if cells.len() > size as usize {
            Kind::Distribution {
                area: HiddenArea::of(scene, shapes),
                points: round(f64::from(size)),
            }
        } else {
            for (cell, w) in cells.iter_mut().zip(&weights) {
                cell.points = round(share(*w));
            }
            Kind::Cells(cells)
        };
        Self {
            scene,
            sampling,
            kind,
        }
    }

    /// Points in every block.
    pub(super) fn block_size(&self) -> usize {
        match &self.kind {
            Kind::Cells(cells) => cells.iter().map(|c| c.points as usize).sum(),
            Kind::Distribution { points, .. } => *points as usize,
        }
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
                        Drawn {
                            shape: cell.shape,
                            point: shape.at([at(0), at(1)]),
                            density: f64::from(cell.points) / cell.area,
                        }
                    });
                }
            }
            Kind::Distribution { area, points } => draw(0, *points, &|u| {
                let (shape, point) = area.sample(self.scene, u);
                Drawn {
                    shape,
                    point,
                    density: f64::from(*points) * area.density(shape, point.uv),
                }
            }),
        }
    }
}
