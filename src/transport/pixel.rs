//! All paths of one pixel.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use super::beam::{Beams, LitPoint};
use super::form::form;
use super::pinhole;
use super::render::{Estimator, Plan};
use super::walk::{Vertex, Walk};
use crate::num::stream::{Key, Stream};
use crate::scene::Scene;

/// Traces pixels of one scene by one plan.
#[derive(Debug)]
pub(super) struct PixelTracer<'a> {
    scene: &'a Scene,
    plan: &'a Plan,
    beams: Beams<'a>,
    walk: Walk<'a>,
}

impl<'a> PixelTracer<'a> {
    pub(super) fn new(scene: &'a Scene, plan: &'a Plan) -> Self {
        Self {
            scene,
            plan,
            beams: Beams::new(scene),
            walk: Walk::new(scene),
        }
    }

    /// Block sums \[block\]\[order · columns + column\] of a pixel for the given spots, W; order n − 1 holds the light that
    /// met n surfaces.
    pub(super) fn trace(&self, pixel: usize, spots: &Range<usize>) -> Vec<Vec<f64>> {
        let columns = spots.len();
        let orders = self.scene.max_bounces as usize;
        (0..self.plan.budget.blocks)
            .map(|block| {
                let mut sums = vec![0.0; orders * columns];
                match self.plan.estimator {
                    Estimator::Shared => {
                        self.block(pixel, block, Key::ALL_SPOTS, spots, columns, &mut sums);
                    }
                    Estimator::Independent => {
                        for (l, spot) in spots.clone().enumerate() {
                            let own = spot..spot + 1;
                            self.block(pixel, block, spot as u32, &own, columns, &mut sums[l..]);
                        }
                    }
                }
                sums
            })
            .collect()
    }

    /// One block of paths that serve `spots`; entry (order, l) of the sums stands at order·columns + l.
    fn block(
        &self,
        pixel: usize,
        block: u32,
        key_spot: u32,
        spots: &Range<usize>,
        columns: usize,
        sums: &mut [f64],
    ) {
        let key = Key {
            seed: self.plan.seed,
            spot: key_spot,
            pixel: pixel as u32,
            block,
        };
        let mut stream = Stream::new(self.plan.sampling, key);
        let power = self.scene.laser.power;
        let vertices = self.scene.max_bounces - 1;
        let second = self.beams.has_width() || self.walk.chooses();
        let mut lit: Vec<Option<LitPoint>> = Vec::with_capacity(spots.len());
        for index in 0..self.plan.budget.size {
            stream.start(index);
            let [a, b, u, v] = stream.next_four();
            let [choice, _, s, t] = if second { stream.next_four() } else { [0.0; 4] };
            if lit.is_empty() || self.beams.has_width() {
                lit.clear();
                lit.extend(spots.clone().map(|spot| self.beams.point(spot, [s, t])));
            }
            let first = pinhole::first_vertex(self.scene, pixel, [a, b]);
            for (l, spot) in spots.clone().enumerate() {
                sums[l] += power * self.direct(spot, pixel, first.as_ref(), lit[l].as_ref());
            }
            self.walk
                .run(first, vertices, [u, v], choice, &mut stream, |n, vertex| {
                    let radiance = vertex.throughput * vertex.albedo * FRAC_1_PI * power;
                    let row = &mut sums[n as usize * columns..];
                    for (sum, point) in row.iter_mut().zip(&lit) {
                        if let Some(point) = point {
                            *sum += radiance * self.connect(vertex, point);
                        }
                    }
                });
        }
    }

    /// Light of the spot itself, one surface met, per watt of power. A spot without width is a point. A wide one is found in two
    /// ways, weighted against each other by their densities at the point found (the balance heuristic): where the line of
    /// sight meets it, which finds the faintest tail, and from the beam, which finds a spot however small.
    fn direct(
        &self,
        spot: usize,
        pixel: usize,
        first: Option<&Vertex>,
        lit: Option<&LitPoint>,
    ) -> f64 {
        if !self.beams.has_width() {
            let point = self.beams.point_in_view(spot);
            let seen = point.and_then(|point| pinhole::direct(self.scene, &point));
            return seen
                .filter(|(by, _)| *by == pixel)
                .map_or(0.0, |(_, flux)| flux);
        }
        let by_sight = first.map_or(0.0, |x| {
            let at = (x.position, x.normal);
            let irradiance = self.beams.irradiance(spot, at, x.shape);
            if irradiance <= 0.0 {
                return 0.0;
            }
            let seen = pinhole::density(self.scene, at);
            x.throughput * x.albedo * FRAC_1_PI * irradiance * seen / (seen + irradiance)
        });
        let by_beam = lit.and_then(|point| {
            let (by, flux) = pinhole::direct(self.scene, point)?;
            let at = (point.position, point.normal);
            let irradiance = self.beams.irradiance(spot, at, point.shape);
            let seen = pinhole::density(self.scene, at);
            (by == pixel && irradiance > 0.0).then(|| flux * irradiance / (seen + irradiance))
        });
        by_sight + by_beam.unwrap_or(0.0)
    }

    /// V·cosθ·cosθ′/d² · ρ/π between a vertex and the lit point.
    fn connect(&self, vertex: &Vertex, lit: &LitPoint) -> f64 {
        let ends = ((vertex.position, vertex.normal), (lit.position, lit.normal));
        match form(ends.0, ends.1) {
            Some((form, ray))
                if !self
                    .scene
                    .bvh()
                    .blocked(&ray, [Some(vertex.shape), Some(lit.shape)]) =>
            {
                form * lit.albedo * FRAC_1_PI
            }
            _ => 0.0,
        }
    }
}
