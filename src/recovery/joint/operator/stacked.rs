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
//! frames are then carried along and eliminated from the last triangle. Factors of the frames that
//! are known to a standard deviation w are eliminated after all others, softly
//! ([`super::conditional`]); beside a background as columns with one more row each, 0 = ε_l/w. A
//! tall frame is reduced strip by strip, each below the triangle of those before. Memory: some
//! triangles of elements (and, with a background, of the terms of all frames), whatever the pixels.

use nalgebra::{DMatrix, DVector};

use super::conditional::{Conditional, One, soften, soften_whole};
use crate::num::linalg::{Triangle, columns_over, svd, triangle_of};
use crate::recovery::{Problem, RecoveryError};

/// Pixels of a strip, if there are not more columns.
const STRIP: usize = 512;
/// Singular values of unit nuisance columns at or below this count as zero: some thousand
/// roundings.
const DEPENDENT: f64 = 1e-12;

/// ‖data − …‖ after elimination: ‖R ρ − d‖² + rest².
pub(in crate::recovery::joint) struct Stacked {
    pub(in crate::recovery::joint) triangle: Triangle,
    /// Present where a background ties the terms of all frames together.
    pub(super) coupled: Option<Coupled>,
    /// The frames' factors as they follow from x, where they are known roughly,
    pub(super) frames: Option<Conditional>,
    /// and the one of all.
    pub(super) whole: Option<Conditional>,
}

/// The terms of the frames as they follow from ρ.
#[derive(Debug)]
pub(super) struct Coupled {
    /// Their pseudo-inverse, in their own unit, times the rows they were eliminated with.
    inverse: DMatrix<f64>,
    along: DMatrix<f64>,
    /// The same of the frames' factors, where there are any.
    along_gains: DMatrix<f64>,
    data: DVector<f64>,
}

impl Coupled {
    /// b_l (if estimated), then g_l (if estimated), given ρ and the factors of the frames.
    pub(super) fn solve(&self, rho: &DVector<f64>, gains: Option<&DVector<f64>>) -> DVector<f64> {
        let mut left = &self.data - &self.along * rho;
        if let Some(gains) = gains {
            left -= &self.along_gains * gains;
        }
        &self.inverse * left
    }
}

/// Stacks and reduces; `root`(p, l) is the square root of the weight.
pub(in crate::recovery::joint) fn stack(
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
    let root = &root;
    for k in 0..patterns.ncols() {
        own.push(Box::new(move |p, l| root(p, l) * patterns[(p, k)]));
    }
    if let Some(glare) = nuisance.glare {
        own.push(Box::new(move |p, l| root(p, l) * glare[(p, l)]));
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
    let soft = problem.soft.and_then(|soft| {
        let (pattern, known_to) = soft.frames.as_ref()?;
        Some((pattern, known_to / soft.noise))
    });
    if !nuisance.background {
        let mut rows = Rows::new(elements + 1);
        let frame = |l: usize| {
            let gain = usize::from(soft.is_some());
            by_strips(pixels, kinds + gain + elements + 1, |p, k| {
                match (own.get(k), soft) {
                    (Some(value), _) => value(p, l) / lengths[k][l],
                    (None, Some((pattern, _))) if k == kinds => root(p, l) * pattern[(p, l)],
                    (None, _) => data(p, l, k - kinds - gain),
                }
            })
        };
        let mut gains: Vec<One> = Vec::new();
        for reduced in (0..spots).map(frame) {
            let mut left = eliminate(&reduced?, kinds)?.remaining;
            if let Some((_, width)) = soft {
                let pattern = left.column(0).into_owned();
                left = left.remove_column(0);
                gains.push(soften(&mut left, &pattern.as_view(), width));
            }
            rows.push(left)?;
        }
        let mut triangle = rows.finish()?;
        return Ok(Stacked {
            whole: soften_whole(&mut triangle, problem.soft),
            triangle,
            coupled: None,
            frames: soft.map(|_| Conditional::of(&gains)),
        });
    }
    let own_terms = kinds * spots;
    let gains = if soft.is_some() { spots } else { 0 };
    let mut rows = Rows::new(own_terms + gains + elements + 1);
    for p in 0..pixels {
        let length = (0..spots).map(|l| root(p, l).powi(2)).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        let all = 1 + own_terms + gains + elements + 1;
        let block = DMatrix::from_fn(spots, all, |l, k| match k {
            0 => root(p, l) / length,
            k if k <= own_terms => match ((k - 1) / spots, (k - 1) % spots) {
                (kind, of) if of == l => own[kind](p, l) / lengths[kind][l],
                _ => 0.0,
            },
            k if k <= own_terms + gains => match soft {
                Some((pattern, _)) if k - 1 - own_terms == l => root(p, l) * pattern[(p, l)],
                _ => 0.0,
            },
            k => data(p, l, k - 1 - own_terms - gains),
        });
        rows.push(eliminate(&reduce(block)?, 1)?.remaining)?;
    }
    let Eliminated {
        remaining,
        inverse,
        top,
    } = eliminate(&rows.finish()?.joined(), own_terms)?;
    let (remaining, frames) = match soft {
        Some((_, width)) => {
            let (remaining, frames) = eliminate_softly(remaining, spots, width)?;
            (remaining, Some(frames))
        }
        None => (remaining, None),
    };
    let mut last = Rows::new(elements + 1);
    last.push(remaining)?;
    let coupled = (own_terms > 0).then(|| Coupled {
        inverse: DMatrix::from_fn(own_terms, inverse.ncols(), |k, i| {
            inverse[(k, i)] / lengths[k / spots][k % spots]
        }),
        along: top.columns(gains, elements).into_owned(),
        along_gains: top.columns(0, gains).into_owned(),
        data: top.column(gains + elements).into_owned(),
    });
    let mut triangle = last.finish()?;
    Ok(Stacked {
        whole: soften_whole(&mut triangle, problem.soft),
        triangle,
        coupled,
        frames,
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
            let reduced = reduce(self.stacked())?;
            self.count = reduced.nrows();
            self.held = vec![reduced];
        }
        Ok(())
    }

    /// All that are held, which are held no more.
    fn stacked(&mut self) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.count, self.columns);
        let mut at = 0;
        for block in self.held.drain(..) {
            all.rows_mut(at, block.nrows()).copy_from(&block);
            at += block.nrows();
        }
        all
    }

    fn finish(mut self) -> Result<Triangle, RecoveryError> {
        if self.count == 0 {
            return Err(RecoveryError::TakenUp);
        }
        Ok(triangle_of(self.stacked())?)
    }
}

