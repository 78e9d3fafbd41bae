//! Φcam as a matrix product.

use std::ops::{ControlFlow, Range};
use std::sync::atomic::Ordering;

use rayon::prelude::*;

use super::eye::hide;
use super::gloss;
use super::layout::{Layout, TILE};
use super::lit::Lit;
use super::packet::Packet;
use super::render::Control;
use super::setting::Setting;
use super::strata::Drawn;
use super::tally::Tally;
use super::walk::Vertex;
use crate::geometry::Blockers;
use crate::num::lanes::add_product;
use crate::num::stream::Key;

/// Points of S2 that are multiplied together: a panel of the product stays in the nearest cache.
const CHUNK: usize = 256;
/// Numbers of L that are held at once, at most (1 MiB, so that they stay in the second cache); at least one chunk of them.
const MOST_LIGHT: usize = 1 << 17;

/// The estimator that shares the points between the first and the last wall among all pixels and all spots.
///
/// The light that meets n ≥ 3 surfaces is, with x_p what pixel p sees, y every point that reflects,
///
/// ```text
/// Φ_n[p, l] = ∫ C_p(y) · L_n,l(y) dy      C_p(y) = E_p·(ρ3/π)·G(x_p, y)      L_3,l(y) = (ρ2/π)(y)·G(y, s_l)·(ρ1/π)·Φlaser
/// ```
///
/// and L_n,l for n > 3 the same with a path from y to s_l. N points y_k of density N·p(y_k), drawn by strata, give
/// Φ̂_n = Σ_k C[p,k]·L_n[k,l]: unbiased for each block, as C and L are evaluated at points of their own in footprint and beam, the same of
/// all pixels and of all spots. Visibility is part of C and L; it is asked only where something can stand between.
///
/// Points that serve all pixels cannot crowd where each of them sees another surface up close. Where the view reaches into the edge between
/// two surfaces, C grows like 1/d² towards it and the variance of those pixels' estimates has no bound: there `shared` is the estimator to
/// take.
pub(super) struct Factored<'a> {
    setting: &'a Setting<'a>,
    /// By pixel and shape: what may stand between.
    blockers: Vec<Vec<Blockers>>,
}

impl<'a> Factored<'a> {
    pub(super) fn new(setting: &'a Setting<'a>) -> Self {
        let blockers = setting
            .sightings
            .par_iter()
            .map(|s| s.blockers(setting.scene, &setting.between))
            .collect();
        Self { setting, blockers }
    }

