//! Separable weights for least squares over pixels and spots.

use nalgebra::DMatrix;

use crate::recovery::{Problem, Weighting};

/// √w_p and √v_l with w_p v_l ≈ 1/σ²\[p,l\].
#[derive(Debug, Clone)]
pub(in crate::recovery::joint) struct Weights {
    pub(super) pixels: Vec<f64>,
    pub(super) spots: Vec<f64>,
    pub(super) weighting: Weighting,
}

/// Root mean square of ln σ about a term by pixel and one by spot, above which weights of that form
/// are not those of the noise; σ of 32 replicates scatters by 0.13.
const ROUGH: f64 = 0.25;

impl Weights {
    /// Whether they are not those of the noise.
    pub(super) fn are_rough(&self) -> bool {
        matches!(self.weighting, Weighting::Separable { misfit } if misfit > ROUGH)
    }

    /// 1/σ\[p,l\], where σ is known and not zero, else the separable fit; 0 of entries that do not
    /// count.
    pub(in crate::recovery::joint) fn root(
        &self,
        problem: &Problem<'_>,
        stderr: Option<&DMatrix<f64>>,
        p: usize,
        l: usize,
    ) -> f64 {
        match stderr.map(|s| s[(p, l)]) {
            _ if !problem.nuisance.counts(p, l) => 0.0,
            Some(s) if s > 0.0 => 1.0 / s,
            _ => self.pixels[p] * self.spots[l],
        }
    }
}

/// The rank-one fit of 1/σ² in the logarithm,
///
/// > ln σ\[p,l\] ≈ α_p + β_l in least squares,   √w_p = e^(−α_p),   √v_l = e^(−β_l),
///
/// which is the two-way table of row and column means: positive by construction, and unmoved by a
/// common factor in the estimated errors. Any positive weights leave the estimate unbiased; only
/// its efficiency depends on the fit. A standard error of exactly zero says nothing of the noise
/// level, so such entries are left out of the fit, and the means are iterated over what remains.
/// Without a noise model, or with an all-zero one, every weight is 1.
pub(in crate::recovery::joint) fn fit(
    stderr: Option<&DMatrix<f64>>,
    pixels: usize,
    spots: usize,
) -> Weights {
    let Some(stderr) = stderr.filter(|s| s.iter().any(|&x| x > 0.0)) else {
        return Weights {
            pixels: vec![1.0; pixels],
            spots: vec![1.0; spots],
            weighting: Weighting::Unweighted,
        };
    };
    let log = stderr.map(|s| if s > 0.0 { Some(libm::log(s)) } else { None });
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0u32), |(sum, count), x| (sum + x, count + 1));
        if count == 0 {
            None
        } else {
            Some(sum / f64::from(count))
        }
    };
    let level = mean(&mut log.iter().flatten().copied()).unwrap_or(0.0);
    let (mut alpha, mut beta) = (vec![level; pixels], vec![0.0; spots]);
    for _ in 0..200 {
        let before = (alpha.clone(), beta.clone());
        // Frame by frame, as they lie in memory.
        let mut sums = vec![(0.0, 0u32); pixels];
        for (l, b) in beta.iter().enumerate() {
            for ((sum, count), log) in sums.iter_mut().zip(log.column(l).iter()) {
                if let Some(log) = log {
                    *sum += log - b;
                    *count += 1;
                }
            }
        }
        for (a, (sum, count)) in alpha.iter_mut().zip(sums) {
            *a = if count > 0 {
                sum / f64::from(count)
            } else {
                level
            };
        }
        for (l, b) in beta.iter_mut().enumerate() {
            *b =
                mean(&mut (0..pixels).filter_map(|p| Some(log[(p, l)]? - alpha[p]))).unwrap_or(0.0);
        }
        let moved =
            |new: &[f64], old: &[f64]| new.iter().zip(old).any(|(x, y)| (x - y).abs() > 1e-12);
        if !moved(&alpha, &before.0) && !moved(&beta, &before.1) {
            break;
        }
    }
    let squares = &mut (0..pixels * spots).filter_map(|at| {
        let (p, l) = (at % pixels, at / pixels);
        Some((log[(p, l)]? - alpha[p] - beta[l]).powi(2))
    });
    let misfit = mean(squares).unwrap_or(0.0).sqrt();
    let root = |logs: Vec<f64>| logs.into_iter().map(|x| libm::exp(-x)).collect();
    Weights {
        pixels: root(alpha),
        spots: root(beta),
        weighting: Weighting::Separable { misfit },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_separable_noise_is_fitted_exactly() {
        let stderr = DMatrix::from_fn(5, 7, |p, l| {
            1e-15 * (1.0 + p as f64) * (2.0 + l as f64).sqrt()
        });
        let w = fit(Some(&stderr), 5, 7);
        let Weighting::Separable { misfit } = w.weighting else {
            panic!("{:?}", w.weighting)
        };
        assert!(misfit < 1e-13);
        for p in 0..5 {
            for l in 0..7 {
                assert!((w.pixels[p] * w.spots[l] * stderr[(p, l)] - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn zeros_are_left_out() {
        let mut stderr = DMatrix::from_fn(6, 4, |p, l| (1.0 + p as f64) * (1.0 + l as f64));
        let full = fit(Some(&stderr), 6, 4);
        stderr[(2, 1)] = 0.0;
        stderr[(5, 3)] = 0.0;
        let holed = fit(Some(&stderr), 6, 4);
        for p in 0..6 {
            assert!(
                (holed.pixels[p] * holed.spots[0] / (full.pixels[p] * full.spots[0]) - 1.0).abs()
                    < 1e-10
            );
        }
        stderr.row_mut(0).fill(0.0);
        assert!(
            fit(Some(&stderr), 6, 4)
                .pixels
                .iter()
                .all(|w| w.is_finite() && *w > 0.0)
        );
    }

    #[test]
    fn no_noise_model_weighs_all_alike() {
        for stderr in [None, Some(&DMatrix::zeros(2, 3))] {
            let w = fit(stderr, 2, 3);
            assert_eq!(
                (w.pixels, w.spots, w.weighting),
                (vec![1.0; 2], vec![1.0; 3], Weighting::Unweighted)
            );
        }
    }

    #[test]
    fn an_inseparable_noise_is_confessed() {
        // ln σ = ±a in a chessboard: row and column means vanish, the misfit is a.
        let stderr = DMatrix::from_fn(4, 4, |p, l| {
            libm::exp(if (p + l) % 2 == 0 { 0.3 } else { -0.3 })
        });
        assert!(
            matches!(fit(Some(&stderr), 4, 4).weighting, Weighting::Separable { misfit } if (misfit - 0.3).abs() < 1e-12)
        );
    }
}
