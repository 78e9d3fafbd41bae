//! What may be assumed of a wall.

use crate::scene::Scene;

/// An assumption.
#[derive(Debug)]
pub(super) struct Assumed {
    pub(super) name: String,
    /// The scene that has the wall that is assumed.
    pub(super) scene: Scene,
    /// Whether one factor of the whole model is fitted to the light by least squares: what a
    /// calibration finds.
    pub(super) scaled: bool,
}

impl Assumed {
    /// That the wall is as in `scene`.
    pub(super) fn right(name: &str, scene: &Scene) -> Self {
        Self {
            name: name.to_owned(),
            scene: scene.clone(),
            scaled: false,
        }
    }
}

/// The assumptions about the walls of `scene`, the true one first; those that its materials have no
/// parameter for, or that take it out of its range, are left out.
pub(super) fn assumed(scene: &Scene) -> Vec<Assumed> {
    let matt = scene.with_lambertian_relay();
    let mut found = vec![
        Assumed::right("own BRDF", scene),
        Assumed::right("Lambertian", &matt),
        Assumed {
            scaled: true,
            ..Assumed::right("Lambertian, best scale", &matt)
        },
    ];
    let variants = [
        ("roughness × 0.5", scene.with_relay_roughness_times(0.5)),
        ("roughness × 0.9", scene.with_relay_roughness_times(0.9)),
        ("roughness × 1.1", scene.with_relay_roughness_times(1.1)),
        ("roughness × 2", scene.with_relay_roughness_times(2.0)),
        ("index − 1 × 0.8", scene.with_relay_contrast_times(0.8)),
    ];
    for (name, variant) in variants {
        found.extend(variant.map(|scene| Assumed::right(name, &scene)));
    }
    found
}
