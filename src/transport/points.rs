//! A pixel's row of Φcam from points of its own, where light meets at most three surfaces and a
//! single flat shape fills the pixel.
//!
//! ```text
//! Φ̂₃[p, l] = Σ_k C(x_k, y_k) · (ρ/π)(y_k)/density_k · G(y_k, s_l) · V · f_r(s_l) · Φlaser
//! ```
//!
//! x_k is what the camera sees, y_k a point of [`Strata`](super::strata::Strata), or of a light
//! path where surfaces come close to a spot ([`light_path`](super::light_path)). The points of a
//! block are evaluated together, and no ray is cast where nothing can stand in the way.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use super::camera::{PixelView, camera_terms};
use super::context::Context;
use super::light_path::weight;
use super::light_points::LightPoint;
use super::spots::LitPoints;
use super::vertex::Batch;
use crate::geometry::Blockers;
use crate::num::stream::Key;

/// The points of one pixel.
#[derive(Debug)]
pub(super) struct PixelPoints<'a> {
    context: &'a Context<'a>,
    view: &'a PixelView,
    /// By shape: what may stand between the pixel and it.
    blockers: Vec<Blockers>,
}

/// Points that are evaluated together.
const CHUNK: usize = 1024;

/// Numbers of one chunk, kept from chunk to chunk.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    /// What the pixel sees, weighted.
    x: Batch,
    /// The points between, weighted by (ρ/π)/density.
    y: Batch,
    /// Points per area at y beside the light paths.
    density: Vec<f64>,
    /// Places in the footprint and, where they have width, in the beams.
    places: Vec<[f64; 2]>,
    beams: Vec<[f64; 2]>,
    /// Φlaser·C·w by point, then the light at each point from one spot.
    camera: Vec<f64>,
    light: Vec<f64>,
}

impl Buffers {
    /// For blocks of `size` points.
    pub(super) fn new(size: usize) -> Self {
        let n = size.min(CHUNK);
        Self {
            x: Batch::zeros(n),
            y: Batch::zeros(n),
            camera: vec![0.0; n],
            light: vec![0.0; n],
            ..Self::default()
        }
    }

    fn clear(&mut self) {
        self.places.clear();
        self.beams.clear();
        self.density.clear();
    }
}

impl<'a> PixelPoints<'a> {
    /// Whether the pixel's paths are simple enough.
    pub(super) fn fits(context: &Context<'_>, pixel: usize) -> bool {
        let filled_by = context.views[pixel].shape();
        context.scene.max_bounces <= 3
            && filled_by.is_some_and(|s| context.path.far_from_hidden(s))
            && context.glossy_between().is_none()
    }

    /// `None` if the pixel's paths are not simple enough.
    pub(super) fn new(context: &'a Context<'a>, pixel: usize) -> Option<Self> {
        let view = &context.views[pixel];
        Self::fits(context, pixel).then(|| Self {
            context,
            view,
            blockers: view.blockers(context.scene, &context.between),
        })
    }

    /// The estimate of one block for `columns`, added to `sums`: \[order\]\[column\].
    pub(super) fn estimate(
        &self,
        b: &mut Buffers,
        key: Key,
        columns: &Range<usize>,
        sums: &mut [f64],
    ) {
        let Context { scene, spots, .. } = self.context;
        let wide = spots.beams.has_width();
        self.context.strata.visit(key, |drawn, place, stream| {
            let k = b.places.len();
            let albedo = &scene.surfaces[drawn.shape as usize].albedo;
            let weight = albedo.albedo(drawn.point.uv) * FRAC_1_PI / drawn.density;
            b.y.set(k, drawn.oriented(), weight, drawn.shape);
            b.density.push(drawn.density);
            b.places.push(place);
            if wide {
                let [_, _, s, t] = stream.next_four();
                b.beams.push([s, t]);
            }
            if b.places.len() == b.y.len() {
                self.add_chunk(b, columns, sums);
            }
        });
        if !b.places.is_empty() {
            self.add_chunk(b, columns, sums);
        }
        if let Some(three) = sums.get_mut(2 * columns.len()..) {
            for &column in spots.light_paths.columns(columns) {
                let sum = &mut three[column - columns.start];
                self.add_light_paths(b, key, column, sum);
            }
        }
    }

