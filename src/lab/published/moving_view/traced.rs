//! Traced photographs, with the noise that their render has.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::super::plan::ReproducePlan;
use super::super::traced::{REPLICATES, replicates, trace};
use super::layout::{self, BOARDS, ELEMENTS, HALF_WIDTHS, PIXELS, View, board, scene};
use super::modelled::contrast_error;
use super::system::System;
use crate::lab::LabError;
use crate::lab::{Against, Certainty, Errors, Integration, Measured, Test, validate};
use crate::matrix::Matrix;
use crate::metrics::{mtf_raw, rmse};
use crate::model::Kernel;
use crate::model::Occlusion;
use crate::recovery::Method;
use crate::scene::Scene;
use crate::transport::{Control, Estimator};

/// Points of each replicate.
pub(super) const SIZE: u32 = 16;
/// Points of an element a side in the model that the photographs are recovered with: centres alone
/// are off by 2e-3, more than the noise.
pub(super) const POINTS: usize = 4;
/// Every tenth photograph is compared with the converged integral of its own view.
const EVERY: usize = 10;
/// At this significance in all.
pub(super) const SIGNIFICANCE: f64 = 1e-3;

/// Boards and views of the half-width 3 in.
pub(super) const CASES: [(usize, View); 4] = [
    (BOARDS[0], View::Fixed),
    (BOARDS[0], layout::TRACED),
    (BOARDS[1], View::Fixed),
    (BOARDS[1], layout::TRACED),
];

/// What the photographs of a case come to.
#[derive(Debug, Serialize, Deserialize)]
pub struct Seen {
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

/// Boards and views with what their photographs come to.
pub(super) type Traces = [((usize, View), Seen)];

impl Seen {
    /// The case numbered `index`.
    pub(in super::super) fn compute(
        index: usize,
        plan: &ReproducePlan,
        control: Control<'_>,
    ) -> Result<Self, LabError> {
        let (checks, view) = CASES[index];
        let scene = scene(HALF_WIDTHS[0].0, PIXELS)?.with_checkerboard(checks);
        one(&scene, view, checks, plan, control)
    }

    /// Whether it may be one.
    pub(in super::super) fn fits(&self) -> bool {
        self.recovered.len() == ELEMENTS * ELEMENTS && self.agreeing.iter().all(|n| *n <= 1 << 20)
    }
}

fn one(
    scene: &Scene,
    view: View,
    checks: usize,
    plan: &ReproducePlan,
    control: Control<'_>,
) -> Result<Seen, LabError> {
    let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
    let [mut flux, mut error] = [(); 2].map(|()| Matrix::zeros(pixels, spots));
    let mut agreeing = [0, 0];
    for spot in 0..spots {
        let seen = view.at(scene, spot);
        let (estimator, budget) = (Estimator::Independent, replicates(SIZE));
        let column = trace(
            &seen,
            estimator,
            budget,
            plan.first_seed,
            spot..spot + 1,
            control,
        )?;
        flux.set_column(spot, &column.flux.column(0));
        error.set_column(spot, &column.stderr.column(0));
        if spot % EVERY == 0 {
            let test = Test {
                significance: SIGNIFICANCE / spots.div_ceil(EVERY) as f64,
                known: Certainty::new(Errors::Independent, Some(REPLICATES)),
            };
            let verdict = validate(
                &view.photograph(scene, spot)?,
                Measured::new(&column.flux, &column.stderr, None),
                Against {
                    kernel: Kernel::Physical,
                    integration: Integration::Quadrature,
                    occlusion: Occlusion::Ignored,
                },
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
