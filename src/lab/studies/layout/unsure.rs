//! What of the geometry is known only roughly.

use crate::lab::comparison::misplaced::{self, Misplaced};
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::scene::Scene;

/// Step of a derivative, in standard deviations: small against what a layout sees of them, large
/// against rounding.
const STEP: f64 = 1e-3;

/// One parameter θ ~ N(0, σ²) of the geometry.
#[derive(Clone, Debug)]
pub(super) struct Unsure {
    what: &'static Misplaced,
    /// σ, in its unit.
    pub deviation: f64,
}

/// Names in [`misplaced::ALL`] by the options that set them.
const NAMES: [(&str, &[&str]); 3] = [
    ("hinge", &["hinge angle"]),
    ("offset", &["S2 along its normal"]),
    ("aim", &["all spots, x", "all spots, y"]),
];

impl Unsure {
    /// The parameters of an option, each known to `deviation`.
    pub(super) fn of(option: &str, deviation: f64) -> impl Iterator<Item = Self> {
        let named = NAMES.iter().filter(move |(name, _)| *name == option);
        let all =
            named.flat_map(|(_, names)| misplaced::ALL.iter().filter(|m| names.contains(&m.name)));
        all.map(move |what| Self { what, deviation })
    }

    /// σ ∂φ/∂θ by the central difference (φ(hσ) − φ(−hσ))/(2h), h = 10⁻³; its error is of order h².
    ///
    /// # Errors
    /// [`LabError::Unsuited`] where the scene has no such parameter.
    pub(super) fn slope(
        &self,
        scene: &Scene,
        photograph: impl Fn(&Scene) -> Result<Matrix, LabError>,
    ) -> Result<Matrix, LabError> {
        let at = |step: f64| {
            let moved = self.what.apply(scene, step * self.deviation);
            let none =
                "this scene cannot be moved as --hinge, --offset or --aim say; leave them out";
            photograph(&moved.ok_or(LabError::Unsuited(none))?)
        };
        Ok((at(STEP)? - at(-STEP)?) / (2.0 * STEP))
    }
}
