//! A pixel's row of Φcam from points of its own.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use super::eye::{Sighting, hide};
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

/// Numbers of one block, kept from block to block.
#[derive(Debug)]
struct Buffers {
    /// What the pixel sees, weighted.
    x: Packet,
    /// The points between, weighted by (ρ/π)/density.
    y: Packet,
    places: Vec<[f64; 2]>,
    beams: Vec<[f64; 2]>,
    /// C·w by point, then the light at each point from one spot.
    camera: Vec<f64>,
    light: Vec<f64>,
}

impl<'a> OwnPoints<'a> {
    /// `None` if the pixel's paths do not fit in.
    pub(super) fn new(setting: &'a Setting<'a>, pixel: usize) -> Option<Self> {
        let sighting = &setting.sightings[pixel];
        let fits = setting.scene.max_bounces <= 3
            && sighting
                .shape()
                .is_some_and(|shape| setting.walk.by_area_alone(shape));
        let n = setting.strata.block_size();
        fits.then(|| Self {
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
        self.draw(key);
        let b = &mut self.buffers;
        self.sighting
            .vertices(self.setting.scene, &b.places, &mut b.x);
        let lit = self.setting.lamp.lit(&b.beams, columns);
        let share = 1.0 / b.places.len() as f64;
        let n = columns.len();
        self.setting
            .direct
            .add(self.sighting, &b.places, &lit, share, &mut sums[..n]);
        if self.setting.two {
            let two = &mut sums[stride..stride + n];
            self.setting.lamp.add_two_surfaces(&b.x, &lit, share, two);
        }
        if sums.len() <= 2 * stride {
            return;
        }
        b.x.forms_to(&b.y, &mut b.camera);
        for (c, w) in b.camera.iter_mut().zip(&b.y.weight) {
            *c *= w * self.setting.scene.laser.power;
        }
        hide(
            self.setting.scene,
            &self.blockers,
            (&b.x, &b.y),
            &mut b.camera,
        );
        let three = &mut sums[2 * stride..2 * stride + n];
        if n == 1 {
            self.one_spot(&lit, &mut three[0]);
        } else {
            self.all_spots(&lit, three);
        }
    }

    fn draw(&mut self, key: Key) {
        let b = &mut self.buffers;
        b.places.clear();
        b.beams.clear();
        let wide = self.setting.lamp.has_width();
        self.setting.strata.visit(key, |drawn, place, stream| {
            let k = b.places.len();
            let Drawn {
                shape,
                point,
                density,
            } = drawn;
            let albedo = self.setting.scene.surfaces[shape as usize]
                .albedo
                .albedo(point.uv);
            let weight = albedo * FRAC_1_PI / density;
            b.y.set(k, (point.position, point.normal), weight, shape);
            b.places.push(place);
            if wide {
                let [_, _, s, t] = stream.next_four();
                b.beams.push([s, t]);
            }
        });
    }

    /// Adds the light from one spot, all points at once.
    fn one_spot(&mut self, lit: &Lit<'_>, sum: &mut f64) {
        let column = lit.columns.start;
        let b = &mut self.buffers;
        if lit.is_fixed() {
            let Some(lit) = &lit.at(0)[0] else { return };
            let factor = lit.albedo * FRAC_1_PI;
            b.y.unit_forms_from((lit.position, lit.normal), factor, &mut b.light);
            for (k, light) in b.light.iter().enumerate() {
                let part = b.camera[k] * light;
                if part != 0.0
                    && !self
                        .setting
                        .lamp
                        .hidden(column, lit, (b.y.position(k), b.y.shape[k]))
                {
                    *sum += part;
                }
            }
            return;
        }
        for k in 0..b.camera.len() {
            let Some(lit) = &lit.at(k)[0] else { continue };
            let part =
                b.camera[k] * lit.albedo * FRAC_1_PI * b.y.form(k, (lit.position, lit.normal));
            if part != 0.0
                && !self
                    .setting
                    .lamp
                    .hidden(column, lit, (b.y.position(k), b.y.shape[k]))
            {
                *sum += part;
            }
        }
    }

    /// Adds the light from many spots, all spots of a point at once.
    fn all_spots(&mut self, lit: &Lit<'_>, sums: &mut [f64]) {
        let b = &mut self.buffers;
        let mut row = vec![0.0; sums.len()];
        let mut packet = self.setting.lamp.packet(lit.at(0), sums.len());
        for (k, camera) in b.camera.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let own = lit.at(k);
            if !lit.is_fixed() {
                packet = self.setting.lamp.packet(own, sums.len());
            }
            let (position, normal) = b.y.point(k);
            packet.forms_from((position, normal), *camera, &mut row);
            self.setting
                .lamp
                .hide(own, lit.columns.start, (position, b.y.shape[k]), &mut row);
            sums.iter_mut().zip(&row).for_each(|(s, r)| *s += r);
        }
    }
}