/// The triangle of a block, whose last column is the data.
fn reduce(block: DMatrix<f64>) -> Result<DMatrix<f64>, RecoveryError> {
    Ok(triangle_of(block)?.joined())
}

/// The triangle of rows × columns, the last the data, from what is at (row, column): strip by
/// strip.
fn by_strips(
    rows: usize,
    columns: usize,
    at: impl Fn(usize, usize) -> f64,
) -> Result<DMatrix<f64>, RecoveryError> {
    let most = STRIP.max(columns);
    let mut above = DMatrix::zeros(0, columns);
    for first in (0..rows).step_by(most) {
        let known = above.nrows();
        let strip = most.min(rows - first);
        let block = DMatrix::from_fn(known + strip, columns, |i, k| match i.checked_sub(known) {
            None => above[(i, k)],
            Some(i) => at(first + i, k),
        });
        above = reduce(block)?;
    }
    Ok(above)
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

/// Takes the first `lead` columns out, whose sizes are known to be N(0, width²): with a row
/// 0 = ε/width of each. What remains, and the sizes given the others.
fn eliminate_softly(
    rows: DMatrix<f64>,
    lead: usize,
    width: f64,
) -> Result<(DMatrix<f64>, Conditional), RecoveryError> {
    let (seen, columns) = rows.shape();
    let lengths: Vec<f64> = (0..lead)
        .map(|l| (rows.column(l).norm_squared() + 1.0 / (width * width)).sqrt())
        .collect();
    let all = DMatrix::from_fn(seen + lead, columns, |i, k| {
        let own = match i.checked_sub(seen) {
            None => rows[(i, k)],
            Some(l) if l == k => 1.0 / width,
            Some(_) => 0.0,
        };
        own / lengths.get(k).unwrap_or(&1.0)
    });
    let whole = reduce(all)?;
    let corner = svd(&whole.view((0, 0), (lead, lead)).into_owned())?;
    let logs = corner.sigma.iter().map(|s| 2.0 * libm::log(*s));
    let of_lengths = lengths.iter().map(|x| 2.0 * libm::log(x * width));
    let log_det = logs.sum::<f64>() + of_lengths.sum::<f64>();
    let Eliminated {
        remaining,
        inverse,
        top,
    } = eliminate(&whole, lead)?;
    let inverse = DMatrix::from_fn(lead, inverse.ncols(), |l, i| inverse[(l, i)] / lengths[l]);
    let n = columns - lead - 1;
    let frames = Conditional {
        at_zero: &inverse * top.column(n),
        slope: &inverse * top.columns(0, n),
        variance: DVector::from_fn(lead, |l, _| inverse.row(l).norm_squared()),
        log_det,
    };
    Ok((remaining, frames))
}
