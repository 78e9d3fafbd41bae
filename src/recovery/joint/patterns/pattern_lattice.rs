//! Patterns of two levels as points of a lattice.
//!
//! A pattern p ∈ {0, 1}ⁿ of the dark level a and the contrast Δ is the picture a + Δ p, and
//!
//! > χ² = ‖d − a R 1 − Δ R p‖².
//!
//! With w² ‖p − ½‖² added, which is w² n/4 for every pattern and more for all other integers, the
//! patterns of a small χ² are the points of the lattice of Δ R over w 1 near a target (as in the
//! low-density subset sums of Coster, Joux, LaMacchia, Odlyzko, Schnorr and Stern 1992). Levels
//! that are not given are allowed for: a is projected out, and Δ known to a share ε is an error
//! along Δ R p, the light that a R 1 leaves of d. Where neighbours are alike to a degree β
//! ([`super::neighbours`]), s = 2 p − 1, so are points: −2 β Σ s_i s_j is 4 β Σ (p_i − p_j)² but
//! for a constant.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::num::control::Control;
use crate::num::lattice::Lattice;
use crate::recovery::RecoveryError;

/// Above this many elements patterns are not searched in lattices, whose reduction takes too long.
pub(super) const MOST: usize = 2048;
/// Points near a cell's target that are looked at, times n, and at least and at most.
const KEPT: usize = 25_600;
const FEWEST: usize = 200;
const MOST_KEPT: usize = 1000;
/// Largest light of a pattern, in standard deviations of the noise.
const MOST_LIGHT: f64 = 1e9;
/// Contrasts at most.
const MOST_STEPS: f64 = 100.0;
/// Cells that are reduced one from the other.
const CHAIN: usize = 6;

/// What is known of the dark level.
#[derive(Clone, Copy)]
pub(super) enum Dark {
    Given(f64),
    /// So many times the contrast.
    Times(f64),
    Free,
}

/// The patterns whose contrast is between two.
pub(super) struct Cell {
    pub(super) contrasts: [f64; 2],
    pub(super) lattice: Lattice,
}

/// R, d and what is known of the dark level.
#[derive(Clone, Copy)]
pub(super) struct PatternLattice<'a> {
    pub(super) r: &'a DMatrix<f64>,
    pub(super) d: &'a DVector<f64>,
    pub(super) dark: Dark,
    /// Neighbours and the degree β to which they are alike.
    pub(super) alike: (&'a [[usize; 2]], f64),
    pub(super) control: Control<'a>,
}