    /// The blocks from where `tally` ends up to `end`; fewer if stopped.
    pub(super) fn trace(
        &self,
        mut tally: Tally,
        end: u32,
        control: Control<'_>,
        after: &mut dyn FnMut(&Tally) -> ControlFlow<(), u32>,
    ) -> Tally {
        let paths =
            self.setting.scene.camera.pixels() as u64 * u64::from(self.setting.plan.budget.size);
        let first = tally.range().end;
        let mut points = self.points(first);
        for block in first..end {
            // The next points are drawn, one after the other, while these are multiplied.
            let next = || (block + 1 < end).then(|| self.points(block + 1));
            let (sums, next) = rayon::join(|| self.block(&points, control), next);
            let Some(sums) = sums else { break };
            tally
                .add(block..block + 1, self.layout().moments(&sums))
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

    fn layout(&self) -> Layout {
        Layout {
            pixels: self.setting.scene.camera.pixels(),
            columns: self.setting.lamp.len(),
            orders: self.setting.scene.max_bounces as usize,
        }
    }

    /// The estimate of one block.
    fn block(&self, points: &Points, control: Control<'_>) -> Option<Vec<f64>> {
        let layout = self.layout();
        let mut sums = layout.zeros();
        let count = points.footprint.len();
        let row = layout.width() * layout.orders.saturating_sub(2).max(1);
        let together = (MOST_LIGHT / row / CHUNK).max(1) * CHUNK;
        for start in (0..count).step_by(together) {
            if control.stop.load(Ordering::Relaxed) {
                return None;
            }
            let end = (start + together).min(count);
            let chunks: Vec<Chunk<'_>> = (start..end)
                .into_par_iter()
                .step_by(CHUNK)
                .map(|first| self.chunk(points, first..(first + CHUNK).min(end)))
                .collect();
            sums.par_chunks_mut(layout.tile())
                .enumerate()
                .for_each(|(tile, sums)| {
                    let first = tile * TILE;
                    let pixels = first..(first + TILE).min(layout.pixels);
                    for chunk in &chunks {
                        self.tile(pixels.clone(), chunk, count, sums);
                    }
                });
        }
        Some(sums)
    }

    fn chunk<'p>(&'p self, points: &'p Points, range: Range<usize>) -> Chunk<'p> {
        let beams = points.beam.get(range.clone()).unwrap_or_default();
        let lit = self.setting.lamp.lit(beams, &(0..self.layout().columns));
        Chunk {
            at: points.at.part(range.clone()),
            places: &points.footprint[range.clone()],
            light: self.light(points, range, &lit),
            lit,
        }
    }

    /// Draws the points of a block and, where light may meet more than three surfaces, the paths that go on from them.
    fn points(&self, block: u32) -> Points {
        let count = self.setting.strata.block_size();
        let deeper = self.setting.scene.max_bounces.saturating_sub(2);
        let mut points = Points {
            at: Packet::dark(count),
            footprint: Vec::with_capacity(count),
            beam: Vec::new(),
            vertices: vec![None; count * deeper as usize],
        };
        let key = Key {
            seed: self.setting.plan.seed,
            spot: Key::ALL_SPOTS,
            pixel: Key::ALL_PIXELS,
            block,
        };
        self.setting.strata.visit(key, |drawn, place, stream| {
            let k = points.footprint.len();
            let Drawn {
                shape,
                point,
                density,
            } = drawn;
            points.footprint.push(place);
            points.at.set(k, (point.position, point.normal), 1.0, shape);
            if self.setting.beams.has_width() {
                let [s, t, ..] = stream.next_four();
                points.beam.push([s, t]);
            }
            let [u, v, choice, _] = match deeper > 1 {
                true => stream.next_four(),
                false => [0.0; 4],
            };
            let own = &mut points.vertices[k * deeper as usize..];
            // A point elsewhere sends no light to any pixel, and a glossy one would have to know which.
            let counts = self.setting.between.contains(&shape);
            let first = counts
                .then(|| Vertex::at(self.setting.scene, shape, &point, 1.0 / density))
                .flatten();
            self.setting
                .walk
                .run(first, deeper, [u, v], choice, stream, |n, vertex| {
                    own[n as usize - 1] = Some(*vertex);
                });
        });
        points
    }

    /// L for the points `range`, by order from three surfaces on: points × spots.
    fn light(&self, points: &Points, range: Range<usize>, lit: &Lit<'_>) -> Vec<Vec<f64>> {
        let width = self.layout().width();
        let deeper = self.setting.scene.max_bounces.saturating_sub(2) as usize;
        let power = self.setting.scene.laser.power;
        let places = if lit.is_fixed() { 1 } else { range.len() };
        let packets: Vec<Packet> = (0..places)
            .map(|k| self.setting.lamp.packet(lit.at(k), width))
            .collect();
        let order = |n: usize| {
            let mut light = vec![0.0; range.len() * width];
            light.chunks_mut(width).enumerate().for_each(|(i, row)| {
                let Some(vertex) = &points.vertices[(range.start + i) * deeper + n] else {
                    return;
                };
                let own = if lit.is_fixed() { 0 } else { i };
                let scene = self.setting.scene;
                let reflection = gloss::weight(scene, vertex.shape, vertex.albedo);
                let factor = power * vertex.throughput * reflection;
                packets[own].forms_from((vertex.position, vertex.normal), factor, row);
                let lamp = &self.setting.lamp;
                lamp.hide(lit.at(own), 0, (vertex.position, vertex.shape), row);
                lamp.shade(lit.at(own), vertex.position, row);
                gloss::of_vertex(scene, vertex, lit.at(own), row);
            });
            light
        };
        (0..deeper).map(order).collect()
    }

    /// Adds the points of a chunk to the sums of a tile of pixels.
    fn tile(&self, pixels: Range<usize>, chunk: &Chunk<'_>, count: usize, sums: &mut [f64]) {
        let Chunk {
            at,
            places,
            light,
            lit,
        } = chunk;
        let layout = self.layout();
        let (width, inner) = (layout.width(), places.len());
        let rows = sums.len() / layout.orders / width;
        let mut camera = vec![0.0; rows * inner];
        let mut x = Packet::dark(inner);
        let share = 1.0 / count as f64;
        for (i, pixel) in pixels.enumerate() {
            let sighting = &self.setting.sightings[pixel];
            sighting.vertices(self.setting.scene, places, &mut x);
            let row = &mut camera[i * inner..(i + 1) * inner];
            x.forms_to(at, row);
            if self.setting.glossy {
                gloss::of_views(self.setting.scene, &x, at, row);
            }
            hide(self.setting.scene, &self.blockers[pixel], (&x, at), row);
            if self.setting.two {
                let two = &mut sums[(rows + i) * width..(rows + i + 1) * width];
                self.setting.lamp.add_two_surfaces(&x, lit, share, two);
            }
            let one = &mut sums[i * width..(i + 1) * width];
            self.setting.direct.add(sighting, places, lit, share, one);
        }
        for (n, light) in light.iter().enumerate() {
            let order = &mut sums[(n + 2) * rows * width..(n + 3) * rows * width];
            add_product(order, &camera, light, inner, width);
        }
    }
}

/// Points that are multiplied together.
struct Chunk<'a> {
    at: Packet,
    places: &'a [[f64; 2]],
    /// L by order from three surfaces on: points × spots.
    light: Vec<Vec<f64>>,
    lit: Lit<'a>,
}

/// The points of one block.
struct Points {
    /// Position and normal of the points y.
    at: Packet,
    /// Place in the footprints of all pixels.
    footprint: Vec<[f64; 2]>,
    /// Place in the beams of all spots; empty if they have no width.
    beam: Vec<[f64; 2]>,
    /// By point and order: the end of the path that goes on from the point, itself first, with throughput 1/density.
    vertices: Vec<Option<Vertex>>,
}
