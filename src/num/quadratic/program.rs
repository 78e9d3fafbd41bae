//! What all problems of this floor have in common when the conic solver gets them.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSolver, IPSolver, SupportedConeT,
};
use nalgebra::DMatrix;

use super::QuadraticError;

/// A conic program whose first variables are x, each times the length of its column of R, and y,
/// one for each row of R, all over one unit. Its first rows say
///
/// > y − R x = …  (k rows),   −x ≤ …  (n rows),   x ≤ …  (a row for each finite upper bound).
pub(super) struct Program {
    /// Lengths of R's columns; 1 of an empty one.
    pub(super) lengths: Vec<f64>,
    /// Variables with a finite upper bound.
    pub(super) closed: Vec<usize>,
    row: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
}

impl Program {
    pub(super) fn new(r: &DMatrix<f64>, upper: &[f64]) -> Self {
        let (k, n) = r.shape();
        let length = |norm: f64| if norm > 0.0 { norm } else { 1.0 };
        let mut program = Self {
            lengths: r.column_iter().map(|c| length(c.norm())).collect(),
            closed: (0..n).filter(|&j| upper[j].is_finite()).collect(),
            row: Vec::new(),
            column: Vec::new(),
            value: Vec::new(),
        };
        for j in 0..n {
            for i in 0..k {
                program.put(i, j, -r[(i, j)] / program.lengths[j]);
            }
            program.put(k + j, j, -1.0);
        }
        for i in 0..program.closed.len() {
            program.put(k + n + i, program.closed[i], 1.0);
        }
        for i in 0..k {
            program.put(i, n + i, 1.0);
        }
        program
    }

    /// An entry of the constraints' matrix.
    pub(super) fn put(&mut self, row: usize, column: usize, value: f64) {
        if value != 0.0 {
            self.row.push(row);
            self.column.push(column);
            self.value.push(value);
        }
    }

    /// Solves min ½ vᵀ cost v + linearᵀ v with the constraints' matrix times v and `right` apart by
    /// a point of the cones.
    pub(super) fn solve(
        self,
        cost: &CscMatrix<f64>,
        linear: &[f64],
        right: &[f64],
        cones: &[SupportedConeT<f64>],
        settings: &mut DefaultSettingsBuilder<f64>,
    ) -> Result<DefaultSolver<f64>, QuadraticError> {
        let refused = |words: String| QuadraticError::Refused(words);
        let settings: DefaultSettings<f64> = settings
            .verbose(false)
            .max_threads(1)
            .build()
            .map_err(|e| refused(e.to_string()))?;
        let constraints = CscMatrix::new_from_triplets(
            right.len(),
            linear.len(),
            self.row,
            self.column,
            self.value,
        );
        let mut solver = DefaultSolver::new(cost, linear, &constraints, right, cones, settings)
            .map_err(|e| refused(e.to_string()))?;
        solver.solve();
        Ok(solver)
    }
}

/// ½ yᵀy as a cost, for n variables x, k of y and `more` after them.
pub(super) fn half_square(n: usize, k: usize, more: usize) -> CscMatrix<f64> {
    let on_y: Vec<usize> = (n..n + k).collect();
    let all = n + k + more;
    CscMatrix::new_from_triplets(all, all, on_y.clone(), on_y, vec![1.0; k])
}
