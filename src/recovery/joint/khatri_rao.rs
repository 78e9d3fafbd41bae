//! The weighted least-squares operator over all pixels and spots, compressed.
//!
//! > minimise Σ_pl w_p v_l (Φ\[p,l\] − Σ_j C\[p,j\] ρ_j D\[j,l\])²
//!
//! Its matrix has a row for every (pixel, spot) and is the Khatri–Rao (column-wise Kronecker)
//! product of C̃ = √W C and (D √V)ᵀ = D̃ᵀ, summed over the terms of an element where it has
//! several. With C̃ = U_c Σ_c V_cᵀ and D̃ = U_d Σ_d V_dᵀ the sum above is, but for a constant,
//!
//! > Σ_ab (F\[a,b\] − Σ_j (Σ_c V_cᵀ)\[a,j\] (U_d Σ_d)\[j,b\] ρ_j)²,   F = U_cᵀ √W Φ √V V_d,
//!
//! so only rank(C̃)·rank(D̃) rows remain. Directions below the rounding of C̃ and D̃ are dropped;
//! of large products also the pairs (a, b) of two weak directions, whose rows together are less
//! than one rounding of the whole. Frame constants and a background are projected out of both sides
//! first ([`super::elimination`]). Of more than 512 elements, where the noise is known, the normal
//! equations are summed with each entry's own weight, and reduced to the rows that the noise leaves
//! ([`super::gram`]); with glare patterns there is no such product, and the rows are
//! stacked instead ([`super::stacked`]), each with its own weight.

use std::sync::{Arc, OnceLock};

use nalgebra::{DMatrix, DVector};

use super::conditional::Conditional;
use super::elimination::{directions, estimate, unit, without_left, without_right};
use super::gram;
use super::sides::Sides;
use super::stacked::{Coupled, Stacked, stack};
use super::weights::{self, Weights};
use crate::num::linalg::{
    Gram, LeastSquares, Route, Svd, Tolerance, Triangle, columns_over, least_squares,
    normal_triangle, pivoted_triangle, product, rows_times, svd_of_range, svd_to, tr_product,
    triangle,
};
use crate::recovery::{
    Deviations, Estimated, Gains, Options, Problem, RecoveryError, WeightRule, Weighting,
};

/// Elements whose Gram matrix (and its few copies) is still formed: 512 MiB each.
const MOST_ELEMENTS: usize = 8192;

/// Elements up to which the operator is compressed to rounding, whatever the noise; of more, where
/// the noise is known, to what it leaves.
const FEW: usize = 512;

/// The problem after compression.
#[derive(Debug)]
pub(super) struct Operator {
    form: Form,
    elements: usize,
    /// The element of each term of the sides.
    element: Vec<usize>,
    weights: Weights,
    gains: Conditionals,
    sides: Option<Sides>,
    pub(super) weighting: Weighting,
    /// Kept from the first time they are asked for.
    directions: OnceLock<Arc<(Svd, DVector<f64>)>>,
    solved: OnceLock<Arc<LeastSquares>>,
}

/// The noise by which entries are weighted.
fn known<'a>(problem: &Problem<'a>, options: &Options) -> Option<&'a DMatrix<f64>> {
    let weighted = options.weighting != WeightRule::Unweighted;
    problem.noise().filter(|_| weighted)
}

/// v_k/s_k as columns, r × rank.
fn towards(solved: &LeastSquares) -> DMatrix<f64> {
    columns_over(solved.vt.transpose(), &solved.sigma)
}

#[derive(Debug)]
enum Form {
    /// The Khatri–Rao product of the small factors and the compressed Φ as one column.
    Small {
        a: DMatrix<f64>,
        b: DVector<f64>,
        rows: usize,
    },
    /// From the Gram matrix (C̃ᵀC̃) ∘ (D̃D̃ᵀ), where the product is beyond the budget.
    Normal(Triangle),
    /// Row by row, each with its own weight.
    Stacked {
        triangle: Triangle,
        coupled: Option<Coupled>,
        rows: usize,
    },
}

/// Deviations that are known roughly, given x.
#[derive(Debug, Default)]
struct Conditionals {
    frames: Option<Conditional>,
    whole: Option<Conditional>,
}

