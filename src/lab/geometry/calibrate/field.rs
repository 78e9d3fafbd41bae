//! Errors that neighbouring pixels share, in place of noise of single pixels.
//!
//! What the model lacks hangs together over the photographs. Taken for an [`ErrorField`] it is the
//! likeliest given the prior of the picture, in turn with the unknowns. With
//!
//! > ½ n (ln det V + ln det UᵀV⁻¹U),   U an orthonormal basis of TᵀF,
//!
//! of the errors' covariance T V Tᵀ, of which the patterns F of other light are left out, the
//! likelihoods of different errors are comparable; T the cosines, n frames.

use nalgebra::DVector;

use super::descent::{Problem, Stage, State};
use crate::lab::error::LabError;
use crate::lab::uncertainty::unexplained::Unexplained;
use crate::matrix::Matrix;
use crate::num::cosines::along_cosines;
use crate::num::linalg::{Cholesky, tr_product};
use crate::recovery::ErrorField;
use crate::transport::Control;

/// The field and the unknowns are found in turn at most so often, until no unknown moves by more
/// than this part of its error.
const MOST_TURNS: usize = 12;
const STILL: f64 = 0.05;

const NOISE_IS_KNOWN: LabError = LabError::Unsuited(
    "the noise of the photographs is stated: there is no field of errors to find; leave out --error-field, or the noise (--phi without --stderr)",
);
const NO_FIELD: LabError = LabError::Unsuited(
    "a field of errors is not found where entries are left out, or where there are not more entries than elements; leave out --error-field",
);

/// The photographs along their cosines, with the errors of a field.
pub(super) struct Field {
    pub errors: ErrorField,
    frame: [usize; 2],
    phi: Matrix,
    patterns: Option<Matrix>,
    /// U.
    basis: Matrix,
    /// √v, pixels × frames.
    stderr: Matrix,
}

/// Where the descent ended.
pub(super) struct End {
    pub state: State,
    pub stages: Vec<Stage>,
    /// None where errors are of single pixels.
    pub field: Option<Field>,
    /// −ln of the likelihood, and with errors of single pixels.
    pub total: f64,
    pub without: f64,
    /// Whether it is the end of one of the starts.
    pub is_of_start: bool,
}

impl Field {
    /// Of the photographs of `problem`, columns × rows of `frame`.
    pub(super) fn new(problem: &Problem<'_>, errors: ErrorField) -> Result<Self, LabError> {
        let Unexplained { phi, patterns, .. } = problem.photographs;
        let camera = &problem.geometry.scene.camera;
        let frame = [camera.columns, camera.rows];
        let white = problem.photographs.whitening(0)?;
        let mut field = Self {
            errors,
            frame,
            phi: along_cosines(phi, frame),
            patterns: patterns.map(|f| along_cosines(f, frame)),
            basis: along_cosines(white.directions(), frame),
            stderr: Matrix::zeros(phi.nrows(), phi.ncols()),
        };
        field.set(errors);
        Ok(field)
    }

    fn set(&mut self, errors: ErrorField) {
        self.errors = errors;
        self.stderr = errors.stderr(self.frame, self.phi.ncols());
    }

    /// ½ ln det of the errors' covariance, the patterns left out.
    fn log_errors(&self) -> Result<f64, LabError> {
        let v: DVector<f64> = self.stderr.column(0).map(|s| s * s);
        let mut all: f64 = v.iter().map(|v| libm::log(*v)).sum();
        let u = &self.basis;
        let weighted = Matrix::from_fn(u.nrows(), u.ncols(), |k, j| u[(k, j)] / v[k]);
        if u.ncols() > 0 {
            let gram = Cholesky::new(&tr_product(u, &weighted)).ok_or(LabError::TOO_FINE)?;
            all += gram.log_det();
        }
        Ok(0.5 * self.phi.ncols() as f64 * all)
    }
}

impl End {
    /// With errors of single pixels.
    pub(super) fn new(problem: &Problem<'_>, state: State, stages: Vec<Stage>) -> Self {
        let total = problem.total(&state);
        Self {
            state,
            stages,
            field: None,
            total,
            without: total,
            is_of_start: true,
        }
    }

    /// Noise of a pixel over the stated one.
    pub(super) fn noise(&self) -> f64 {
        let field = self.field.as_ref().map(|field| field.errors.pixel);
        field.unwrap_or(self.state.factor)
    }

