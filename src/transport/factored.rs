//! Estimator [`Factored`](super::Estimator::Factored): Φcam as a product of two matrices.
//!
//! The light that meets n ≥ 3 surfaces is, with x_p what pixel p sees and y every point that
//! reflects,
//!
//! ```text
//! Φ_n[p, l] = ∫ C_p(y) · L_n,l(y) dy      C_p(y) = E_p·(ρ3/π)·G(x_p, y)      L_3,l(y) = (ρ2/π)(y)·G(y, s_l)·(ρ1/π)·Φlaser
//! ```
//!
//! and L_n,l for n > 3 the same with a path from y to s_l. N points y_k of density N·p(y_k), drawn
//! by strata, give Φ̂_n = Σ_k C[p,k]·L_n[k,l]: unbiased for each block, because C and L are
//! evaluated at points of their own in footprint and beam, the same for all pixels and all spots.
//! Where surfaces come close to a spot, its column gets points of its own besides
//! ([`light_path`](super::light_path)).
//!
//! Where light meets at most three surfaces those between the walls need not be Lambertian: see
//! [`glossy`](super::glossy).
//!
//! Points that serve all pixels cannot crowd where each of them sees another surface up close.
//! Where the view reaches into the edge between two surfaces, C grows like 1/d² towards it and the
//! variance of those pixels' estimates has no bound: use `shared` there.

use std::ops::{ControlFlow, Range};

use rayon::prelude::*;

use super::camera::camera_terms;
use super::context::Context;
use super::glossy::GlossyPoint;
use super::light_path::light_end;
use super::light_points::LightPoints;
use super::spots::{LitPoints, batch};
use super::tally::{Moments, Tally};
use super::vertex::{Batch, Vertex};
use crate::geometry::{Blockers, DVec3};
use crate::num::control::Control;
use crate::num::lanes::{add_product, padded};
use crate::num::stream::Key;

/// Points that are multiplied together: a panel of the product stays in the nearest cache.
const CHUNK: usize = 256;
/// Numbers of L that are held at once, at most (1 MiB, so that they stay in the second cache); at
/// least one chunk of them.
const MOST_LIGHT: usize = 1 << 17;
/// Pixels that are evaluated together.
const TILE: usize = 16;

/// The estimator, for one scene and a range of spots.
pub(super) struct Factored<'a> {
    context: &'a Context<'a>,
    /// By pixel and shape: what may stand between.
    blockers: Vec<Vec<Blockers>>,
    columns: usize,
    /// Numbers in a row of sums: `columns`, padded to whole groups of lanes.
    width: usize,
    orders: usize,
    /// Orders from three surfaces on.
    deeper: usize,
}

/// The points of one block.
struct Points<'a> {
    /// Position and normal of the points y.
    at: Batch,
    /// Place in the footprints of all pixels.
    footprint: Vec<[f64; 2]>,
    /// Place in the beams of all spots; empty if they have no width.
    beam: Vec<[f64; 2]>,
    /// By point and order: the end of the path that goes on from the point, itself first, with
    /// throughput 1/density.
    vertices: Vec<Option<Vertex>>,
    key: Key,
    light_paths: Vec<LightPoints<'a>>,
}

/// Points that are multiplied together.
struct Chunk<'a> {
    at: Batch,
    places: &'a [[f64; 2]],
    /// L by order from three surfaces on: points × spots.
    light: Vec<Vec<f64>>,
    /// Points that are not Lambertian; L_3 is without the factor d of their BRDF.
    glossy: Vec<(usize, GlossyPoint<'a>)>,
    lit: LitPoints<'a>,
}

impl<'a> Factored<'a> {
    pub(super) fn new(context: &'a Context<'a>) -> Self {
        let views = context.views.par_iter();
        let columns = context.spots.range.len();
        let orders = context.scene.max_bounces as usize;
        Self {
            context,
            blockers: views
                .map(|v| v.blockers(context.scene, &context.between))
                .collect(),
            columns,
            width: padded(columns),
            orders,
            deeper: orders.saturating_sub(2),
        }
    }

    /// The blocks from where `tally` ends up to `end`; fewer if stopped.
    pub(super) fn trace(
        &self,
        mut tally: Tally,
        end: u32,
        control: Control<'_>,
        after: &mut dyn FnMut(&Tally) -> ControlFlow<(), u32>,
    ) -> Tally {
        let pixels = self.context.views.len() as u64;
        let paths = pixels * u64::from(self.context.plan.budget.size);
        let first = tally.range().end;
        let mut points = self.points(first);
        for block in first..end {
            // The next points are drawn, one after the other, while these are multiplied.
            let next = || (block + 1 < end).then(|| self.points(block + 1));
            let (moments, next) = rayon::join(|| self.block(&points, control), next);
            let Some(moments) = moments else { break };
            tally
                .add(block..block + 1, moments)
                .expect("blocks follow one another");
            (control.progress)(paths);
            if after(&tally).is_break() {
                break;
            }
            if let Some(next) = next {
                points = next;
            }
        }
        tally
    }

