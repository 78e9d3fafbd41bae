//! All paths of one pixel.

use std::ops::Range;

use super::beam::LitPoint;
use super::direct::direct;
use super::form::form;
use super::gloss;
use super::own::OwnPoints;
use super::pinhole;
use super::setting::Setting;
use super::tally::Moments;
use super::walk::Vertex;
use crate::num::stream::{Key, Stream};
use crate::num::tree::Tree;
use crate::scene::Scene;

/// Traces pixels of one scene by one plan.
#[derive(Debug)]
pub(super) struct PixelTracer<'a> {
    setting: &'a Setting<'a>,
}

impl<'a> PixelTracer<'a> {
    pub(super) fn new(setting: &'a Setting<'a>) -> Self {
        Self { setting }
    }

    /// Sums and scatter of the estimates \[order · columns + column\] of a pixel for the given spots and blocks, W; order n − 1 holds the light
    /// that met n surfaces.
    pub(super) fn trace(
        &self,
        pixel: usize,
        spots: &Range<usize>,
        blocks: Range<u32>,
    ) -> Tree<Moments> {
        let Setting { scene, plan, .. } = self.setting;
        let columns = spots.len();
        let orders = scene.max_bounces as usize;
        let mut own = OwnPoints::new(self.setting, pixel);
        let mut estimate = |block: u32, range: Range<usize>, spot: u32, sums: &mut [f64]| {
            let key = Key {
                seed: plan.seed,
                spot,
                pixel: pixel as u32,
                block,
            };
            match &mut own {
                Some(own) => own.block(key, &range, columns, sums),
                None => {
                    let spots = spots.start + range.start..spots.start + range.end;
                    self.block(key, &spots, columns, sums);
                    let size = f64::from(plan.budget.size);
                    let entries =
                        (0..orders).flat_map(|n| (0..range.len()).map(move |i| n * columns + i));
                    entries.for_each(|i| sums[i] /= size);
                }
            }
        };
        let mut tree = Tree::new(plan.budget.blocks, blocks.start);
        for block in blocks {
            let mut sums = vec![0.0; orders * columns];
            if plan.estimator.serves_all_spots() {
                estimate(block, 0..columns, Key::ALL_SPOTS, &mut sums);
            } else {
                for (l, spot) in spots.clone().enumerate() {
                    estimate(block, l..l + 1, spot as u32, &mut sums[l..]);
                }
            }
            let moments = Moments::of_block(sums, orders);
            tree.push(block..block + 1, moments, Moments::join)
                .expect("blocks follow one another");
        }
        tree
    }

    /// One block of paths that serve `spots`; entry (order, l) of the sums stands at order·columns + l.
    fn block(&self, key: Key, spots: &Range<usize>, columns: usize, sums: &mut [f64]) {
        let pixel = key.pixel as usize;
        let mut stream = Stream::new(self.setting.plan.sampling, key);
        let power = self.setting.scene.laser.power;
        let vertices = self.setting.scene.max_bounces - 1;
        let second = self.setting.beams.has_width() || self.setting.walk.chooses();
        let Setting { scene, lamp, .. } = self.setting;
        let first_column = spots.start - lamp.first();
        let mut lit: Vec<Option<LitPoint>> = Vec::with_capacity(spots.len());
        let mut row = vec![0.0; spots.len()];
        for index in 0..self.setting.plan.budget.size {
            stream.start(index);
            let [a, b, u, v] = stream.next_four();
            let [choice, _, s, t] = if second { stream.next_four() } else { [0.0; 4] };
            if lit.is_empty() || self.setting.beams.has_width() {
                lit.clear();
                lit.extend(
                    spots
                        .clone()
                        .map(|spot| self.setting.beams.point(spot, [s, t])),
                );
            }
            let first = pinhole::first_vertex(self.setting.scene, pixel, [a, b]);
            for (l, spot) in spots.clone().enumerate() {
                sums[l] += power
                    * direct(
                        self.setting.scene,
                        self.setting.beams,
                        (spot, pixel),
                        first.as_ref(),
                        lit[l].as_ref(),
                    );
            }
            self.setting
                .walk
                .run(first, vertices, [u, v], choice, &mut stream, |n, vertex| {
                    let reflection = gloss::weight(scene, vertex.shape, vertex.albedo);
                    let radiance = vertex.throughput * reflection * power;
                    for (entry, point) in row.iter_mut().zip(&lit) {
                        *entry = point
                            .as_ref()
                            .map_or(0.0, |lit| radiance * connection(scene, vertex, lit));
                    }
                    let from = (vertex.position, vertex.shape);
                    lamp.hide(&lit, first_column, from, &mut row);
                    lamp.shade(&lit, vertex.position, &mut row);
                    gloss::of_vertex(scene, vertex, &lit, &mut row);
                    let sums = &mut sums[n as usize * columns..];
                    sums.iter_mut().zip(&row).for_each(|(s, r)| *s += r);
                });
        }
    }
}

/// cosθ·cosθ′/d² between a vertex and the lit point, times ρ/π of the latter where that is how it reflects; visibility is no part of it.
fn connection(scene: &Scene, vertex: &Vertex, lit: &LitPoint) -> f64 {
    let ends = ((vertex.position, vertex.normal), (lit.position, lit.normal));
    form(ends.0, ends.1).map_or(0.0, |(form, _)| {
        form * gloss::weight(scene, lit.shape, lit.albedo)
    })
}
