use super::*;

fn unit(r: &DMatrix<f64>, d: &DVector<f64>) -> Result<BoxSolution, QuadraticError> {
    box_least_squares(r, d, &Bounds::all(r.ncols(), 0.0, 1.0))
}

#[test]
fn a_diagonal_problem_is_the_clipped_quotient() {
    // Separable: x_j = clamp(d_j/R_jj, 0, 1).
    let r = DMatrix::from_diagonal(&DVector::from_row_slice(&[2.0, 1e-3, 5.0, 1.0]));
    let d = DVector::from_row_slice(&[1.0, 5.0, -3.0, 0.25]);
    let found = unit(&r, &d).unwrap();
    assert!((found.solution - DVector::from_row_slice(&[0.5, 1.0, 0.0, 0.25])).amax() < 1e-15);
    // What is left: 5 − 0.001 and −3 − 0.
    assert!((found.objective - 0.5 * (4.999f64.powi(2) + 9.0)).abs() < 1e-14 * found.objective);
}

#[test]
fn a_coupled_problem_matches_its_hand_solution() {
    // min (x₁ + x₂ − 3)² + (x₁ − x₂)²: free minimum (1.5, 1.5), in the box (1, 1).
    // min (x₁ + 2x₂ − 1)² + (x₁ + 1)²: free x₁ = −1; with x₁ = 0 the rest gives x₂ = ½.
    let r = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, -1.0]);
    let found = unit(&r, &DVector::from_row_slice(&[3.0, 0.0])).unwrap();
    assert!((found.solution - DVector::from_row_slice(&[1.0, 1.0])).amax() < 1e-15);
    let r = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 1.0, 0.0]);
    let found = unit(&r, &DVector::from_row_slice(&[1.0, -1.0])).unwrap();
    assert!((found.solution - DVector::from_row_slice(&[0.0, 0.5])).amax() < 1e-14);
    assert!(found.gap < 1e-14);
}

#[test]
fn ill_conditioned_corner_is_found_at_any_scale() {
    // Hilbert 10 × 10 (condition 1.6e13), d from a corner of the box and a point inside it.
    let r = DMatrix::from_fn(10, 10, |i, j| 1.0 / (i + j + 1) as f64);
    let corner = DVector::from_fn(10, |j, _| f64::from(u8::from(j % 3 == 0)));
    for factor in [1.0, 1e-13, 1e120] {
        let found = unit(&(&r * factor), &(&r * &corner * factor)).unwrap();
        // Conditioned by the corner: the bounds decide what the matrix cannot; eps·cond = 3e-3
        // without them.
        assert!(
            (&found.solution - &corner).amax() < 1e-3,
            "{factor}: {}",
            found.solution
        );
        assert!(
            found.gap <= 1e-15 * factor * factor,
            "{factor}: {}",
            found.gap
        );
    }
}

/// Against a search over every set of variables at zero: n = 5, 32 sets, each solved freely.
#[test]
fn without_upper_bounds_it_is_the_best_of_all_sets_at_zero() {
    for seed in 0..6 {
        let r = DMatrix::from_fn(8, 5, |i, j| {
            (((i * 31 + j * 17 + seed * 7) % 13) as f64 - 6.0) / 6.0
        });
        let d = DVector::from_fn(8, |i, _| (((i + seed) * 7) % 5) as f64 * 3.0 - 5.0);
        let mut best = (0.5 * d.norm_squared(), DVector::zeros(5));
        for set in 1u32..32 {
            let free: Vec<usize> = (0..5).filter(|j| set >> j & 1 == 1).collect();
            let columns = r.select_columns(&free);
            let found =
                super::super::linalg::least_squares(&columns, &d, Default::default()).unwrap();
            if found.solution.iter().all(|x| *x >= 0.0) && 0.5 * found.residual.powi(2) < best.0 {
                let mut x = DVector::zeros(5);
                for (&j, &value) in free.iter().zip(found.solution.iter()) {
                    x[j] = value;
                }
                best = (0.5 * found.residual.powi(2), x);
            }
        }
        let found = box_least_squares(&r, &d, &Bounds::all(5, 0.0, f64::INFINITY)).unwrap();
        assert!(
            (&found.solution - &best.1).amax() < 1e-12,
            "{seed}: {}",
            found.solution
        );
        assert!((found.objective / best.0 - 1.0).abs() < 1e-12 && found.gap < 1e-12);
    }
}

