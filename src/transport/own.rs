//! A pixel's row of Φcam from points of its own.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use super::eye::{Sighting, hide};
use super::gloss;
use super::lit::Lit;
use super::packet::Packet;
use super::setting::Setting;
use super::strata::Drawn;
use crate::geometry::Blockers;
use crate::num::stream::Key;

/// Paths of at most three surfaces for one pixel that a single flat shape fills: all points of a block are evaluated at once, and no ray
/// is cast where nothing can stand in the way.
#[derive(Debug)]
pub(super) struct OwnPoints<'a> {
    setting: &'a Setting<'a>,
    sighting: &'a Sighting,
    /// By shape: what may stand between the pixel and it.
    blockers: Vec<Blockers>,
    buffers: Buffers,
}

/// Points that are evaluated together.
const CHUNK: usize = 1024;

/// Numbers of one chunk, kept from chunk to chunk.
#[derive(Debug, Default)]
struct Buffers {
    /// What the pixel sees, weighted.
    x: Packet,
    /// The points between, weighted by (ρ/π)/density.
    y: Packet,
    places: Vec<[f64; 2]>,
    beams: Vec<[f64; 2]>,
    /// Φlaser·C·w by point, then the light at each point from one spot.
    camera: Vec<f64>,
    light: Vec<f64>,
}

impl<'a> OwnPoints<'a> {
    /// Whether the pixel's paths fit in.
    pub(super) fn fits(setting: &Setting<'_>, pixel: usize) -> bool {
        let filled = setting.sightings[pixel].shape();
        setting.scene.max_bounces <= 3
            && setting.plain
            && filled.is_some_and(|s| setting.walk.far_from_hidden(s))
    }

    /// `None` if the pixel's paths do not fit in.
    pub(super) fn new(setting: &'a Setting<'a>, pixel: usize) -> Option<Self> {
        let sighting = &setting.sightings[pixel];
        let n = setting.strata.block_size().min(CHUNK);
        Self::fits(setting, pixel).then(|| Self {
            setting,
            sighting,
            blockers: sighting.blockers(setting.scene, &setting.between),
            buffers: Buffers {
                x: Packet::dark(n),
                y: Packet::dark(n),
                places: Vec::with_capacity(n),
                beams: Vec::with_capacity(n),
                camera: vec![0.0; n],
                light: vec![0.0; n],
            },
        })
    }

    /// The estimate of one block for `columns`; entry (order, i) of `sums` stands at order·`stride` + i.
    pub(super) fn block(
        &mut self,
        key: Key,
        columns: &Range<usize>,
        stride: usize,
        sums: &mut [f64],
    ) {
        let setting = self.setting;
        let surfaces = &setting.scene.surfaces;
        let wide = setting.lamp.has_width();
        let mut b = std::mem::take(&mut self.buffers);
        let mut evaluate = |b: &mut Buffers| self.chunk(b, columns, stride, sums);
        setting.strata.visit(key, |drawn, place, stream| {
            let k = b.places.len();
            let Drawn {
                shape,
                point,
                density,
            } = drawn;
            let albedo = surfaces[shape as usize].albedo.albedo(point.uv);
            let weight = albedo * FRAC_1_PI / density;
            b.y.set(k, (point.position, point.normal), weight, shape);
            b.places.push(place);
            if wide {
                let [_, _, s, t] = stream.next_four();
                b.beams.push([s, t]);
            }
            if b.places.len() == b.y.len() {
                evaluate(&mut b);
            }
        });
        if !b.places.is_empty() {
            evaluate(&mut b);
        }
        self.buffers = b;
    }

    /// Adds the points that are in the buffers, and empties them.
    fn chunk(&self, b: &mut Buffers, columns: &Range<usize>, stride: usize, sums: &mut [f64]) {
        let setting = self.setting;
        let Setting {
            scene,
            lamp,
            direct,
            ..
        } = setting;
        let count = b.places.len();
        b.x.darken_from(count);
        b.y.darken_from(count);
        self.sighting.vertices(scene, &b.places, &mut b.x);
        let lit = lamp.lit(&b.beams, columns);
        let share = 1.0 / self.setting.strata.block_size() as f64;
        let n = columns.len();
        direct.add(self.sighting, &b.places, &lit, share, &mut sums[..n]);
        if self.setting.two {
            lamp.add_two_surfaces(&b.x, &lit, share, &mut sums[stride..stride + n]);
        }
        if sums.len() > 2 * stride {
            b.x.forms_to(&b.y, &mut b.camera);
            if setting.glossy {
                gloss::of_views(scene, &b.x, &b.y, &mut b.camera);
            }
            for (c, w) in b.camera.iter_mut().zip(&b.y.weight) {
                *c *= w * scene.laser.power;
            }
            hide(scene, &self.blockers, (&b.x, &b.y), &mut b.camera);
            let three = &mut sums[2 * stride..2 * stride + n];
            match three {
                [sum] => self.one_spot(b, &lit, sum),
                _ => lamp.add_light(&b.y, |k| b.camera[k], None, &lit, three),
            }
        }
        b.places.clear();
        b.beams.clear();
    }

    /// Adds the light from one spot, all points at once, with the roundings of [`Lamp::add_light`](super::lamp::Lamp::add_light).
    fn one_spot(&self, b: &mut Buffers, lit: &Lit<'_>, sum: &mut f64) {
        let lamp = &self.setting.lamp;
        let column = lit.columns.start;
        if lit.is_fixed()
            && let Some(lit) = &lit.at(0)[0]
        {
            b.y.unit_forms_from((lit.position, lit.normal), &mut b.light);
        }
        for k in 0..b.places.len() {
            let Some(point) = &lit.at(k)[0] else { continue };
            let form = match lit.is_fixed() {
                true => b.light[k],
                false => b.y.form(k, (point.position, point.normal)),
            };
            let scene = self.setting.scene;
            let mut part = b.camera[k] * gloss::weight(scene, point.shape, point.albedo) * form;
            if self.setting.glossy {
                let own = std::slice::from_mut(&mut part);
                lamp.shade(lit.at(k), b.y.position(k), own);
            }
            if part != 0.0 && !lamp.hidden(column, point, (b.y.position(k), b.y.shape[k])) {
                *sum += part;
            }
        }
    }
}
