//! Which entries of Φcam light may reach at all.

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use super::beam::Beams;
use super::camera::{PixelView, sees_nothing};
use super::direct_light::DirectLight;
use super::visibility::{between, known_or_all, may_light_any};
use crate::geometry::ShapeId;
use crate::scene::Scene;

/// What pixels may see and what beams may light, judged conservatively.
#[derive(Debug)]
pub(super) struct MayBeLit<'a> {
    scene: &'a Scene,
    direct: DirectLight,
    /// By pixel: the shapes that it may see and that reflect.
    seen: Vec<Vec<ShapeId>>,
    /// By column: the shapes on which the beam may land.
    lit: Vec<Vec<ShapeId>>,
    /// Whether light may go from what is lit to what is seen, for pairs that were asked for.
    known: BTreeMap<(Vec<ShapeId>, Vec<ShapeId>), bool>,
}

impl<'a> MayBeLit<'a> {
    pub(super) fn new(scene: &'a Scene, spots: Range<usize>) -> Self {
        let beams = Beams::new(scene);
        let all = || known_or_all(scene, None);
        let seen = |pixel: usize| {
            let known = PixelView::new(scene, pixel).shape().map(|s| vec![s]);
            let nothing = || sees_nothing(scene, pixel).then(Vec::new);
            let mut seen = known.or_else(nothing).unwrap_or_else(all);
            seen.retain(|s| !scene.surfaces[*s as usize].is_black());
            seen
        };
        let lit = |spot: usize| match beams.ideal.get(spot) {
            _ if scene.laser.is_shining() => vec![scene.laser.spots[spot].surface],
            Some(Some(point)) => vec![point.shape],
            Some(None) => Vec::new(),
            None => all(),
        };
        let pixels = (0..scene.camera.pixels()).into_par_iter();
        Self {
            scene,
            direct: DirectLight::new(&beams, &spots),
            seen: pixels.map(seen).collect(),
            lit: spots.map(lit).collect(),
            known: BTreeMap::new(),
        }
    }

    /// Whether light of a column may reach a pixel: no where the beam lands on nothing that
    /// reflects, where the pixel sees nothing, or where between any two surfaces of a path one lies
    /// behind the other or is black. Shapes in between are not considered, so a yes may be wrong.
    pub(super) fn entry(&mut self, pixel: usize, column: usize) -> bool {
        let (scene, seen, lit) = (self.scene, &self.seen[pixel], &self.lit[column]);
        if seen.is_empty() || lit.is_empty() {
            return false;
        }
        let reaches = || {
            let two = || lit.iter().any(|t| may_light_any(scene, seen, *t));
            scene.max_bounces > 1 && two()
                || scene.max_bounces > 2 && !between(scene, seen, lit).is_empty()
        };
        self.direct.may_reach(pixel, column)
            || *self
                .known
                .entry((seen.clone(), lit.clone()))
                .or_insert_with(reaches)
    }
}
