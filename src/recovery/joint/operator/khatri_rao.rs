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
//! ([`super::gram`]); with glare patterns there is no such product, and the rows are stacked
//! instead ([`super::stacked`]), each with its own weight. Both are done of fewer elements too,
//! where the noise is no product of a factor by pixel and one by spot. Stacked are those of a
//! single photograph of many pixels as well, which is a column of its own and nothing to compress:
//! no copy of C is held.

use std::sync::{Arc, OnceLock};

use nalgebra::{DMatrix, DVector};

use super::conditional::Conditional;
use super::elimination::{directions, unit, without_left, without_right};
use super::gram;
use super::sides::Sides;
use super::stacked::{Coupled, Stacked, stack};
use super::weights::{self, Weights};
use crate::num::linalg::{
    Gram, LeastSquares, Route, Svd, Tolerance, Triangle, least_squares, normal_triangle,
    pivoted_triangle, product, svd_of_range, svd_to, tr_product, triangle,
};
use crate::recovery::{Options, Problem, RecoveryError, WeightRule, Weighting};

/// Elements whose Gram matrix (and its few copies) is still formed: 512 MiB each.
const MOST_ELEMENTS: usize = 8192;

/// Elements up to which the operator is compressed to rounding, whatever the noise; of more, where
/// the noise is known, to what it leaves.
const FEW: usize = 512;

/// Multiplications of a QR of all rows, at most, where weights by pixel and by spot are those of
/// the noise, and where they are not.
const MOST_STACKED: [f64; 2] = [1e9, 1e11];

/// Pixels from which on a QR blurs the singular values, by 4e-14 σ₁ (measured), less than the
/// entries' own rounding, p·eps σ₁, at which they are cut.
const TALL: usize = 512;

/// The problem after compression.
#[derive(Debug)]
pub(in crate::recovery::joint) struct Operator {
    form: Form,
    elements: usize,
    /// The element of each term of the sides.
    element: Vec<usize>,
    weights: Weights,
    gains: Conditionals,
    sides: Option<Sides>,
    pub(in crate::recovery::joint) weighting: Weighting,
    /// Kept from the first time they are asked for.
    directions: OnceLock<Arc<(Svd, DVector<f64>)>>,
    solved: OnceLock<Arc<LeastSquares>>,
}

/// The noise by which entries are weighted.
fn known<'a>(problem: &Problem<'a>, options: &Options) -> Option<&'a DMatrix<f64>> {
    let weighted = options.weighting != WeightRule::Unweighted;
    problem.noise().filter(|_| weighted)
}

/// Whether it is one photograph of many pixels, its weights those of its noise if that is known:
/// then the covariance needs no left singular vectors, pixels × rank.
fn is_tall(problem: &Problem<'_>, known: Option<&DMatrix<f64>>) -> bool {
    let (pixels, spots) = problem.phi.shape();
    let own = |stderr: &DMatrix<f64>| known.is_some() && stderr.iter().all(|x| *x > 0.0);
    spots == 1
        && pixels >= TALL.max(problem.elements() + 1)
        && !problem.nuisance.background
        && problem.noise().is_none_or(own)
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
pub(in crate::recovery::joint) fn gathered(
    element: &[usize],
    rows: &DMatrix<f64>,
    elements: usize,
) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(elements, rows.ncols());
    for (s, j) in element.iter().enumerate() {
        let mut sum = sums.row_mut(*j);
        sum += rows.row(s);
    }
    sums
}

/// The operator of the problem, that of an earlier call where the problem shares them.
pub(in crate::recovery::joint) fn operator(
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
        let rough = weights.are_rough();
        let by_entry = elements > FEW || options.weighting == WeightRule::Entries;
        let holed = problem.nuisance.left_out.is_some() || problem.soft.is_some();
        let by_entry = known.is_some() && (by_entry || holed || rough);
        // Where the noise is less than the rounding of the normal equations.
        let work = (pixels * spots * elements * elements) as f64;
        let ties = problem.nuisance.background && !rough;
        let all_rows = by_entry && !ties && work <= MOST_STACKED[usize::from(rough)];
        let root = |p: usize, l: usize| weights.root(problem, known, p, l);
        let reduced = if by_entry {
            gram::reduced(problem, root)?
        } else {
            None
        };
        let by_rows = match reduced {
            Some(stacked) => Some((stacked.triangle.r.nrows(), stacked)),
            None if problem.nuisance.glare.is_some()
                || holed
                || all_rows
                || is_tall(problem, known) =>
            {
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
                let lost = gram::lost(problem, [along, grey, square]);
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

    /// −2 ln of the density of the data at the x that fits best, but for a constant that holds for
    /// all factors: what is left of χ², and ln det of what the factors add to the covariance. None
    /// of an operator that is not in rows.
    pub(in crate::recovery::joint) fn deviance(&self) -> Option<f64> {
        let Form::Stacked { triangle, .. } = &self.form else {
            return None;
        };
        let Conditionals { frames, whole } = &self.gains;
        let of = [frames, whole].into_iter().flatten().map(|of| of.log_det);
        Some(triangle.rest * triangle.rest + of.sum::<f64>())
    }

    /// Rows of the matrix that is decomposed, by which an automatic rank cut is scaled.
    pub(in crate::recovery::joint) fn rows(&self) -> usize {
        match &self.form {
            Form::Small { rows, .. } => *rows,
            Form::Normal(_) => self.elements,
            Form::Stacked { rows, .. } => *rows,
        }
    }

    /// The tolerance that can be kept: a Gram matrix holds only rounding below √(r eps) σ₁.
    pub(in crate::recovery::joint) fn tolerance(&self, asked: Tolerance) -> Tolerance {
        let floor = (self.elements as f64 * f64::EPSILON).sqrt();
        match (&self.form, asked) {
            (Form::Normal(_), Tolerance::Auto | Tolerance::Spacing) => Tolerance::Relative(floor),
            (Form::Normal(_), Tolerance::Relative(x)) if x < floor => Tolerance::Relative(floor),
            _ => asked,
        }
    }

    /// The minimum-norm solution, singular values cut at [`Operator::tolerance`].
    pub(in crate::recovery::joint) fn solve(
        &self,
        tolerance: Tolerance,
    ) -> Result<Arc<LeastSquares>, RecoveryError> {
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
    pub(in crate::recovery::joint) fn directions(
        &self,
    ) -> Result<Arc<(Svd, DVector<f64>)>, RecoveryError> {
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

mod errors;
#[cfg(test)]
mod tests;
