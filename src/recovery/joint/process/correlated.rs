//! Over how many pixels hangs together what a recovery leaves over.

use nalgebra::DMatrix;

use crate::recovery::RecoveryError;

/// Distance up to which neighbours are looked at, pixels.
const FARTHEST: usize = 48;
/// Standard deviations of chance above which a ring of neighbours hangs together with its middle.
const DEVIATIONS: f64 = 2.0;

/// κ = Σ ρ(Δ), ρ(Δ) the autocorrelation of what is left over (pixels × spots) between pixels Δ
/// apart in a photograph: noise of this correlation has in all that varies little over such a
/// distance the variance κ σ², as if only every κ-th pixel counted. 1 where pixels err
/// independently.
///
/// > ρ(Δ) = Σ_l Σ_p r\[p,l\] r\[p + Δ,l\] / Σ_pl r²\[p,l\]
///
/// summed over square rings about Δ = 0, the innermost first, up to the first whose sum chance
/// explains: of n independent entries the sum over the 8 d neighbours at distance d scatters by 4
/// √(d/n).
///
/// # Errors
/// [`RecoveryError::Shape`] where the photographs have other than columns × rows pixels.
pub(super) fn pixels(
    left: &DMatrix<f64>,
    [columns, rows]: [usize; 2],
) -> Result<f64, RecoveryError> {
    if columns.checked_mul(rows) != Some(left.nrows()) {
        return Err(RecoveryError::Shape {
            name: "a photograph (columns × rows)",
            rows,
            columns,
            found_rows: left.nrows(),
            found_columns: 1,
        });
    }
    let square = left.norm_squared();
    if square == 0.0 {
        return Ok(1.0);
    }
    let mut sum = 1.0;
    for ring in 1..=FARTHEST.min(columns.max(rows) / 2) {
        let d = ring as isize;
        // One of each pair of opposite neighbours.
        let right = (-d + 1..=d).map(|y| [d, y]);
        let above = (-d..d).map(|x| [x, d]);
        let apart = right.chain(above);
        let around = 2.0
            * apart
                .map(|by| products(left, [columns, rows], by))
                .sum::<f64>();
        let chance = 4.0 * (ring as f64 / left.len() as f64).sqrt();
        if around / square <= DEVIATIONS * chance {
            break;
        }
        sum += around / square;
    }
    Ok(sum)
}

/// Σ_l Σ_p r\[p,l\] r\[p + Δ,l\].
fn products(left: &DMatrix<f64>, [columns, rows]: [usize; 2], [x, y]: [isize; 2]) -> f64 {
    let span =
        |n: usize, by: isize| by.min(0).unsigned_abs()..n.saturating_sub(by.max(0).unsigned_abs());
    let mut sum = 0.0;
    for frame in left.column_iter() {
        for row in span(rows, y) {
            for column in span(columns, x) {
                let at = column + row * columns;
                let other = at.wrapping_add_signed(x + y * columns as isize);
                sum += frame[at] * frame[other];
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::normal_stream;

    /// Independent noise: 1. Noise averaged over m × m pixels: ρ(x, y) = (1 − |x|/m)(1 − |y|/m)
    /// sums to m².
    #[test]
    fn averaged_noise_hangs_together_over_what_was_averaged() {
        let mut normal = normal_stream(3);
        let (columns, rows) = (70, 50);
        let white = DMatrix::from_fn(columns * rows, 4, |_, _| normal());
        for m in [1, 2, 4] {
            let left = DMatrix::from_fn(columns * rows, 4, |p, l| {
                let at = |x: usize, y: usize| {
                    white[(
                        (p % columns + x) % columns + (p / columns + y) % rows * columns,
                        l,
                    )]
                };
                (0..m * m).map(|k| at(k % m, k / m)).sum::<f64>()
            });
            let found = pixels(&left, [columns, rows]).unwrap();
            let expected = (m * m) as f64;
            assert!((found / expected - 1.0).abs() < 0.15, "{m} {found}");
        }
        assert_eq!(pixels(&DMatrix::zeros(12, 1), [4, 3]), Ok(1.0));
        assert!(pixels(&white, [50, 50]).is_err());
    }
}
