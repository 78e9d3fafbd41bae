//! The weighted rows of all pixels and spots, block after block, for weights or nuisance terms that
//! no product of two sides holds.
//!
//! Row (p, l) is √w\[p,l\] · (nuisance columns | C\[p,j\] D\[j,l\] | Φ\[p,l\]) with a weight of its
//! own. The rows are never all held: a block of them is reduced by Householder QR, its nuisance
//! columns are eliminated, and the triangles are stacked and reduced again (TSQR). Condition is
//! never squared. Elimination is the QR with the nuisance columns first: the rows below theirs hold
//! what no nuisance can change, for any size of it. Nuisance columns that depend on each other (a
//! pattern that is constant over the frame beside a frame constant) are told by the singular values
//! of their own corner, columns scaled to unit length, and only what they span is eliminated.
//!
//! Without a background the blocks are frames, whose constant and glare concern that frame alone.
//! With one the blocks are pixels, whose background concerns that pixel alone; the terms of all
//! frames are then carried along and eliminated from the last triangle. Memory: one block and two
//! triangles of elements (and, with a background, of the terms of all frames).

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{Triangle, columns_over, svd, triangle};
use crate::recovery::{Problem, RecoveryError};

/// Singular values of unit nuisance columns at or below this count as zero: some thousand
/// roundings.
const DEPENDENT: f64 = 1e-12;

/// ‖data − …‖ after elimination: ‖R ρ − d‖² + rest².
pub(super) struct Stacked {
    pub(super) triangle: Triangle,
    /// Present where a background ties the terms of all frames together.
    pub(super) coupled: Option<Coupled>,
}

/// The terms of the frames as they follow from ρ.
#[derive(Debug)]
pub(super) struct Coupled {
    /// Their pseudo-inverse, in their own unit, times the rows they were eliminated with.
    inverse: DMatrix<f64>,
    along: DMatrix<f64>,
    data: DVector<f64>,
}

impl Coupled {
    /// b_l (if estimated), then g_l (if estimated).
    pub(super) fn solve(&self, rho: &DVector<f64>) -> DVector<f64> {
        &self.inverse * (&self.data - &self.along * rho)
    }
}

/// Stacks and reduces; `root`(p, l) is the square root of the weight.
pub(super) fn stack(
    problem: &Problem<'_>,
    root: impl Fn(usize, usize) -> f64,
) -> Result<Stacked, RecoveryError> {
    let (pixels, spots) = problem.phi.shape();
    let elements = problem.elements();
    let (c, d, element) = problem.sides();
    let mut terms: Vec<Vec<usize>> = vec![Vec::new(); elements];
    element
        .iter()
        .enumerate()
        .for_each(|(s, j)| terms[*j].push(s));
    let nuisance = &problem.nuisance;
    let pattern = |p: usize, l: usize| nuisance.glare.map_or(0.0, |m| m[(p, l)]);
    let data = |p: usize, l: usize, j: usize| {
        root(p, l)
            * if j < elements {
                terms[j].iter().map(|s| c[(p, *s)] * d[(*s, l)]).sum()
            } else {
                problem.phi[(p, l)]
            }
    };
    let patterns = &nuisance.of_frames(pixels);
    // A frame's own columns: value at (p, l), and the length over the frame.
    let mut own: Vec<Box<dyn Fn(usize, usize) -> f64 + '_>> = Vec::new();
    for k in 0..patterns.ncols() {
        let root = &root;
        own.push(Box::new(move |p, l| root(p, l) * patterns[(p, k)]));
    }
    if nuisance.glare.is_some() {
        own.push(Box::new(|p, l| root(p, l) * pattern(p, l)));
    }
    let lengths: Vec<Vec<f64>> = own
        .iter()
        .map(|value| {
            let length = |l| (0..pixels).map(|p| value(p, l).powi(2)).sum::<f64>().sqrt();
            (0..spots)
                .map(|l| if length(l) > 0.0 { length(l) } else { 1.0 })
                .collect()
        })
        .collect();
    let kinds = own.len();
    if !nuisance.background {
        let mut rows = Rows::new(elements + 1);
        let frame = |l: usize| {
            DMatrix::from_fn(pixels, kinds + elements + 1, |p, k| match own.get(k) {
                Some(value) => value(p, l) / lengths[k][l],
                None => data(p, l, k - kinds),
            })
        };
        for block in (0..spots).map(frame) {
            rows.push(eliminate(&reduce(&block)?.joined(), kinds)?.remaining)?;
        }
        return Ok(Stacked {
            triangle: rows.finish()?,
            coupled: None,
        });
    }
    let own_terms = kinds * spots;
    let mut rows = Rows::new(own_terms + elements + 1);
    for p in 0..pixels {
        let length = (0..spots).map(|l| root(p, l).powi(2)).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        let block = DMatrix::from_fn(spots, 1 + own_terms + elements + 1, |l, k| match k {
            0 => root(p, l) / length,
            k if k <= own_terms => match ((k - 1) / spots, (k - 1) % spots) {
                (kind, of) if of == l => own[kind](p, l) / lengths[kind][l],
                _ => 0.0,
            },
            k => data(p, l, k - 1 - own_terms),
        });
        rows.push(eliminate(&reduce(&block)?.joined(), 1)?.remaining)?;
    }
    let Eliminated {
        remaining,
        inverse,
        top,
    } = eliminate(&rows.finish()?.joined(), own_terms)?;
    let mut last = Rows::new(elements + 1);
    last.push(remaining)?;
    let coupled = (own_terms > 0).then(|| Coupled {
        inverse: DMatrix::from_fn(own_terms, inverse.ncols(), |k, i| {
            inverse[(k, i)] / lengths[k / spots][k % spots]
        }),
        along: top.columns(0, elements).into_owned(),
        data: top.column(elements).into_owned(),
    });
    Ok(Stacked {
        triangle: last.finish()?,
        coupled,
    })
}

