//! What every estimator knows of a scene before it traces.

use std::cell::OnceCell;
use std::ops::Range;

use rayon::prelude::*;

use super::area::AreaSampler;
use super::camera::{DirectLight, PixelView, sees_nothing};
use super::importance::Importance;
use super::path::PathSampler;
use super::plan::Plan;
use super::spots::LitSpots;
use super::strata::Strata;
use super::visibility::{any_may_be_visible, between, known_or_all};
use crate::geometry::ShapeId;
use crate::scene::Scene;

/// The scene as the estimators see it, for some of its spots.
#[derive(Debug)]
pub(super) struct Context<'a> {
    pub scene: &'a Scene,
    pub plan: Plan,
    pub path: PathSampler<'a>,
    pub spots: LitSpots<'a>,
    pub direct: DirectLight,
    /// By pixel.
    pub views: Vec<PixelView>,
    /// Shapes that light may meet just before it reaches what a pixel sees.
    pub between: Vec<ShapeId>,
    /// Points on those.
    pub strata: Strata<'a>,
    /// Whether light that met two surfaces can reach any pixel.
    pub has_two_bounce_light: bool,
    /// Whether any surface of the scene is not Lambertian.
    pub is_glossy: bool,
}

impl<'a> Context<'a> {
    pub(super) fn new(scene: &'a Scene, plan: &Plan, spots: Range<usize>) -> Self {
        let blocks = (plan.sampling, plan.budget.size);
        let spots = LitSpots::new(scene, spots, blocks);
        let views = (0..scene.camera.pixels()).into_par_iter();
        let views: Vec<PixelView> = views.map(|p| PixelView::new(scene, p)).collect();
        let seen = known_or_all(scene, views.iter().map(PixelView::shape).collect());
        let lit = spots.beams.lit_shapes();
        let between = between(scene, &seen, &lit);
        let guided = OnceCell::new();
        let guide = || {
            let sampler = || AreaSampler::guided(scene, &between, &importance(&views, &spots));
            guided.get_or_init(sampler).clone()
        };
        let path = PathSampler::new(scene, &seen, guide);
        let close = !seen.iter().all(|s| path.far_from_hidden(*s));
        let two = |t: &ShapeId| any_may_be_visible(scene, &seen, *t);
        Self {
            scene,
            plan: *plan,
            direct: DirectLight::new(scene, &spots),
            strata: Strata::new(
                scene,
                &between,
                close.then(guide),
                (plan.sampling, plan.budget.size),
            ),
            has_two_bounce_light: scene.max_bounces > 1 && lit.iter().any(two),
            is_glossy: scene.surfaces.iter().any(|s| !s.is_lambertian()),
            path,
            spots,
            views,
            between,
        }
    }

    /// Whether light of a column may reach a pixel: no where the beam lands on nothing that
    /// reflects, where the pixel sees nothing, or where between any two surfaces of a path one lies
    /// behind the other or is black. Shapes in between are not considered, so a yes may be wrong.
    pub(super) fn may_be_lit(&self, pixel: usize, column: usize) -> bool {
        let (scene, all) = (self.scene, || known_or_all(self.scene, None));
        let spot = self.spots.range.start + column;
        let lit = match self.spots.beams.ideal.get(spot) {
            Some(Some(point)) => vec![point.shape],
            Some(None) => return false,
            None => all(),
        };
        let is_black = |s: &ShapeId| scene.surfaces[*s as usize].is_black();
        let known = self.views[pixel].shape().map(|s| vec![s]);
        let nothing = || sees_nothing(scene, pixel).then(Vec::new);
        let mut seen = known.or_else(nothing).unwrap_or_else(all);
        seen.retain(|s| !is_black(s));
        let two = || lit.iter().any(|t| any_may_be_visible(scene, &seen, *t));
        !seen.is_empty()
            && (self.direct.may_reach(pixel, column)
                || scene.max_bounces > 1 && two()
                || scene.max_bounces > 2 && !between(scene, &seen, &lit).is_empty())
    }

    /// The first shape of `between` that is not Lambertian, by name.
    pub(super) fn glossy_between(&self) -> Option<&'a str> {
        let mut shapes = self.between.iter();
        shapes.find_map(|s| {
            let surface = &self.scene.surfaces[*s as usize];
            (!surface.is_lambertian()).then_some(surface.name.as_str())
        })
    }
}

/// That of the middles of all pixels and beams.
fn importance<'a>(views: &[PixelView], spots: &LitSpots<'a>) -> Importance<'a> {
    let scene = spots.scene;
    let seen = views.iter().filter_map(|v| v.vertex(scene, [0.5; 2]));
    // All spots, whichever of them are traced: their bits do not depend on that.
    let lit = 0..scene.laser.spots.len();
    let lit = lit.filter_map(|spot| spots.beams.point(spot, [0.5; 2]));
    Importance::new(scene, &seen.collect::<Vec<_>>(), &lit.collect::<Vec<_>>())
}
