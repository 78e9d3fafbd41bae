//! The lit spots, seen from the surfaces that they light.

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use super::beam::{Beams, LitPoint, Reach};
use super::gloss;
use super::lit::Lit;
use super::packet::Packet;
use super::shadow::Shadows;
use super::sight::known_or_all;
use crate::geometry::{Blockers, DVec3, Parallelogram, Ray, Region, Shape, ShapeId};
use crate::scene::Scene;

/// A range of spots, with what may stand between each and the shapes around.
#[derive(Debug)]
pub(super) struct Lamp<'a> {
    scene: &'a Scene,
    beams: &'a Beams<'a>,
    spots: Range<usize>,
    /// By spot, if beams have no width: where its light lands.
    ideal: Vec<Option<LitPoint>>,
    /// By spot: where its light is expected to land.
    landings: Vec<Option<Landing>>,
    /// By spot and shape.
    blockers: Vec<Vec<Blockers>>,
    /// Whether nothing stands between any expected landing and the shape.
    clear: Vec<bool>,
    /// Whether any surface is not Lambertian.
    glossy: bool,
}

/// A part of a flat shape.
#[derive(Clone, Debug)]
struct Landing {
    shape: ShapeId,
    /// The square around a wide spot; a spot without width has none.
    square: Option<Parallelogram>,
}

impl Landing {
    fn holds(&self, lit: &LitPoint) -> bool {
        let inside = |s: &Parallelogram| {
            let place = s.coordinates(lit.position);
            place.iter().all(|c| (0.0..=1.0).contains(c))
        };
        lit.shape == self.shape && self.square.as_ref().is_none_or(inside)
    }
}

impl<'a> Lamp<'a> {
    pub(super) fn new(scene: &'a Scene, beams: &'a Beams<'a>, spots: Range<usize>) -> Self {
        let shapes = scene.surfaces.len();
        let landings: Vec<Option<Landing>> =
            spots.clone().map(|l| landing(scene, beams, l)).collect();
        let to: Vec<Region> = scene
            .surfaces
            .iter()
            .map(|s| Region::around(&s.shape))
            .collect();
        let blockers: Vec<Vec<Blockers>> = landings
            .iter()
            .zip(spots.clone())
            .map(|(landing, spot)| {
                let Some(landing) = landing else {
                    return vec![Blockers::Any; shapes];
                };
                let from = match &landing.square {
                    Some(square) => Region::patch(square),
                    None => Region::point(scene.laser.spots[spot].target.position),
                };
                let ends = |t: usize| [Some(landing.shape), Some(t as ShapeId)];
                (0..shapes)
                    .map(|t| scene.bvh().blockers(&from, &to[t], ends(t)))
                    .collect()
            })
            .collect();
        let clear = (0..shapes)
            .map(|t| {
                let free = blockers.iter().all(|b: &Vec<Blockers>| b[t].none());
                free && landings.iter().all(Option::is_some) && !beams.has_width()
            })
            .collect();
        let ideal = match beams.has_width() {
            true => Vec::new(),
            false => spots.clone().map(|l| beams.point(l, [0.0; 2])).collect(),
        };
        Self {
            scene,
            beams,
            spots,
            ideal,
            landings,
            blockers,
            clear,
            glossy: gloss::in_scene(scene),
        }
    }

    /// Multiplies a row over lit points by their f_r towards `to`, where that is not in their packet.
    pub(super) fn shade(&self, points: &[Option<LitPoint>], to: DVec3, row: &mut [f64]) {
        if self.glossy {
            gloss::of_lit(self.scene, points, to, row);
        }
    }

    /// The first spot.
    pub(super) fn first(&self) -> usize {
        self.spots.start
    }

    /// Number of spots.
    pub(super) fn len(&self) -> usize {
        self.spots.len()
    }

    /// Whether the beams have width.
    pub(super) fn has_width(&self) -> bool {
        self.beams.has_width()
    }