    /// Adds the light from one spot that its light paths find.
    fn add_light_paths(&self, b: &mut Buffers, key: Key, column: usize, sum: &mut f64) {
        let Context {
            scene,
            spots,
            strata,
            between,
            ..
        } = self.context;
        let (paths, own) = (&spots.light_paths, column..column + 1);
        let mut stream = paths.stream(key, column);
        for index in 0..paths.count {
            stream.start(index);
            let point = LightPoint::draw(spots, column, &mut stream);
            let Some((_, end)) = point
                .ends
                .filter(|(_, end)| between.contains(&end.at.shape))
            else {
                continue;
            };
            let all = strata.density(&end.at) + f64::from(paths.count) * end.density;
            let albedo = &scene.surfaces[end.at.shape as usize].albedo;
            let weight = albedo.albedo(end.at.point.uv) * FRAC_1_PI / all;
            b.y.set(b.places.len(), end.at.oriented(), weight, end.at.shape);
            b.density.push(f64::INFINITY);
            b.places.push(point.footprint);
            if spots.beams.has_width() {
                b.beams.push(point.beam);
            }
            if b.places.len() == b.y.len() {
                self.add_ends(b, &own, sum);
            }
        }
        if !b.places.is_empty() {
            self.add_ends(b, &own, sum);
        }
    }

    /// Adds the ends of light paths that are in the buffers, and empties them.
    fn add_ends(&self, b: &mut Buffers, own: &Range<usize>, sum: &mut f64) {
        self.see(b);
        self.add_camera_terms(b);
        let lit = self.context.spots.points(&b.beams, own);
        self.add_one_spot(b, &lit, sum);
        b.clear();
    }

    /// What the pixel sees at the places in the buffers.
    fn see(&self, b: &mut Buffers) {
        let count = b.places.len();
        b.x.weight[count..].fill(0.0);
        b.y.weight[count..].fill(0.0);
        self.view.vertices(self.context.scene, &b.places, &mut b.x);
    }

    /// Sets `camera` to Φlaser·C·w.
    fn add_camera_terms(&self, b: &mut Buffers) {
        let Context {
            scene, is_glossy, ..
        } = self.context;
        let ends = (&b.x, &b.y);
        camera_terms((scene, *is_glossy), &self.blockers, ends, &mut b.camera);
        for (c, w) in b.camera.iter_mut().zip(&b.y.weight) {
            *c *= w * scene.laser.power;
        }
    }

    /// Adds the points that are in the buffers, and empties them.
    fn add_chunk(&self, b: &mut Buffers, columns: &Range<usize>, sums: &mut [f64]) {
        let Context { scene, spots, .. } = self.context;
        let (count, n) = (b.places.len(), columns.len());
        self.see(b);
        let lit = spots.points(&b.beams, columns);
        let power = scene.laser.power * (1.0 / self.context.strata.block_size() as f64);
        let (one, rest) = sums.split_at_mut(n);
        let first = |k: usize| self.view.vertex(scene, b.places[k]);
        self.context
            .direct
            .add(spots, self.view.pixel, (count, power), first, &lit, one);
        if self.context.has_two_bounce_light {
            let factor = |k, light| b.x.factor_from(scene, k, light);
            spots.add_light(
                &b.x,
                |k| power * b.x.weight[k],
                factor,
                |_| f64::INFINITY,
                &lit,
                &mut rest[..n],
            );
        }
        if let Some(three) = rest.get_mut(n..2 * n) {
            self.add_camera_terms(b);
            match three {
                [sum] => self.add_one_spot(b, &lit, sum),
                _ => {
                    let density = |k: usize| b.density[k];
                    spots.add_light(&b.y, |k| b.camera[k], |_, _| 1.0, density, &lit, three);
                }
            }
        }
        b.clear();
    }

    /// Adds the light from one spot, all points at once: the bits of
    /// [`LitSpots::add_light`](super::spots::LitSpots::add_light).
    fn add_one_spot(&self, b: &mut Buffers, lit: &LitPoints<'_>, sum: &mut f64) {
        let Context { scene, spots, .. } = self.context;
        let count = b.places.len();
        if !lit.is_fixed() {
            for k in 0..count {
                b.light[k] = lit.at(k)[0].as_ref().map_or(0.0, |p| {
                    let weight = b.camera[k] * p.constant_factor(scene);
                    weight * b.y.geometry_term(k, p.oriented())
                });
            }
        } else if let Some(point) = &lit.at(0)[0] {
            let factor = point.constant_factor(scene);
            b.y.geometry_terms_from(point.oriented(), factor, &b.camera, &mut b.light);
        } else {
            return;
        }
        let light = &mut b.light[..count];
        let column = lit.columns.start;
        let paths = &spots.light_paths;
        if !paths.columns(&lit.columns).is_empty() {
            for (k, light) in light.iter_mut().enumerate() {
                if let Some(point) = &lit.at(k)[0] {
                    let m = f64::from(paths.count);
                    *light *= weight(b.y.oriented(k), b.density[k], m, point);
                }
            }
        }
        let connection = |k: usize| Some((column, lit.at(k)[0].as_ref()?, b.y.shape[k]));
        spots.connect(light, connection, |k| b.y.place(k).0, |_, _| 1.0);
        light.iter().for_each(|part| *sum += part);
    }
}