    /// ‖y − Aρ̂‖/‖y‖ at the weights of `problem`, in which errors are of single pixels.
    pub(super) fn left_over(&self, problem: &Problem<'_>) -> Result<f64, LabError> {
        let State { values, value, .. } = &self.state;
        let seen = problem.seen(self.state.factor);
        let left = match self.field {
            None => value.chi2,
            Some(_) => {
                let light = problem.light(values, 0.0, false)?;
                seen.residue(&light, &value.rho)?
            }
        };
        Ok((left / seen.square()?).sqrt())
    }
}

impl<'a> Problem<'a> {
    /// Whether a field of errors can be found.
    pub(super) fn has_field(&self) -> Result<(), LabError> {
        let Unexplained {
            phi,
            stderr,
            left_out,
            ..
        } = self.photographs;
        let is_whole = left_out.is_none_or(|flags| flags.iter().all(|x| *x == 0.0));
        let elements = self.pictures.first().map_or(0, |p| p.root.nrows());
        match stderr {
            Some(_) => Err(NOISE_IS_KNOWN),
            None if !is_whole || phi.len() <= elements => Err(NO_FIELD),
            None => Ok(()),
        }
    }

    /// The same along the cosines with the errors of `field`.
    ///
    /// # Errors
    /// [`LabError::TOO_FINE`] where rounding loses the patterns of other light.
    pub(super) fn with_field<'b>(&'b self, field: &'b Field) -> Result<Problem<'b>, LabError>
    where
        'a: 'b,
    {
        Ok(Problem {
            photographs: Unexplained {
                phi: &field.phi,
                stderr: Some(&field.stderr),
                certainty: self.photographs.certainty,
                left_out: None,
                patterns: field.patterns.as_ref(),
            },
            priors: self.priors.clone(),
            cosines: Some(field.frame),
            log_errors: field.log_errors()?,
            ..*self
        })
    }

    /// On from where the descent by errors of single pixels ended; none where errors are no more
    /// than rounding.
    pub(super) fn with_shared_errors(
        &self,
        (state, mut stages): (State, Vec<Stage>),
        control: Control<'_>,
    ) -> Result<End, LabError> {
        let without = self.total(&state);
        let alone = ErrorField {
            pixel: state.factor,
            shared: 0.0,
            range: 1.0,
        };
        let mut field = Field::new(self, alone)?;
        let mut last: Option<State> = None;
        for _ in 0..MOST_TURNS {
            let now = last.as_ref().unwrap_or(&state);
            if !self.likeliest_errors(&mut field, now, control)? {
                return Ok(End::new(self, state, stages));
            }
            let own = self.with_field(&field)?;
            let (next, steps) = own.stage(&now.values, 1.0, control)?;
            let covariance = Cholesky::new(&own.information(&next.slope));
            let errors = covariance.ok_or(LabError::DARK)?.inverse().diagonal();
            let each = next.values.iter().zip(&now.values).zip(&errors);
            let moved = each.map(|((a, b), v)| (a - b).abs() / v.sqrt());
            let is_still = last.is_some() && moved.fold(0.0, f64::max) < STILL;
            stages.push(Stage {
                noise: libm::hypot(field.errors.pixel, field.errors.shared),
                steps,
                misfit: next.left(),
                values: next.values.clone(),
            });
            let is_settled = next.is_settled && is_still;
            last = Some(State { is_settled, ..next });
            if is_settled {
                break;
            }
        }
        let state = last.unwrap_or(state);
        Ok(End {
            total: self.with_field(&field)?.total(&state),
            state,
            stages,
            field: Some(field),
            without,
            is_of_start: true,
        })
    }

    /// The likeliest errors at a state's unknowns and prior of pictures; whether they are more than
    /// rounding.
    pub(super) fn likeliest_errors(
        &self,
        field: &mut Field,
        state: &State,
        control: Control<'_>,
    ) -> Result<bool, LabError> {
        let light = self.geometry.light(&state.values, 0.0, false)?;
        let (frames, frame) = (field.phi.ncols() as f64, field.frame);
        let square = field.phi.norm_squared() / field.phi.len() as f64;
        let found = ErrorField::maximised(field.errors, frame, square, |errors, v| {
            control.check()?;
            field.set(*errors);
            let own = self.with_field(field)?;
            let seen = own.seen(1.0);
            let normal = seen.normal(&light)?;
            let value = seen.value(&light, &normal, &state.prior)?;
            let left = seen.squares(&light, &state.prior, &value)?;
            let squares = left.iter().zip(v).map(|(q, v)| v * q / frames);
            Ok::<_, LabError>(Some(squares.collect()))
        })?;
        if let Some(errors) = found {
            field.set(errors);
        }
        Ok(found.is_some())
    }
}
