//! What a frame or a block of pixels says of the geometry where only the others are fitted.
//!
//! With picture and geometry fitted to it as well it seems to say less than it does. Without group
//! c of m the estimate is, to first order (Cook 1977; CR3 of MacKinnon and White 1985),
//!
//! > θ − θ_(c) = (F + Λ)⁻¹ B⊥_cᵀ (1 − H_c)⁻¹ r_c,   H_c = G Gᵀ,   G = (A P^½  B⊥ (F + Λ)^−½)_c
//!
//! with r_c what is left of the group: H_c is what of it the fit takes. (1 − G Gᵀ)⁻¹ r = r + G (1 −
//! GᵀG)⁻¹ Gᵀ r.

use nalgebra::DVector;
use rayon::prelude::*;

use super::descent::{Problem, State};
use super::geometry::Light;
use super::posterior::Columns;
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::num::linalg::{Cholesky, product, tr_product};

/// Pixels are put in so many blocks a side, to see whether errors hang together.
const BLOCKS: usize = 4;

/// What is left out together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    Frame,
    /// Of pixels, in all frames.
    Block,
}

/// What the rows of a group say: r, B⊥ and G.
struct Rows {
    left: DVector<f64>,
    b: Matrix,
    fitted: Matrix,
}

/// B⊥ᵀr, Gᵀr, GᵀG and B⊥ᵀG of a group.
struct Told {
    score: DVector<f64>,
    back: DVector<f64>,
    taken: Matrix,
    cross: Matrix,
}

impl Problem<'_> {
    /// √((m − 1)/m) B⊥_cᵀ (1 − H_c)⁻¹ r_c of every group, unknowns × groups; of one that alone
    /// tells something its score as it is.
    pub(super) fn left_out(
        &self,
        best: &State,
        (light, columns): (&Light, &[Columns]),
        information: &Cholesky,
        group: Group,
    ) -> Result<Matrix, LabError> {
        let (seen, rho) = (self.seen(best.factor), &best.value.rho);
        let half = best.value.factor.forward(best.prior.root.transpose());
        let rows = |(l, own): (usize, &Columns)| -> Result<Rows, LabError> {
            let [y, a] = seen.frame(light, l)?;
            let b = &own.b - product(&a, &best.slope.shift);
            let of_picture = product(&a, &half.transpose());
            let of_geometry = information.forward(b.transpose()).transpose();
            Ok(Rows {
                left: y.column(0) - &a * rho,
                fitted: beside(&of_picture, &of_geometry),
                b,
            })
        };
        let scores: Vec<DVector<f64>> = match group {
            Group::Frame => {
                let of = |frame| Ok(rows(frame)?.told().without());
                let frames = columns.par_iter().enumerate().map(of);
                frames.collect::<Result<_, LabError>>()?
            }
            Group::Block => {
                let pixels = self.photographs.phi.nrows();
                let blocks = blocks(pixels, self.geometry.scene.camera.columns);
                let mut told: Vec<Option<Told>> = blocks.iter().map(|_| None).collect();
                for frame in columns.iter().enumerate() {
                    let rows = rows(frame)?;
                    told.par_iter_mut().zip(&blocks).for_each(|(all, block)| {
                        let own = rows.of(block).told();
                        *all = Some(match all.take() {
                            Some(all) => all.with(&own),
                            None => own,
                        });
                    });
                }
                told.into_iter().flatten().map(Told::without).collect()
            }
        };
        let m = scores.len() as f64;
        Ok(Matrix::from_columns(&scores) * ((m - 1.0) / m).sqrt())
    }
}

/// The pixels of each block that has any.
fn blocks(pixels: usize, columns: usize) -> Vec<Vec<usize>> {
    let rows = pixels / columns;
    let block = |p: usize| {
        let [i, j] = [p % columns * BLOCKS / columns, p / columns * BLOCKS / rows];
        i + j * BLOCKS
    };
    let of = |own: usize| (0..pixels).filter(|p| block(*p) == own).collect();
    let all = (0..BLOCKS * BLOCKS).map(of);
    all.filter(|own: &Vec<usize>| !own.is_empty()).collect()
}

impl Rows {
    /// Some of them.
    fn of(&self, rows: &[usize]) -> Self {
        Self {
            left: self.left.select_rows(rows),
            b: self.b.select_rows(rows),
            fitted: self.fitted.select_rows(rows),
        }
    }

    fn told(&self) -> Told {
        Told {
            score: self.b.tr_mul(&self.left),
            back: self.fitted.tr_mul(&self.left),
            taken: tr_product(&self.fitted, &self.fitted),
            cross: tr_product(&self.b, &self.fitted),
        }
    }
}

impl Told {
    fn with(self, other: &Self) -> Self {
        Self {
            score: self.score + &other.score,
            back: self.back + &other.back,
            taken: self.taken + &other.taken,
            cross: self.cross + &other.cross,
        }
    }

    /// B⊥ᵀ (1 − H)⁻¹ r.
    fn without(self) -> DVector<f64> {
        let kept = Matrix::identity(self.back.len(), self.back.len()) - self.taken;
        match Cholesky::new(&kept) {
            Some(kept) => self.score + self.cross * kept.solve(&self.back),
            None => self.score,
        }
    }
}

/// The columns of both.
fn beside(a: &Matrix, b: &Matrix) -> Matrix {
    let all: Vec<_> = a.column_iter().chain(b.column_iter()).collect();
    Matrix::from_columns(&all)
}