    /// The points lit by the beams of `columns` for many places in the beams.
    pub(super) fn lit(&self, places: &[[f64; 2]], columns: &Range<usize>) -> Lit<'_> {
        let points = match self.beams.has_width() {
            false => Cow::Borrowed(&self.ideal[columns.clone()]),
            true => {
                let spot = |column| self.spots.start + column;
                let at = |place| {
                    columns
                        .clone()
                        .map(move |c| self.beams.point(spot(c), place))
                };
                let all = places.par_iter().with_min_len(64);
                Cow::Owned(all.flat_map_iter(|place| at(*place)).collect())
            }
        };
        Lit::new(columns.clone(), points)
    }

    /// Lit points as a packet, weighted by the BRDF ρ/π where that is how they reflect.
    pub(super) fn packet(&self, points: &[Option<LitPoint>], width: usize) -> Packet {
        let mut packet = Packet::dark(width);
        for (i, point) in points.iter().enumerate() {
            if let Some(p) = point {
                let weight = gloss::weight(self.scene, p.shape, p.albedo);
                packet.set(i, (p.position, p.normal), weight, p.shape);
            }
        }
        packet
    }

    /// Sets to 0 the entries of `row`, the columns from `first` on, whose spot cannot be seen from point x of shape `from`.
    pub(super) fn hide(
        &self,
        points: &[Option<LitPoint>],
        first: usize,
        (x, from): (DVec3, ShapeId),
        row: &mut [f64],
    ) {
        if self.clear[from as usize] {
            return;
        }
        let mut asked = Shadows::default();
        for (i, point) in points.iter().enumerate() {
            let Some(lit) = point.as_ref().filter(|_| row[i] != 0.0) else {
                continue;
            };
            let between = self.between(first + i, lit, from);
            if between.none() {
                continue;
            }
            let ends = [Some(from), Some(lit.shape)];
            match Ray::between(x, lit.position) {
                Some(ray) => asked.ask(self.scene.bvh(), between, (i, ray, ends), row),
                None => row[i] = 0.0,
            }
        }
        asked.answer(self.scene.bvh(), row);
    }

    /// What may stand between shape `from` and the point that `column`'s beam lights.
    fn between(&self, column: usize, lit: &LitPoint, from: ShapeId) -> &Blockers {
        match &self.landings[column] {
            Some(landing) if landing.holds(lit) => &self.blockers[column][from as usize],
            _ => &Blockers::Any,
        }
    }

    /// Whether the point that `column`'s beam lights cannot be seen from point x of shape `from`.
    pub(super) fn hidden(
        &self,
        column: usize,
        lit: &LitPoint,
        (x, from): (DVec3, ShapeId),
    ) -> bool {
        if self.clear[from as usize] {
            return false;
        }
        let blockers = self.between(column, lit, from);
        let ends = [Some(from), Some(lit.shape)];
        !blockers.none()
            && Ray::between(x, lit.position)
                .is_none_or(|ray| self.scene.bvh().blocked_by(blockers, &ray, ends))
    }

    /// Adds to `sums` the light that goes from the lit spots to each of `points`, all spots of a point at once; point k counts `factor`(k),
    /// and nothing if that is 0; and `reflection`(k, position of the lit point), if there is such a thing.
    pub(super) fn add_light(
        &self,
        points: &Packet,
        factor: impl Fn(usize) -> f64,
        reflection: Option<&dyn Fn(usize, DVec3) -> f64>,
        lit: &Lit<'_>,
        sums: &mut [f64],
    ) {
        let mut row = vec![0.0; sums.len()];
        let mut packet = self.packet(lit.at(0), sums.len());
        for (k, factor) in (0..points.len()).map(|k| (k, factor(k))) {
            if factor == 0.0 {
                continue;
            }
            let own = lit.at(k);
            if !lit.is_fixed() {
                packet = self.packet(own, sums.len());
            }
            let (position, normal) = points.point(k);
            packet.forms_from((position, normal), factor, &mut row);
            let from = (position, points.shape[k]);
            self.hide(own, lit.columns.start, from, &mut row);
            self.shade(own, position, &mut row);
            if let Some(reflection) = reflection {
                let lit = row.iter_mut().zip(own);
                lit.filter_map(|(r, lit)| Some((r, lit.as_ref()?.position)))
                    .filter(|(r, _)| **r != 0.0)
                    .for_each(|(r, lit)| *r *= reflection(k, lit));
            }
            sums.iter_mut().zip(&row).for_each(|(s, r)| *s += r);
        }
    }

    /// Adds to `sums` the light that goes from the lit spots straight to the vertices x; each vertex counts `share`.
    pub(super) fn add_two_surfaces(&self, x: &Packet, lit: &Lit<'_>, share: f64, sums: &mut [f64]) {
        let factor = |k: usize| self.scene.laser.power * share * x.weight[k];
        let reflection =
            |k: usize, lit: DVec3| gloss::of_view(self.scene, x, k, lit).unwrap_or(1.0);
        let reflection: Option<&dyn Fn(usize, DVec3) -> f64> = match self.glossy {
            true => Some(&reflection),
            false => None,
        };
        self.add_light(x, factor, reflection, lit, sums);
    }
}

/// Shapes on which the light of any spot of the scene may land.
pub(super) fn lit(scene: &Scene, beams: &Beams<'_>) -> Vec<ShapeId> {
    let lands = |l: usize| match beams.has_width() {
        true => beams.surely_lands_on(l, Reach::Samples).map(Some),
        false => Some(beams.point(l, [0.0; 2]).map(|p| p.shape)),
    };
    let known: Option<Vec<Option<ShapeId>>> = (0..scene.laser.spots.len()).map(lands).collect();
    known_or_all(scene, known.map(|k| k.into_iter().flatten().collect()))
}

/// Where the light of a spot is expected: its target where that is a flat shape on which the beam lands unhindered.
fn landing(scene: &Scene, beams: &Beams<'_>, spot: usize) -> Option<Landing> {
    let spot_there = &scene.laser.spots[spot];
    let (target, shape) = (&spot_there.target, spot_there.surface);
    if !matches!(
        scene.surfaces[shape as usize].shape,
        Shape::Parallelogram(_)
    ) {
        return None;
    }
    if !beams.has_width() {
        let lit = beams.point(spot, [0.0; 2])?;
        let there = lit.shape == shape && lit.position == target.position;
        return there.then_some(Landing {
            shape,
            square: None,
        });
    }
    Some(Landing {
        shape,
        square: Some(beams.square(spot, Reach::Expected)?),
    })
}