    /// The estimate of one block; `None` if stopped.
    ///
    /// While they are made its sums lie in memory as \[tile\]\[order\]\[pixel in tile\]\[column\].
    fn block(&self, points: &Points<'_>, control: Control<'_>) -> Option<Moments> {
        let pixels = self.context.views.len();
        let tile_length = (self.orders * TILE * self.width).max(1);
        let mut sums = vec![0.0; pixels.div_ceil(TILE) * tile_length];
        let count = points.footprint.len();
        let together = (MOST_LIGHT / (self.width * self.deeper.max(1)) / CHUNK).max(1) * CHUNK;
        for start in (0..count).step_by(together) {
            if control.stopped() {
                return None;
            }
            let end = (start + together).min(count);
            let chunks: Vec<Chunk<'_>> = (start..end)
                .into_par_iter()
                .step_by(CHUNK)
                .map(|first| self.chunk(points, first..(first + CHUNK).min(end)))
                .collect();
            sums.par_chunks_mut(tile_length)
                .enumerate()
                .for_each(|(tile, sums)| {
                    let first = tile * TILE;
                    let pixels = first..(first + TILE).min(pixels);
                    for chunk in &chunks {
                        self.add_tile(pixels.clone(), chunk, count, sums);
                    }
                });
        }
        let order = TILE * self.width;
        let add = |(tile, sums): (usize, &mut [f64])| {
            for (i, pixel) in (tile * TILE..pixels).take(TILE).enumerate() {
                let (view, blockers) = (&self.context.views[pixel], &self.blockers[pixel]);
                for own in &points.light_paths {
                    sums[2 * order + i * self.width + own.column] +=
                        own.flux(self.context, view, blockers);
                }
            }
        };
        if !points.light_paths.is_empty() {
            sums.par_chunks_mut(tile_length).enumerate().for_each(add);
        }
        let mut flat = vec![0.0; self.orders * pixels * self.columns];
        flat.par_chunks_mut(self.columns.max(1))
            .enumerate()
            .for_each(|(row, out)| {
                let (order, pixel) = (row / pixels, row % pixels);
                let row = (pixel / TILE * self.orders + order) * TILE + pixel % TILE;
                out.copy_from_slice(&sums[row * self.width..row * self.width + self.columns]);
            });
        Some(Moments::of_block(flat, self.orders))
    }

