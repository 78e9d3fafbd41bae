//! What every estimator knows of a scene before it traces.

use std::cell::OnceCell;
use std::ops::Range;

use rayon::prelude::*;

use super::camera::PixelView;
use super::direct_light::DirectLight;
use super::guide::Guide;
use super::path::PathSampler;
use super::plan::Plan;
use super::spots::LitSpots;
use super::strata::Strata;
use super::visibility::{between, known_or_all, may_light};
use crate::geometry::ShapeId;
use crate::scene::Scene;

/// The scene as the estimators see it, for some of its spots.
#[derive(Debug)]
pub(super) struct Context<'a> {
    pub scene: &'a Scene,
    pub plan: Plan,
    pub path: PathSampler<'a>,
    /// Where points between the walls are drawn, where anything may be near.
    pub guide: Option<Guide>,
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
        let mut spots = LitSpots::new(scene, spots, blocks);
        let views = (0..scene.camera.pixels()).into_par_iter();
        let views: Vec<PixelView> = views.map(|p| PixelView::new(scene, p)).collect();
        let seen = known_or_all(scene, views.iter().map(PixelView::shape).collect());
        let lit = spots.beams.lit_shapes();
        let between = between(scene, &seen, &lit);
        let guide = OnceCell::new();
        let guided = || {
            guide
                .get_or_init(|| Guide::new(&between, &views, &spots, plan))
                .for_all()
        };
        let path = PathSampler::new(scene, &seen, guided);
        let close = !seen.iter().all(|s| path.far_from_hidden(*s));
        let two = |t: &ShapeId| {
            seen.iter()
                .any(|s| may_light(scene, &(*s, None), &(*t, None)))
        };
        let strata = Strata::new(
            scene,
            &between,
            close.then(guided),
            (plan.sampling, plan.budget.size),
        );
        let guide = guide.into_inner().filter(|guide| !guide.is_empty());
        if let Some(guide) = &guide
            && guide.is_by_column()
            && scene.max_bounces <= 3
            && seen.iter().all(|s| path.chooses_at(*s))
        {
            let reach = spots.beams.reach();
            let near = |spot: usize| guide.is_too_coarse_for(scene, spot, reach);
            spots.light_paths.keep(near);
        }
        Self {
            scene,
            plan: *plan,
            direct: DirectLight::new(&spots.beams, &spots.range),
            strata,
            has_two_bounce_light: scene.max_bounces > 1 && lit.iter().any(two),
            is_glossy: scene.surfaces.iter().any(|s| !s.is_lambertian()),
            path,
            guide,
            spots,
            views,
            between,
        }
    }

    /// The first shape of `between` that is not Lambertian, by name.
    pub(super) fn glossy_between(&self) -> Option<&'a str> {
        let mut shapes = self.between.iter();
        shapes.find_map(|s| {
            let surface = &self.scene.surfaces[*s as usize];
            (!surface.is_lambertian()).then_some(surface.name.as_str())
        })
    }

    /// The shape that estimator `Factored` has no points on, by name: one that is not Lambertian,
    /// where a path goes on from it to a fourth surface.
    pub(super) fn unfactored(&self) -> Option<&'a str> {
        let deep = self.scene.max_bounces > 3;
        deep.then(|| self.glossy_between()).flatten()
    }
}
