//! Traced photographs, with the noise that their render has.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::super::photographs::{REPLICATES, traced};
use super::super::{ReproduceError, ReproducePlan, Watch};
use super::layout::{self, View};
use super::modelled::contrast_error;
use super::system::System;
use super::{BOARDS, ELEMENTS, HALF_WIDTHS, PIXELS, board};
use crate::matrix::Matrix;
use crate::metrics::{mtf_raw, rmse};
use crate::model::Kernel;
use crate::recovery::Method;
use crate::scene::Scene;
use crate::study::{Errors, Integration, Test, validate};

/// Points of each replicate.
pub(super) const SIZE: u32 = 16;
/// Points of an element a side in the model that the photographs are recovered with: centres alone are off by 2e-3, more than the noise.
pub(super) const POINTS: usize = 4;
/// Every so many photographs are held against the converged integral of their own view.
const EVERY: usize = 10;
/// At this significance in all.
pub(super) const SIGNIFICANCE: f64 = 1e-3;

/// The photographs of one view and one board.
pub(super) struct Photographs {
    pub(super) view: View,
    pub(super) checks: usize,
    /// ‖standard errors‖/‖Φ‖.
    pub(super) noise: f64,
    pub(super) effective_rank: usize,
    pub(super) contrast_error: f64,
    pub(super) mtf: Option<f64>,
    pub(super) rmse: Option<f64>,
    pub(super) recovered: Vec<f64>,
    /// Photographs that agree with the integral, and how many were compared.
    pub(super) agreeing: [usize; 2],
}

/// Boards and views of the half-width 3 in.
pub(super) const CASES: [(usize, View); 4] = [
    (BOARDS[0], View::Fixed),
    (BOARDS[0], layout::TRACED),
    (BOARDS[1], View::Fixed),
    (BOARDS[1], layout::TRACED),
];

/// What the photographs of a case come to, as it travels.
#[derive(Debug, Serialize, Deserialize)]
pub struct Seen {
    noise: f64,
    effective_rank: usize,
    contrast_error: f64,
    mtf: Option<f64>,
    rmse: Option<f64>,
    recovered: Vec<f64>,
    agreeing: [usize; 2],
}

impl Seen {
    /// The case numbered `index`.
    pub(in super::super) fn compute(
        index: usize,
        plan: &ReproducePlan,
        watch: Watch<'_>,
    ) -> Result<Self, ReproduceError> {
        let (checks, view) = CASES[index];
        let scene = layout::scene(HALF_WIDTHS[0].0, PIXELS)?.with_checkerboard(checks);
        one(&scene, view, checks, plan, watch)
    }

    /// Whether it may be one.
    pub(in super::super) fn fits(&self) -> bool {
        self.recovered.len() == ELEMENTS * ELEMENTS && self.agreeing.iter().all(|n| *n <= 1 << 20)
    }
}

/// The photographs, from what they come to.
pub(super) fn photographs(found: Vec<Seen>) -> Vec<Photographs> {
    let of = |((checks, view), seen): ((usize, View), Seen)| Photographs {
        view,
        checks,
        noise: seen.noise,
        effective_rank: seen.effective_rank,
        contrast_error: seen.contrast_error,
        mtf: seen.mtf,
        rmse: seen.rmse,
        recovered: seen.recovered,
        agreeing: seen.agreeing,
    };
    CASES.into_iter().zip(found).map(of).collect()
}

fn one(
    scene: &Scene,
    view: View,
    checks: usize,
    plan: &ReproducePlan,
    watch: Watch<'_>,
) -> Result<Seen, ReproduceError> {
    let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
    let [mut flux, mut error] = [(); 2].map(|()| Matrix::zeros(pixels, spots));
    let mut agreeing = [0, 0];
    for spot in 0..spots {
        let seen = view.at(scene, spot);
        let column = traced(&seen, SIZE, plan.first_seed, spot..spot + 1, watch)?;
        flux.set_column(spot, &column.flux.column(0));
        error.set_column(spot, &column.stderr.column(0));
        if spot % EVERY == 0 {
            let test = Test {
                significance: SIGNIFICANCE / spots.div_ceil(EVERY) as f64,
                replicates: REPLICATES,
                errors: Errors::Independent,
            };
            let verdict = validate(
                &view.photograph(scene, spot)?,
                &column.flux,
                &column.stderr,
                Kernel::Physical,
                Integration::Quadrature,
                test,
            )?;
            agreeing[0] += usize::from(verdict.agreement.agrees);
            agreeing[1] += 1;
        }
    }
    let truth = board(checks);
    let system = System::new(scene, view, Kernel::Physical, POINTS)?;
    let weighted = system.weighted(&DVector::from_column_slice(error.as_slice()))?;
    let data = flux.component_div(&error);
    let along = weighted.along(&DVector::from_column_slice(data.as_slice()));
    let recovered = weighted.recover(Method::Joint, &along, 1.0)?.reflectance;
    Ok(Seen {
        noise: error.norm() / flux.norm(),
        effective_rank: weighted.effective_rank(1.0),
        contrast_error: contrast_error(&weighted, &along, &truth)?,
        mtf: mtf_raw(recovered.as_slice(), &truth),
        rmse: rmse(recovered.as_slice(), &truth),
        recovered: recovered.as_slice().to_vec(),
        agreeing,
    })
}
