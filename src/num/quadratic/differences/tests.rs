use super::super::box_least_squares;
use super::*;

#[test]
fn two_values_approach_each_other_by_the_penalty() {
    // min ½(x − 0.2)² + ½(y − 0.8)² + λ|x − y|: (0.2 + λ, 0.8 − λ) while λ < 0.3, then both 0.5.
    let r = DMatrix::identity(2, 2);
    let d = DVector::from_row_slice(&[0.2, 0.8]);
    let bounds = Bounds::all(2, 0.0, 1.0);
    for (lambda, exact, sets) in [
        (0.0, [0.2, 0.8], 2),
        (0.1, [0.3, 0.7], 2),
        (0.5, [0.5, 0.5], 1),
    ] {
        let found = fused_least_squares(&r, &d, &bounds, &[[0, 1]], lambda, &d).unwrap();
        let error = (&found.found.solution - DVector::from_row_slice(&exact)).amax();
        assert!(
            error < 1e-12 && found.free_sets == sets,
            "{lambda}: {found:?}"
        );
        assert!(found.found.gap < 1e-9);
    }
}

/// Every point of a fine grid lies above the minimum less its gap, and some near it.
#[test]
fn no_point_of_a_grid_is_better() {
    let r = DMatrix::from_row_slice(
        4,
        3,
        &[3.0, 1.0, 0.5, -1.0, 2.0, 0.3, 0.2, 0.7, 2.0, 1.0, 1.0, 1.0],
    );
    let d = DVector::from_row_slice(&[2.5, 1.0, -0.3, 4.0]);
    let pairs = [[0, 1], [1, 2]];
    for upper in [1.0, f64::INFINITY] {
        let bounds = Bounds::all(3, 0.0, upper);
        let start = box_least_squares(&r, &d, &bounds).unwrap().solution;
        let found = fused_least_squares(&r, &d, &bounds, &pairs, 0.4, &start).unwrap();
        let f = |x: &DVector<f64>| {
            0.5 * (&r * x - &d).norm_squared() + 0.4 * ((x[0] - x[1]).abs() + (x[1] - x[2]).abs())
        };
        assert!((f(&found.found.solution) - found.found.objective).abs() < 1e-12);
        let mut least = f64::INFINITY;
        for at in 0..101usize.pow(3) {
            let number = |i: u32| (at / 101usize.pow(i) % 101) as f64 / 100.0;
            let x = DVector::from_fn(3, |i, _| {
                number(i as u32) * if upper == 1.0 { 1.0 } else { 1.5 }
            });
            least = least.min(f(&x));
        }
        assert!(least >= found.found.objective - found.found.gap - 1e-12);
        assert!(
            least < found.found.objective + 1e-2 && found.found.gap < 1e-8,
            "{found:?} {least}"
        );
    }
}

/// Both methods end at one minimum, with multipliers that prove it, between two bounds and above
/// one.
#[test]
fn dense_matrices_end_where_the_conic_solver_ends() {
    let mut state = 11u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    // A grid of 6 × 5 seen in fewer rows, which fall off as directions do.
    let r = DMatrix::from_fn(20, 30, |i, j| {
        (0.6 + next()) * libm::exp(-0.4 * ((i + j) % 13) as f64)
    });
    let d = DVector::from_fn(20, |_, _| next());
    let across = (0..30).filter(|j| j % 6 < 5).map(|j| [j, j + 1]);
    let along = (0..24).map(|j| [j, j + 6]);
    let pairs: Vec<[usize; 2]> = across.chain(along).collect();
    for (upper, lambda) in [(1.0, 0.3), (1.0, 1e-4), (f64::INFINITY, 0.01)] {
        let bounds = Bounds::all(30, 0.0, upper);
        let start = box_least_squares(&r, &d, &bounds).unwrap().solution;
        let problem = Penalised {
            r: &r,
            d: &d,
            bounds: &bounds,
            pairs: &pairs,
            lambda,
        };
        let exact = fused_least_squares(&r, &d, &bounds, &pairs, lambda, &start).unwrap();
        let found = dense_differences::solve(&problem).unwrap();
        assert!(
            found.closed && found.iterations < 40,
            "{}",
            found.iterations
        );
        let above = problem.objective(&found.x) - exact.found.objective;
        assert!(above.abs() < 1e-9, "{upper} {lambda}: {above:e}");
        // Stationary: Rᵀ(R x − d) + Tᵀν points out of the box where a bound holds, else is 0.
        let mut gradient = r.tr_mul(&(&r * &found.x - &d));
        for (&[a, b], w) in pairs.iter().zip(found.pull.iter()) {
            gradient[a] += w;
            gradient[b] -= w;
        }
        for (x, g) in found.x.iter().zip(gradient.iter()) {
            let outwards = (*x < 1e-5 && *g > 0.0) || (*x > upper - 1e-5 && *g < 0.0);
            assert!(outwards || g.abs() < 1e-5, "{upper} {lambda}: {x} {g:e}");
        }
    }
}