/// Columns that cancel, R z = 0 for some z > 0, let x grow without end along z, so that no h has
/// Rᵀh > 0. By hand: what lies along R x can be fitted, what lies across cannot.
#[test]
fn unbounded_columns_that_cancel_have_a_proved_minimum() {
    let mut state = 5u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    for copies in [1, 2, 3] {
        // Each of 4 directions with both signs, repeated: collinear columns. The fifth and sixth
        // row are across.
        let frame = DMatrix::from_fn(4, 4, |_, _| next());
        let r = DMatrix::from_fn(6, 8 * copies, |i, j| {
            let sign = if j / 4 % 2 == 0 { 1.0 } else { -1.3 };
            if i < 4 { sign * frame[(i, j % 4)] } else { 0.0 }
        });
        for across in [0.0, 1e-6, 1.0] {
            let d = DVector::from_fn(6, |i, _| if i < 4 { next() } else { across });
            let bounds = Bounds::all(r.ncols(), 0.0, f64::INFINITY);
            let found = box_least_squares(&r, &d, &bounds).unwrap();
            let exact = across * across;
            assert!(
                (found.objective - exact).abs() <= 1e-12 && found.gap <= 1e-10,
                "{copies} {across}: {} {}",
                found.objective,
                found.gap
            );
        }
    }
}

#[test]
fn bounds_can_lie_anywhere() {
    let r = DMatrix::from_diagonal(&DVector::from_row_slice(&[2.0, 1.0, 1.0]));
    let d = DVector::from_row_slice(&[7.0, -5.0, 1.0]);
    let bounds = Bounds {
        lower: DVector::from_row_slice(&[1.0, -2.0, 0.25]),
        upper: DVector::from_row_slice(&[f64::INFINITY, 4.0, 0.25]),
    };
    let found = box_least_squares(&r, &d, &bounds).unwrap();
    assert!((found.solution - DVector::from_row_slice(&[3.5, -2.0, 0.25])).amax() < 1e-14);
    for (lower, upper) in [(1.0, 0.0), (f64::NEG_INFINITY, 0.0), (0.0, f64::NAN)] {
        assert!(matches!(
            box_least_squares(&r, &d, &Bounds::all(3, lower, upper)),
            Err(QuadraticError::Bounds { variable: 0, .. })
        ));
    }
}

#[test]
fn degenerate_and_bad_input() {
    let flat = unit(&DMatrix::zeros(2, 3), &DVector::from_row_slice(&[1.0, 2.0])).unwrap();
    assert!(flat.solution.iter().all(|x| (0.0..=1.0).contains(x)));
    assert_eq!((flat.gap, flat.objective), (0.0, 2.5));
    let wide = unit(
        &DMatrix::from_element(1, 3, 1.0),
        &DVector::from_element(1, 1.5),
    )
    .unwrap();
    assert!((wide.solution.sum() - 1.5).abs() < 1e-14);
    assert!(unit(&DMatrix::zeros(0, 3), &DVector::zeros(0)).is_err());
    assert!(unit(&DMatrix::zeros(2, 3), &DVector::zeros(3)).is_err());
    assert!(unit(&DMatrix::from_element(1, 1, f64::NAN), &DVector::zeros(1)).is_err());
    assert!(
        unit(
            &DMatrix::zeros(1, 1),
            &DVector::from_element(1, f64::INFINITY)
        )
        .is_err()
    );
}

/// A column of 0: its variable changes nothing and stays at its lower bound, whatever the upper,
/// by either solver.
#[test]
fn what_is_not_seen_stays_at_its_lower_bound() {
    for (rows, n) in [(9, 5), (520, 510)] {
        let mut r = DMatrix::from_fn(rows, n, |i, j| {
            f64::from(u8::from(i == j)) + 0.1 * (((i * 31 + j * 17) % 13) as f64 - 6.0) / n as f64
        });
        r.column_mut(2).fill(0.0);
        let d = DVector::from_fn(rows, |i, _| ((i * 7) % 5) as f64 - 1.0);
        for top in [1.0, f64::INFINITY] {
            let bounds = Bounds::all(n, 0.25, top);
            let all = box_least_squares(&r, &d, &bounds).unwrap();
            let seen = box_least_squares(
                &r.clone().remove_column(2),
                &d,
                &Bounds::all(n - 1, 0.25, top),
            )
            .unwrap();
            assert_eq!(all.solution[2], 0.25);
            let off = (all.solution.remove_row(2) - seen.solution).amax();
            assert!(off < 1e-9, "{n} {top}: {off:e}");
        }
    }
}