    /// Draws the points of a block and, where light may meet more than three surfaces, the paths
    /// that go on from them.
    fn points(&self, block: u32) -> Points<'a> {
        let Context { scene, strata, .. } = self.context;
        let count = strata.block_size();
        let key = Key {
            seed: self.context.plan.seed,
            spot: Key::ALL_SPOTS,
            pixel: Key::ALL_PIXELS,
            block,
        };
        let mut points = Points {
            at: Batch::zeros(count),
            footprint: Vec::with_capacity(count),
            beam: Vec::new(),
            vertices: vec![None; count * self.deeper],
            key,
            light_paths: Vec::new(),
        };
        strata.visit(key, |drawn, place, stream| {
            let k = points.footprint.len();
            points.footprint.push(place);
            points.at.set(k, drawn.oriented(), 1.0, drawn.shape);
            if self.context.spots.beams.has_width() {
                let [s, t, ..] = stream.next_four();
                points.beam.push([s, t]);
            }
            let [u, v, choice, _] = if self.deeper > 1 {
                stream.next_four()
            } else {
                [0.0; 4]
            };
            // A point elsewhere sends no light to any pixel.
            let throughput = 1.0 / drawn.density;
            let y = Vertex {
                density: drawn.density,
                ..Vertex::new(scene, drawn.shape, &drawn.point, DVec3::ZERO, throughput)
            };
            let counts = self.context.between.contains(&y.shape) && y.reflects(scene);
            let first = counts.then_some(y);
            let ends = &mut points.vertices[k * self.deeper..];
            let (vertices, first_step) = (self.deeper as u32, [u, v, choice]);
            let path = &self.context.path;
            path.trace(first, vertices, (first_step, None), stream, |n, vertex| {
                ends[n as usize - 1] = Some(*vertex);
            });
        });
        let near = self.context.spots.light_paths.columns(&(0..self.columns));
        points.light_paths = near
            .iter()
            .map(|c| LightPoints::draw(self.context, key, *c))
            .collect();
        points
    }

    fn chunk<'p>(&'p self, points: &'p Points<'_>, range: Range<usize>) -> Chunk<'p> {
        let beams = points.beam.get(range.clone()).unwrap_or_default();
        let lit = self.context.spots.points(beams, &(0..self.columns));
        let glossy = |i: usize| {
            let y = points
                .vertices
                .get((range.start + i) * self.deeper)?
                .as_ref()?;
            Some((i, GlossyPoint::new(self.context.scene, y, lit.at(i))?))
        };
        Chunk {
            glossy: (0..range.len()).filter_map(glossy).collect(),
            at: points.at.part(range.clone()),
            places: &points.footprint[range.clone()],
            light: self.light(points, range, &lit),
            lit,
        }
    }

    /// L for the points `range`, by order from three surfaces on: points × spots.
    fn light(
        &self,
        points: &Points<'_>,
        range: Range<usize>,
        lit: &LitPoints<'_>,
    ) -> Vec<Vec<f64>> {
        let Context { scene, spots, .. } = self.context;
        let paths = &spots.light_paths;
        let places = if lit.is_fixed() { 1 } else { range.len() };
        let batches: Vec<Batch> = (0..places)
            .map(|k| batch(scene, lit.at(k), self.width))
            .collect();
        let order = |n: usize| {
            let mut light = vec![0.0; range.len() * self.width];
            for (i, row) in light.chunks_mut(self.width).enumerate() {
                let Some(y) = &points.vertices[(range.start + i) * self.deeper + n] else {
                    continue;
                };
                let batch = &batches[if lit.is_fixed() { 0 } else { i }];
                let factor = scene.laser.power * y.throughput * y.constant_factor(scene);
                batch.geometry_terms_from(y.oriented(), factor, &batch.weight, row);
                let place = (y.position, y.shape);
                let m = if n == 0 { paths.count } else { 1 };
                let drawn = (y.oriented(), y.density, f64::from(m));
                paths.weigh(drawn, lit.at(i), 0, row);
                // The first is Lambertian, or its factor is multiplied in by the pixel.
                let factor = |p| if n == 0 { 1.0 } else { y.factor_from(scene, p) };
                spots.connect_row(place, lit.at(i), 0, row, factor);
            }
            if n > 0 {
                self.add_deeper(points, range.clone(), n, lit, &mut light);
            }
            light
        };
        (0..self.deeper).map(order).collect()
    }

    /// Adds to L the light paths that end on paths from the points `range`: one for each and every
    /// column that has any.
    fn add_deeper(
        &self,
        points: &Points<'_>,
        range: Range<usize>,
        n: usize,
        lit: &LitPoints<'_>,
        light: &mut [f64],
    ) {
        let Context {
            scene, spots, path, ..
        } = self.context;
        for (i, row) in light.chunks_mut(self.width).enumerate() {
            let k = range.start + i;
            let Some(x) = &points.vertices[k * self.deeper + n - 1] else {
                continue;
            };
            // No spot and no pixel has random numbers of its own here: these are the points'.
            let key = Key {
                spot: k as u32,
                pixel: 0,
                ..points.key
            };
            for &column in spots.light_paths.columns(&(0..self.columns)) {
                let mut stream = spots.light_paths.stream(key, column);
                let [u, v, ..] = stream.next_four();
                let Some(point) = &lit.at(i)[column] else {
                    continue;
                };
                let y = light_end(scene, point, [u, v]).and_then(|end| path.connect(x, &end, None));
                row[column] += y.map_or(0.0, |y| spots.light_from(point, &y));
            }
        }
    }

    /// Adds the points of a chunk to the sums of a tile of pixels.
    fn add_tile(&self, pixels: Range<usize>, chunk: &Chunk<'_>, count: usize, sums: &mut [f64]) {
        let Context { scene, spots, .. } = self.context;
        let Chunk {
            at, places, lit, ..
        } = chunk;
        let (width, inner) = (self.width, places.len());
        let rows = sums.len() / self.orders / width;
        let mut camera = vec![0.0; rows * inner];
        let mut x = Batch::zeros(inner);
        let power = scene.laser.power * (1.0 / count as f64);
        for (i, pixel) in pixels.enumerate() {
            let view = &self.context.views[pixel];
            view.vertices(scene, places, &mut x);
            let row = &mut camera[i * inner..(i + 1) * inner];
            camera_terms(
                (scene, self.context.is_glossy),
                &self.blockers[pixel],
                (&x, at),
                row,
            );
            for (k, y) in &chunk.glossy {
                let c = std::mem::take(&mut row[*k]);
                if c != 0.0 {
                    let three = &mut sums[(2 * rows + i) * width..(2 * rows + i + 1) * width];
                    let light = &chunk.light[0][k * width..(k + 1) * width];
                    y.add(c, x.place(*k).0, light, three);
                }
            }
            if self.context.has_two_bounce_light {
                let two = &mut sums[(rows + i) * width..(rows + i + 1) * width];
                let factor = |k, light| x.factor_from(scene, k, light);
                let alone = |_| f64::INFINITY;
                spots.add_light(&x, |k| power * x.weight[k], factor, alone, lit, two);
            }
            let one = &mut sums[i * width..(i + 1) * width];
            let first = |k: usize| view.vertex(scene, places[k]);
            self.context
                .direct
                .add(spots, pixel, (inner, power), first, lit, one);
        }
        for (n, light) in chunk.light.iter().enumerate() {
            let order = &mut sums[(n + 2) * rows * width..(n + 3) * rows * width];
            add_product(order, &camera, light, inner, width);
        }
    }
}