/// Rows not yet reduced, last column the data.
struct Rows {
    columns: usize,
    held: Vec<DMatrix<f64>>,
    count: usize,
}

impl Rows {
    fn new(columns: usize) -> Self {
        Rows {
            columns,
            held: Vec::new(),
            count: 0,
        }
    }

    fn push(&mut self, block: DMatrix<f64>) -> Result<(), RecoveryError> {
        self.count += block.nrows();
        self.held.push(block);
        if self.count > 4 * self.columns {
            let reduced = reduce(&self.stacked())?.joined();
            self.count = reduced.nrows();
            self.held = vec![reduced];
        }
        Ok(())
    }

    fn stacked(&self) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.count, self.columns);
        let mut at = 0;
        for block in &self.held {
            all.rows_mut(at, block.nrows()).copy_from(block);
            at += block.nrows();
        }
        all
    }

    fn finish(self) -> Result<Triangle, RecoveryError> {
        if self.count == 0 {
            return Err(RecoveryError::RankZero {
                side: "model beside its nuisance terms",
            });
        }
        reduce(&self.stacked())
    }
}

/// The triangle of a block, whose last column is the data.
fn reduce(block: &DMatrix<f64>) -> Result<Triangle, RecoveryError> {
    let last = block.ncols() - 1;
    let a = block.columns(0, last).into_owned();
    Ok(triangle(&a, &block.column(last).into_owned())?)
}

/// Rows of a triangle after its first columns were taken out.
struct Eliminated {
    /// Those that the first columns cannot change.
    remaining: DMatrix<f64>,
    /// The pseudo-inverse of the first columns on the others,
    inverse: DMatrix<f64>,
    /// and the others.
    top: DMatrix<f64>,
}

/// Takes the first `lead` columns out.
fn eliminate(rows: &DMatrix<f64>, lead: usize) -> Result<Eliminated, RecoveryError> {
    let others = rows.ncols() - lead;
    let top = lead.min(rows.nrows());
    if top == 0 {
        return Ok(Eliminated {
            remaining: rows.clone(),
            inverse: DMatrix::zeros(0, 0),
            top: DMatrix::zeros(0, others),
        });
    }
    let corner = svd(&rows.view((0, 0), (top, lead)).into_owned())?;
    let rank = corner.sigma.iter().take_while(|&&s| s > DEPENDENT).count();
    let turned = corner.u.transpose() * rows.view((0, lead), (top, others));
    let mut remaining = DMatrix::zeros(rows.nrows() - rank, others);
    remaining
        .rows_mut(0, top - rank)
        .copy_from(&turned.rows(rank, top - rank));
    remaining
        .rows_mut(top - rank, rows.nrows() - top)
        .copy_from(&rows.view((top, lead), (rows.nrows() - top, others)));
    Ok(Eliminated {
        remaining,
        inverse: columns_over(corner.vt.rows(0, rank).transpose(), &corner.sigma),
        top: turned.rows(0, rank).into_owned(),
    })
}