impl PatternLattice<'_> {
    /// w for which about a third of the integers drawn near a target are patterns: one of n that is
    /// beyond 0 and 1 costs w².
    pub(super) fn weight(&self) -> f64 {
        let n = self.r.ncols() as f64;
        libm::log(0.87 * n).max(1.0).sqrt()
    }

    /// Contrasts from where no pattern is told from another up to `top`, in steps of e^(2 ε).
    pub(super) fn contrasts(&self, top: f64, share: f64) -> Vec<f64> {
        let least = 1.0 / self.r.norm().max(2.0 / top);
        let steps = (libm::log(top / least) / (2.0 * share)).ceil();
        let steps = steps.clamp(1.0, MOST_STEPS) as usize;
        let at = |k: usize| top * libm::exp(-2.0 * share * ((steps - k) as f64 - 0.5));
        (0..steps).map(at).collect()
    }

    /// The cell of each contrast, ε about it, without those that are beyond double precision.
    pub(super) fn cells(
        &self,
        contrasts: &[f64],
        share: f64,
        weight: f64,
    ) -> Result<Vec<Cell>, RecoveryError> {
        self.each((contrasts, share), weight, |contrast, lattice| Cell {
            contrasts: [-share, share].map(|off| contrast * libm::exp(off)),
            lattice: lattice.clone(),
        })
    }

    /// Patterns of the points near the target of any of the same, in order; of integers beyond 0
    /// and 1 the pattern that is nearest.
    pub(super) fn near(
        &self,
        contrasts: &[f64],
        share: f64,
    ) -> Result<Vec<Vec<bool>>, RecoveryError> {
        let cut = |point: &Vec<f64>| point.iter().map(|z| *z > 0.5).collect();
        let of = |_, lattice: &Lattice| points(lattice).iter().map(cut).collect();
        Ok(in_order(self.each(
            (contrasts, share),
            self.weight(),
            of,
        )?))
    }

    /// Something of the lattice of each contrast.
    fn each<T: Send>(
        &self,
        (contrasts, share): (&[f64], f64),
        weight: f64,
        of: impl Fn(f64, &Lattice) -> T + Sync,
    ) -> Result<Vec<T>, RecoveryError> {
        let chains: Result<Vec<Vec<T>>, RecoveryError> = contrasts
            .par_chunks(CHAIN)
            .map(|chain| {
                let (mut found, mut near) = (Vec::with_capacity(chain.len()), None);
                for &contrast in chain {
                    self.control.check()?;
                    if let Some(own) = self.lattice(contrast, share, weight, near.as_ref())? {
                        found.push(of(contrast, &own));
                        near = Some(own);
                    }
                }
                Ok(found)
            })
            .collect();
        Ok(chains?.into_iter().flatten().collect())
    }

    /// The lattice at one contrast.
    fn lattice(
        &self,
        contrast: f64,
        share: f64,
        weight: f64,
        near: Option<&Lattice>,
    ) -> Result<Option<Lattice>, RecoveryError> {
        let (k, n) = self.r.shape();
        let all = self.r.column_sum();
        let dark = match self.dark {
            Dark::Given(level) => level,
            Dark::Times(ratio) => ratio * contrast,
            Dark::Free => 0.0,
        };
        let (mut own, mut target) = (self.r * contrast, self.d - &all * dark);
        // Of noise below what double precision holds, as if it were larger: more patterns are near.
        let less = (MOST_LIGHT / own.norm().max(1.0)).min(1.0);
        own *= less;
        target *= less;
        if matches!(self.dark, Dark::Free) {
            damp(&mut own, &mut target, &all, f64::INFINITY);
        }
        let along = match self.dark {
            Dark::Times(_) => self.d * less,
            _ => target.clone(),
        };
        let off = share * along.norm();
        damp(&mut own, &mut target, &along, off);
        let (pairs, beta) = self.alike;
        let mut basis = DMatrix::zeros(k + n + pairs.len(), n);
        basis.rows_mut(0, k).copy_from(&own);
        basis.rows_mut(k, n).fill_diagonal(weight);
        let tie = 2.0 * beta.sqrt();
        for (row, [a, b]) in pairs.iter().enumerate() {
            basis[(k + n + row, *a)] = tie;
            basis[(k + n + row, *b)] = -tie;
        }
        let target = DVector::from_fn(k + n + pairs.len(), |i, _| match i.checked_sub(k) {
            None => target[i],
            Some(i) if i < n => 0.5 * weight,
            Some(_) => 0.0,
        });
        Ok(Lattice::new(&basis, &target, near)?)
    }
}

/// Divides the part of A and b along a vector by √(1 + σ²), σ the error along it.
fn damp(a: &mut DMatrix<f64>, b: &mut DVector<f64>, along: &DVector<f64>, sigma: f64) {
    let length = along.norm();
    if length == 0.0 {
        return;
    }
    let unit = along / length;
    let less = 1.0 - 1.0 / 1f64.hypot(sigma);
    let parts = a.tr_mul(&unit) * less;
    a.ger(-1.0, &unit, &parts, 1.0);
    b.axpy(-less * unit.dot(b), &unit, 1.0);
}

/// The pattern of integers; none where one of them is neither 0 nor 1.
pub(super) fn pattern(point: &[f64]) -> Option<Vec<bool>> {
    let inside = point.iter().all(|z| (0.0..=1.0).contains(z));
    inside.then(|| point.iter().map(|z| *z > 0.5).collect())
}

/// Points near the target.
fn points(lattice: &Lattice) -> Vec<Vec<f64>> {
    lattice.nearest((KEPT / lattice.dimension()).clamp(FEWEST, MOST_KEPT))
}

/// The patterns among the points near the target of any cell, in order.
pub(super) fn nearest(cells: &[Cell]) -> Vec<Vec<bool>> {
    let patterns = |cell: &Cell| {
        let points = points(&cell.lattice);
        points.iter().filter_map(|point| pattern(point)).collect()
    };
    in_order(cells.par_iter().map(patterns).collect())
}

/// Each pattern once.
fn in_order(found: Vec<Vec<Vec<bool>>>) -> Vec<Vec<bool>> {
    let mut all: Vec<Vec<bool>> = found.into_iter().flatten().collect();
    all.sort_unstable();
    all.dedup();
    all
}
