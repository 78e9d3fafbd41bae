//! Traced Φcam against the matrix model of its scene.

use std::sync::{Arc, OnceLock};

use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, Occlusion, converged, is_obstructed};
use crate::num::named::named;
use crate::scene::{Profile, Scene};

use super::agreement::{Agreement, agree};
use super::derivatives::SceneDerivatives;
use super::evidence::{Evidence, Test};
use super::grounds::{Basis, Grounds};
use super::measured::{Measured, ValidationError};
use super::score::{Derivatives, ElementLight, SINGLE_ELEMENTS, SIZE_OF_SPOTS};
use super::unmodelled::unmodelled;

named! {
    /// How the model integrates.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Integration {
        /// Elements, pixels and spots by their centres; how far that is from the integral is the
        /// bound of each entry.
        Centres = "centres":
            "Elements, pixels and spots by their centres, with a bound on what that leaves out",
        /// Converged quadrature over elements, footprints and spots; the bound is what its last
        /// refinement changed.
        Quadrature = "quadrature": "Converged quadrature over elements, footprints and spots",
    }
}

/// What it is tested against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Against {
    /// Kernel of the model.
    pub kernel: Kernel,
    /// How it integrates.
    pub integration: Integration,
    /// Whether it knows what stands in the way.
    pub occlusion: Occlusion,
}

/// A verdict with what it rests on.
#[derive(Clone, Debug)]
pub struct Validation {
    /// The verdict.
    pub agreement: Agreement,
    /// z of every entry, pixels × spots.
    pub z: Matrix,
    /// The model that was tested, W.
    pub model: Matrix,
}

/// Tests Φcam with its standard error against the model of `scene`, its derivatives included.
/// Standard errors from few replicates are pooled over pixels and spots where these say more.
///
/// What is `beside` it is fitted to the entries whose standard error is not zero, and taken out
/// ([`Eliminated`](crate::lab::Eliminated)). A free scale that is not above 0 at the significance
/// level of `test` is no evidence: nothing of the model's light is seen.
///
/// # Errors
/// [`ValidationError`] if nothing is hidden, shapes or numbers do not fit, or other light could be
/// all light.
pub fn validate(
    scene: &Scene,
    measured: Measured<'_>,
    against: Against,
    test: Test,
) -> Result<Validation, ValidationError> {
    let (rows, columns) = (scene.camera.pixels(), scene.laser.spots.len());
    let beside = measured.beside;
    let given = [Some(measured.phi), Some(measured.stderr), beside.left_out];
    for (found_rows, found_columns) in given.into_iter().flatten().map(Matrix::shape) {
        if (found_rows, found_columns) != (rows, columns) {
            return Err(ValidationError::Shape {
                rows,
                columns,
                found_rows,
                found_columns,
            });
        }
    }
    beside.check((rows, columns))?;
    if test.known.paths.is_none() {
        measured.check_errors()?;
    }
    let Against {
        kernel,
        integration,
        occlusion,
    } = against;
    let extent = Extent {
        occlusion,
        ..Extent::FULL
    };
    if beside
        .left_out
        .is_some_and(|flags| flags.iter().all(|flag| *flag != 0.0))
    {
        return nothing_left(scene, measured, against, test);
    }
    let integral = converged(scene, kernel, extent)?;
    let (nodes, visible) = (integral.rough, integral.visible);
    let (mut phi, mut bound) = (integral.phi, integral.bound);
    let base = phi.clone();
    if integration == Integration::Centres {
        let centres = MatrixModel::with(scene, kernel, None, occlusion)?.phi();
        bound += (&centres - phi).abs();
        phi = centres;
    }
    let share = visible.as_ref().map(|v| &v.share);
    // A render has the scene's own picture; of measured light nobody knows it.
    let is_known = test.known.paths.is_some();
    let unknown = OnceLock::new();
    let picture = || {
        let light = || ElementLight::of(scene, kernel, occlusion).map(Arc::new);
        unknown.get_or_init(light).clone()
    };
    let off = SceneDerivatives::new(scene, kernel, nodes, &base, share);
    let basis = Basis {
        scene,
        kernel,
        bound: &bound,
        share,
        derivatives: Derivatives {
            parameters: &off.parameters,
            of: &|index| off.of(index),
            moved: &|index, size| off.moved(index, size),
            bends: scene
                .relays()
                .any(|(_, wall)| wall.seams().is_none_or(|seams| !seams.is_empty())),
            picture: (!is_known).then_some(&picture),
            are_named: true,
        },
    };
    let (mut agreement, z) = Grounds::new(&basis, measured, test).verdict(&phi)?;
    kernel.name().clone_into(&mut agreement.kernel);
    integration.name().clone_into(&mut agreement.integration);
    agreement.occlusion = visible.as_ref().map(|v| v.points);
    agreement.unmodelled.splice(0..0, unmodelled(scene));
    agreement.sent_on = scene.sent_on();
    if let Some(score) = &mut agreement.score {
        score.shadows_stay = off.are_shadows_still();
        let mut hidden = scene.hidden();
        let is_fitted = is_known || score.picture.is_some();
        if !is_fitted && hidden.any(|(_, s)| s.elements != [1, 1]) {
            score.untested.push(SINGLE_ELEMENTS.to_owned());
        }
        if !is_known && scene.laser.profile == Profile::Ideal {
            score.untested.push(SIZE_OF_SPOTS.to_owned());
        }
    }
    if occlusion == Occlusion::Ignored && is_obstructed(scene) {
        let told = "what stands in the way (`--no-occlusion` leaves it out)";
        agreement.unmodelled.push(told.to_owned());
    }
    Ok(Validation {
        agreement,
        z,
        model: phi,
    })
}

/// The verdict where no entry counts: to no evidence integrals, which may take long, add none.
fn nothing_left(
    scene: &Scene,
    measured: Measured<'_>,
    against: Against,
    test: Test,
) -> Result<Validation, ValidationError> {
    let model = MatrixModel::with(scene, against.kernel, None, against.occlusion)?.phi();
    let evidence = Evidence {
        traced: measured.phi,
        stderr: measured.stderr,
        model: &model,
        bound: None,
        left_out: measured.beside.left_out,
        eliminated: None,
    };
    let (mut agreement, z) = agree(evidence, test, None);
    against.kernel.name().clone_into(&mut agreement.kernel);
    Integration::Centres
        .name()
        .clone_into(&mut agreement.integration);
    Ok(Validation {
        agreement,
        z,
        model,
    })
}