/// The pairs (a, b) of rows of T and columns of S whose rows T\[a,j\] S\[j,b\] of the product carry
/// it to rounding: all of them, unless their number times the elements is beyond the budget. Then
/// the least are left out, so many that their common norm stays below one rounding of the whole's.
fn pairs(t: &DMatrix<f64>, s: &DMatrix<f64>, budget: usize) -> Vec<[usize; 2]> {
    let (rc, rd) = (t.nrows(), s.ncols());
    let all = (0..rc * rd).map(|row| [row % rc, row / rc]);
    if (rc * rd).saturating_mul(t.ncols()) <= budget {
        return all.collect();
    }
    let squares = product(&t.component_mul(t), &s.component_mul(s));
    let mut by_size: Vec<[usize; 2]> = all.collect();
    by_size.sort_by(|x, y| squares[(x[0], x[1])].total_cmp(&squares[(y[0], y[1])]));
    let allowed = f64::EPSILON * f64::EPSILON * squares.sum();
    let mut lost = 0.0;
    let first = by_size.iter().position(|&[a, b]| {
        lost += squares[(a, b)];
        lost > allowed
    });
    by_size.split_off(first.unwrap_or(0))
}

/// Rows of terms added up to rows of elements.
fn gathered(element: &[usize], rows: &DMatrix<f64>, elements: usize) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(elements, rows.ncols());
    for (s, j) in element.iter().enumerate() {
        let mut sum = sums.row_mut(*j);
        sum += rows.row(s);
    }
    sums
}

/// The operator of the problem, that of an earlier call where the problem shares them.
pub(super) fn operator(
    problem: &Problem<'_>,
    options: &Options,
) -> Result<Arc<Operator>, RecoveryError> {
    let find = || Operator::new(problem, options);
    match problem.shared {
        Some(shared) => shared.get(options, find),
        None => find().map(Arc::new),
    }
}

impl Operator {
    /// Weighs, eliminates what is not asked about, and compresses.
    pub(super) fn new(problem: &Problem<'_>, options: &Options) -> Result<Self, RecoveryError> {
        let elements = problem.elements();
        if elements > MOST_ELEMENTS {
            return Err(RecoveryError::TooManyElements {
                elements,
                most: MOST_ELEMENTS,
            });
        }
        let (c, d, element) = problem.sides();
        let (pixels, spots) = problem.phi.shape();
        let known = known(problem, options);
        let weights = weights::fit(known, pixels, spots);
        let by_entry = elements > FEW || options.weighting == WeightRule::Entries;
        let holed = problem.nuisance.left_out.is_some() || problem.soft.is_some();
        let by_entry = known.is_some() && (by_entry || holed);
        let root = |p: usize, l: usize| weights.root(problem, known, p, l);
        let reduced = if by_entry {
            gram::reduced(problem, root)?
        } else {
            None
        };
        let by_rows = match reduced {
            Some(stacked) => Some((stacked.triangle.r.nrows(), stacked)),
            None if problem.nuisance.glare.is_some() || holed => {
                Some((pixels * spots, stack(problem, root)?))
            }
            None => None,
        };
        if let Some((rows, stacked)) = by_rows {
            let Stacked {
                triangle,
                coupled,
                frames,
                whole,
            } = stacked;
            return Ok(Operator {
                form: Form::Stacked {
                    triangle,
                    coupled,
                    rows,
                },
                gains: Conditionals { frames, whole },
                elements,
                element,
                sides: None,
                weighting: match known {
                    Some(_) => Weighting::EntryByEntry,
                    None => Weighting::Unweighted,
                },
                weights,
                directions: OnceLock::new(),
                solved: OnceLock::new(),
            });
        }
        let by_pixel = |m: &DMatrix<f64>| {
            DMatrix::from_fn(m.nrows(), m.ncols(), |p, j| weights.pixels[p] * m[(p, j)])
        };
        let by_spot = |m: &DMatrix<f64>| {
            DMatrix::from_fn(m.nrows(), m.ncols(), |j, l| m[(j, l)] * weights.spots[l])
        };
        let (mut c, mut d, mut phi) = (by_pixel(c), by_spot(d), by_spot(&by_pixel(problem.phi)));
        let before = (c.norm(), d.norm());
        let frames = problem.nuisance.of_frames(pixels);
        for u in directions(&frames, |p| weights.pixels[p]) {
            without_left(&mut c, &u);
            without_left(&mut phi, &u);
        }
        if problem.nuisance.background {
            let v = unit(&weights.spots);
            without_right(&mut d, &v);
            without_right(&mut phi, &v);
        }
        let Sides { u, t, s, v } = Sides::new([&c, &d], [before.0, before.1])?;
        let pairs = pairs(&t, &s, options.budget);
        let form = if pairs.len().saturating_mul(elements) <= options.budget {
            let mut a = DMatrix::zeros(pairs.len(), elements);
            for (term, j) in element.iter().enumerate() {
                for (row, pair) in pairs.iter().enumerate() {
                    a[(row, *j)] += t[(pair[0], term)] * s[(term, pair[1])];
                }
            }
            let f = product(&tr_product(&u, &phi), &v.transpose());
            Form::Small {
                a,
                b: DVector::from_fn(pairs.len(), |row, _| f[(pairs[row][0], pairs[row][1])]),
                rows: t.nrows() * s.ncols(),
            }
        } else {
            let gathered = |m: &DMatrix<f64>| gathered(&element, m, elements);
            let both = tr_product(&c, &c).component_mul(&product(&d, &d.transpose()));
            let whole = gathered(&gathered(&both).transpose());
            let along = gathered(&tr_product(&c, &phi).component_mul(&d));
            let (moment, square) = (along.column_sum(), phi.norm_squared());
            let fewer = if by_entry {
                let (along, grey) = (gram::GREY * moment.sum(), gram::GREY.powi(2) * whole.sum());
                let lost = gram::lost(problem, along, grey, square);
                let gram = Gram {
                    diagonal: whole.diagonal(),
                    column: |j| Some(whole.column(j).into_owned()),
                    most: elements,
                };
                pivoted_triangle(gram, &moment, square, lost)?
            } else {
                None
            };
            Form::Normal(match fewer {
                Some(triangle) => triangle,
                None => normal_triangle(&whole, &moment, square)?,
            })
        };
        Ok(Operator {
            form,
            elements,
            element,
            weighting: weights.weighting,
            weights,
            gains: Conditionals::default(),
            sides: Some(Sides { u, t, s, v }),
            directions: OnceLock::new(),
            solved: OnceLock::new(),
        })
    }

