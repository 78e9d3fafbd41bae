use nalgebra::{DMatrix, DVector};

use super::*;
use crate::num::linalg::{Tolerance, pinv};
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::{Deviations, Nuisance, recover};

mod every_method;
mod of_all;
mod written_out;

/// A small bench: 4 elements between 0.2 and 0.7, 16 pixels, every tenth spot, errors of 2 %.
struct Small {
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    rho: DVector<f64>,
    stderr: DMatrix<f64>,
}

impl Small {
    fn new() -> Self {
        let bench = Bench::new(3.0, 2, 4);
        let rho = DVector::from_column_slice(&[0.3, 0.7, 0.6, 0.2]);
        let every: Vec<usize> = (0..12).map(|l| 10 * l).collect();
        let stderr = bench.phi(&rho).select_columns(&every) * 0.02;
        Self {
            d: bench.d.select_columns(&every),
            c: bench.c,
            rho,
            stderr,
        }
    }

    fn exact(&self) -> DMatrix<f64> {
        &self.c * DMatrix::from_diagonal(&self.rho) * &self.d
    }

    /// Photographs with noise and with factors of the frames and of all.
    fn drawn(&self, gain: f64, scale: f64, seed: u64) -> DMatrix<f64> {
        let mut normal = normal_stream(seed);
        let whole = 1.0 + scale * normal();
        let mut phi = self.exact() * whole;
        for mut frame in phi.column_iter_mut() {
            frame *= 1.0 + gain * normal();
        }
        phi.zip_map(&self.stderr, |x, s| x + s * normal())
    }

    fn problem<'a>(&'a self, phi: &'a DMatrix<f64>, nuisance: Nuisance<'a>) -> Problem<'a> {
        let problem = Problem::new(phi, &self.c, &self.d, Some(&self.stderr)).unwrap();
        let problem = problem.with_grids(&[[2, 2]]).unwrap();
        problem.with_nuisance(nuisance).unwrap()
    }

    /// The minimum of Σ z² + Σ ε_l²/σ_g² + ε²/σ_s² over x, ε and the strengths of patterns (pixels
    /// × patterns, of each frame), and the inverse of half its Hessian in Gauss and Newton's form:
    /// all rows and columns written out, from the truth, by the pseudo-inverse.
    fn brute(
        &self,
        phi: &DMatrix<f64>,
        patterns: &DMatrix<f64>,
        background: bool,
        [gain, scale]: [Option<f64>; 2],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let (pixels, spots) = phi.shape();
        let n = self.rho.len();
        let (k, a) = (patterns.ncols(), if background { pixels } else { 0 });
        let [gains, whole] = [n, n + if gain.is_some() { spots } else { 0 }];
        let others = whole + usize::from(scale.is_some());
        let all = others + k * spots + a;
        let mut u = DVector::zeros(all);
        u.rows_mut(0, n).copy_from(&self.rho);
        let priors: Vec<(usize, f64)> = (gains..whole)
            .map(|i| (i, gain.unwrap()))
            .chain(scale.map(|s| (whole, s)))
            .collect();
        // Unit of the other light.
        let unit = phi.mean();
        let mut covariance = DMatrix::zeros(all, all);
        for _ in 0..40 {
            let rows = pixels * spots + priors.len();
            let mut j = DMatrix::zeros(rows, all);
            let mut left = DVector::zeros(rows);
            for row in 0..pixels * spots {
                let (p, l) = (row % pixels, row / pixels);
                let one = |e: Option<usize>| e.map_or(1.0, |i| 1.0 + u[i]);
                let own = gain.map(|_| gains + l);
                let all = scale.map(|_| whole);
                let light: f64 = (0..n).map(|i| self.c[(p, i)] * u[i] * self.d[(i, l)]).sum();
                let mut seen = one(own) * one(all) * light;
                for i in 0..n {
                    j[(row, i)] = one(own) * one(all) * self.c[(p, i)] * self.d[(i, l)];
                }
                if let Some(own) = own {
                    j[(row, own)] = one(all) * light;
                }
                if let Some(all) = all {
                    j[(row, all)] = one(own) * light;
                }
                for i in 0..k {
                    j[(row, others + l * k + i)] = unit * patterns[(p, i)];
                    seen += unit * patterns[(p, i)] * u[others + l * k + i];
                }
                if background {
                    j[(row, others + k * spots + p)] = unit;
                    seen += unit * u[others + k * spots + p];
                }
                let weight = 1.0 / self.stderr[(p, l)];
                j.row_mut(row).scale_mut(weight);
                left[row] = weight * (phi[(p, l)] - seen);
            }
            for (at, (i, known)) in priors.iter().enumerate() {
                j[(pixels * spots + at, *i)] = 1.0 / known;
                left[pixels * spots + at] = -u[*i] / known;
            }
            let inverse = pinv(&j, Tolerance::Relative(1e-9)).unwrap().matrix;
            u += &inverse * left;
            covariance = &inverse * inverse.transpose();
        }
        (u, covariance)
    }
}

fn near(found: f64, expected: f64, to: f64) -> bool {
    (found - expected).abs() <= to * expected.abs()
}

fn gains(found: &Recovered) -> &Gains {
    found.nuisance.as_ref().unwrap().gains.as_ref().unwrap()
}

/// Numbers between 0 and 1, all as likely.
fn levels(seed: u64) -> impl FnMut() -> f64 {
    let mut normal = normal_stream(seed);
    move || 0.5 * libm::erfc(-normal() / 2f64.sqrt())
}
