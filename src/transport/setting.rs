//! What every estimator knows of a scene before it traces.

use std::ops::Range;

use rayon::prelude::*;

use super::beam::Beams;
use super::direct::Direct;
use super::eye::{Sighting, seen};
use super::gloss;
use super::lamp::{Lamp, lit};
use super::render::Plan;
use super::sight::{between, two_surfaces};
use super::strata::{Near, Strata};
use super::walk::Walk;
use crate::geometry::ShapeId;
use crate::scene::Scene;

/// The scene as the estimators see it.
#[derive(Debug)]
pub(super) struct Setting<'a> {
    pub scene: &'a Scene,
    pub plan: &'a Plan,
    pub beams: &'a Beams<'a>,
    pub walk: Walk<'a>,
    pub lamp: Lamp<'a>,
    pub direct: Direct<'a>,
    /// By pixel.
    pub sightings: Vec<Sighting>,
    /// Shapes that light may meet just before it reaches what a pixel sees.
    pub between: Vec<ShapeId>,
    /// Points on those.
    pub strata: Strata<'a>,
    /// Whether light that met two surfaces can reach any pixel.
    pub two: bool,
    /// Whether all of `between` is Lambertian.
    pub plain: bool,
    /// Whether anything in the scene is not.
    pub glossy: bool,
}

impl<'a> Setting<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        plan: &'a Plan,
        beams: &'a Beams<'a>,
        spots: Range<usize>,
    ) -> Self {
        let lamp = Lamp::new(scene, beams, spots.clone());
        let sightings: Vec<Sighting> = (0..scene.camera.pixels())
            .into_par_iter()
            .map(|p| Sighting::new(scene, p))
            .collect();
        let (seen, lit) = (seen(scene, &sightings), lit(scene, beams));
        let between = between(scene, &seen, &lit);
        let walk = Walk::new(scene);
        let plain = between
            .iter()
            .all(|s| scene.surfaces[*s as usize].is_lambertian());
        let near = match seen.iter().all(|s| walk.far_from_hidden(*s)) {
            true => Near::Nothing,
            false => Near::Something,
        };
        Self {
            scene,
            plan,
            beams,
            walk,
            direct: Direct::new(scene, beams, spots),
            strata: Strata::new(scene, &between, near, plan.sampling, plan.budget.size),
            two: two_surfaces(scene, &seen, &lit),
            plain,
            glossy: gloss::in_scene(scene),
            lamp,
            sightings,
            between,
        }
    }
}