    /// The nuisance terms that go with `seen` = s ρ, and what they and its light leave over,
    /// pixels × spots, W.
    pub(super) fn nuisances(
        &self,
        problem: &Problem<'_>,
        options: &Options,
        seen: &DVector<f64>,
    ) -> Result<(Estimated, DMatrix<f64>), RecoveryError> {
        let (seen, whole) = match (&self.gains.whole, self.direction(problem)) {
            (Some(of), Some(z)) => {
                let whole = of.given(seen);
                (seen + z * whole[0], Some(whole))
            }
            _ => (seen.clone(), None),
        };
        let frames = self.gains.frames.as_ref().map(|of| of.given(&seen));
        let mut left = problem.phi - problem.light(&seen);
        let pattern = problem.soft.and_then(|soft| soft.frames.as_ref());
        if let (Some((pattern, _)), Some(gains)) = (pattern, &frames) {
            for (l, gain) in gains.iter().enumerate() {
                left.column_mut(l).axpy(-gain, &pattern.column(l), 1.0);
            }
        }
        let known = known(problem, options);
        let mut found = match &self.form {
            Form::Stacked { coupled, .. } => {
                let coupled = coupled.as_ref().map(|c| c.solve(&seen, frames.as_ref()));
                let root = |p: usize, l: usize| self.weights.root(problem, known, p, l);
                estimate(&problem.nuisance, &left, root, coupled.as_ref())?
            }
            _ => {
                let root = |p: usize, l: usize| self.weights.pixels[p] * self.weights.spots[l];
                estimate(&problem.nuisance, &left, root, None)?
            }
        };
        let (pixels, spots) = left.shape();
        left -= found.light(&problem.nuisance, pixels, spots);
        if let Some(soft) = problem.soft {
            let factors = |size: Option<DVector<f64>>, known_to: Option<f64>| {
                let (size, known_to) = (size?, known_to?);
                Some(Deviations {
                    standard_error: DVector::zeros(size.len()),
                    size,
                    known_to,
                    picture_given: true,
                })
            };
            let mut gains = Gains {
                frames: factors(frames, soft.frames.as_ref().map(|of| of.1)),
                whole: factors(whole, soft.whole.as_ref().map(|of| of.1)),
                ..Gains::default()
            };
            self.add_errors(problem, &mut gains, None);
            found.gains = Some(gains);
        }
        Ok((found, left))
    }

    /// z: the common factor's ε multiplies the light of these numbers.
    fn direction<'a>(&self, problem: &Problem<'a>) -> Option<&'a DVector<f64>> {
        let (z, _) = problem.soft?.whole.as_ref()?;
        Some(z)
    }

    /// The standard errors of the factors where x has the covariance `of_x`; where none is known,
    /// given x. With x and ε uncertain x + ε z has the covariance
    ///
    /// > (1 − z qᵀ) Cov(x) (1 − q zᵀ) + v z zᵀ,   ε | x ~ N(… − qᵀx, v).
    pub(super) fn add_errors(
        &self,
        problem: &Problem<'_>,
        gains: &mut Gains,
        of_x: Option<&DMatrix<f64>>,
    ) {
        let Some(soft) = problem.soft else { return };
        let n = self.elements;
        let mut of_seen = of_x.cloned().unwrap_or_else(|| DMatrix::zeros(n, n));
        if let (Some(of), Some(z)) = (&self.gains.whole, self.direction(problem)) {
            if let Some(whole) = &mut gains.whole {
                whole.standard_error = of.errors(&of_seen, soft.noise);
                whole.picture_given = of_x.is_none();
            }
            let turn = DMatrix::identity(n, n) - z * of.slope.row(0);
            of_seen = product(&product(&turn, &of_seen), &turn.transpose());
            of_seen.ger(of.variance[0] * soft.noise * soft.noise, z, z, 1.0);
        }
        if let (Some(of), Some(frames)) = (&self.gains.frames, &mut gains.frames) {
            frames.standard_error = of.errors(&of_seen, soft.noise);
            frames.picture_given = of_x.is_none();
        }
    }

    /// −2 ln of the density of the data at the x that fits best, but for a constant that holds for all
    /// factors: what is left of χ², and ln det of what the factors add to the covariance. None of an
    /// operator that is not in rows.
    pub(super) fn deviance(&self) -> Option<f64> {
        let Form::Stacked { triangle, .. } = &self.form else {
            return None;
        };
        let Conditionals { frames, whole } = &self.gains;
        let of = [frames, whole].into_iter().flatten().map(|of| of.log_det);
        Some(triangle.rest * triangle.rest + of.sum::<f64>())
    }

    /// Covariance of the solution as the standard errors make it, whether or not the weights are
    /// theirs:
    ///
    /// > (KᵀWK)⁺ KᵀW Σ W K (KᵀWK)⁺ = Σ_kk' v_k (1/s_k) N_kk' (1/s_k') v_k'ᵀ,
    ///
    /// N that of [`Operator::noise`]. Where the weights are the entries' own it is (KᵀWK)⁺.
    pub(super) fn covariance(
        &self,
        problem: &Problem<'_>,
        solved: &LeastSquares,
    ) -> Option<DMatrix<f64>> {
        let towards = towards(solved);
        let noise = self.noise(problem, solved)?;
        Some(product(&product(&towards, &noise), &towards.transpose()))
    }

    /// Covariance of the data along the left singular vectors, as the standard errors make it, rank
    /// × rank:
    ///
    /// > N_kk' = Σ_pl u_k\[p,l\] u_k'\[p,l\] w_p v_l σ²\[p,l\],   u_k = √W K v_k/s_k as pixels × spots.
    ///
    /// The unit matrix where the weights are the entries' own; none without a noise model, and none
    /// for unweighted rows with glare patterns. C̃ = U T and D̃ = S V with few (c, d) orthonormal
    /// columns to rounding, so that the sums cost d·c·r·k + l·(p·c² + c·k·(d + c + k)) operations
    /// and not l·p·k·(r + k).
    pub(super) fn noise(
        &self,
        problem: &Problem<'_>,
        solved: &LeastSquares,
    ) -> Option<DMatrix<f64>> {
        let stderr = problem.noise()?;
        let Some(Sides { u, t, s, v }) = &self.sides else {
            return (self.weighting == Weighting::EntryByEntry)
                .then(|| DMatrix::identity(solved.rank, solved.rank));
        };
        let towards = towards(solved).select_rows(&self.element);
        // T diag(S_b) v_k/s_k of each direction b of the laser side, as columns.
        let (c, k) = (t.nrows(), solved.rank);
        let mut lit = DMatrix::zeros(c * k, s.ncols());
        for (b, mut target) in lit.column_iter_mut().enumerate() {
            let by_term = rows_times(towards.clone(), s.column(b).iter());
            target.copy_from_slice(product(t, &by_term).as_slice());
        }
        let mut sum = DMatrix::zeros(k, k);
        for l in 0..v.ncols() {
            let along = DMatrix::from_column_slice(c, k, (&lit * v.column(l)).as_slice());
            let errors: Vec<f64> = (0..u.nrows())
                .map(|p| self.weights.pixels[p] * self.weights.spots[l] * stderr[(p, l)])
                .collect();
            let noise = rows_times(u.clone(), &errors);
            let weighted = product(&tr_product(&noise, &noise), &along);
            sum += tr_product(&along, &weighted);
        }
        Some(sum)
    }

    /// Rows of the matrix that is decomposed, by which an automatic rank cut is scaled.
    pub(super) fn rows(&self) -> usize {
        match &self.form {
            Form::Small { rows, .. } => *rows,
            Form::Normal(_) => self.elements,
            Form::Stacked { rows, .. } => *rows,
        }
    }

    /// The tolerance that can be kept: a Gram matrix holds only rounding below √(r eps) σ₁.
    pub(super) fn tolerance(&self, asked: Tolerance) -> Tolerance {
        let floor = (self.elements as f64 * f64::EPSILON).sqrt();
        match (&self.form, asked) {
            (Form::Normal(_), Tolerance::Auto | Tolerance::Spacing) => Tolerance::Relative(floor),
            (Form::Normal(_), Tolerance::Relative(x)) if x < floor => Tolerance::Relative(floor),
            _ => asked,
        }
    }

    /// The minimum-norm solution, singular values cut at [`Operator::tolerance`].
    pub(super) fn solve(&self, tolerance: Tolerance) -> Result<Arc<LeastSquares>, RecoveryError> {
        if let (Tolerance::Auto, Some(known)) = (tolerance, self.solved.get()) {
            return Ok(Arc::clone(known));
        }
        let cut = self.tolerance(tolerance);
        let solved = match &self.form {
            Form::Small { a, b, .. } => least_squares(a, b, cut)?,
            Form::Normal(reduced) => reduced.solve(self.elements, cut, Route::Normal)?,
            Form::Stacked { triangle, rows, .. } => triangle.solve(*rows, cut, Route::Qr)?,
        };
        if solved.rank == 0 {
            return Err(RecoveryError::NO_DIRECTION);
        }
        let solved = Arc::new(solved);
        if tolerance == Tolerance::Auto {
            let _ = self.solved.set(Arc::clone(&solved));
        }
        Ok(solved)
    }

    /// The directions of the operator, U Σ Vᵀ, and Uᵀ times the data: Σ Vᵀ ρ against it is the same
    /// objective but for a constant.
    pub(super) fn directions(&self) -> Result<Arc<(Svd, DVector<f64>)>, RecoveryError> {
        if let Some(known) = self.directions.get() {
            return Ok(Arc::clone(known));
        }
        let found = Arc::new(self.decomposed()?);
        Ok(Arc::clone(self.directions.get_or_init(|| found)))
    }

    fn decomposed(&self) -> Result<(Svd, DVector<f64>), RecoveryError> {
        let reduced = match &self.form {
            Form::Small { a, b, .. } => match svd_of_range(a, Tolerance::Auto)? {
                Some(decomposed) => {
                    let data = decomposed.u.tr_mul(b);
                    return Ok((decomposed, data));
                }
                None => &triangle(a, b)?,
            },
            Form::Normal(reduced) => reduced,
            Form::Stacked { triangle, .. } => triangle,
        };
        let decomposed = svd_to(&reduced.r, Tolerance::Auto)?;
        let data = decomposed.u.tr_mul(&reduced.d);
        Ok((decomposed, data))
    }
}

#[cfg(test)]
mod tests;
