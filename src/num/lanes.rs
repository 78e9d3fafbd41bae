//! Wide arithmetic: the same operations on many numbers at once. The one door to pulp.
//!
//! The loops are plain Rust; which instructions they become is decided when the program runs, by
//! what the processor has. The bits do not depend on it: no operation is fused with another, and no
//! sum is taken in another order than the one written here.

use pulp::Arch;

/// Columns of a product are computed in groups of this many: two registers of AVX-512.
pub const LANES: usize = 16;

/// `columns` rounded up to whole groups of [`LANES`].
pub fn padded(columns: usize) -> usize {
    columns.next_multiple_of(LANES)
}

/// Runs `f` compiled for the widest instructions of this processor. What `f` calls takes part only
/// where it is inlined.
#[inline]
pub fn widest<R>(f: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(f)
}

/// C += A·B for matrices stored by rows: A is rows × `inner`, B `inner` × `width`, C rows ×
/// `width`, `width` a multiple of [`LANES`]. Each entry receives its terms one after the other by
/// growing inner index.
///
/// # Panics
/// If the lengths do not fit together.
pub fn add_product(c: &mut [f64], a: &[f64], b: &[f64], inner: usize, width: usize) {
    assert_eq!(width % LANES, 0);
    assert_eq!(b.len(), inner * width);
    let rows = c.len().checked_div(width).unwrap_or(0);
    assert_eq!((c.len(), a.len()), (rows * width, rows * inner));
    widest(
        #[inline(always)]
        || {
            for column in (0..width).step_by(LANES) {
                let mut row = 0;
                while row + 4 <= rows {
                    block::<4>(c, a, b, [row, column], inner, width);
                    row += 4;
                }
                while row < rows {
                    block::<1>(c, a, b, [row, column], inner, width);
                    row += 1;
                }
            }
        },
    );
}

/// The block of `R` × [`LANES`] entries of C that starts at `[row, column]`.
#[inline(always)]
fn block<const R: usize>(
    c: &mut [f64],
    a: &[f64],
    b: &[f64],
    [row, column]: [usize; 2],
    inner: usize,
    width: usize,
) {
    let place = |r: usize| (row + r) * width + column;
    let mut sums = [[0.0; LANES]; R];
    for (r, sum) in sums.iter_mut().enumerate() {
        sum.copy_from_slice(&c[place(r)..place(r) + LANES]);
    }
    let rows: [&[f64]; R] = std::array::from_fn(|r| &a[(row + r) * inner..(row + r + 1) * inner]);
    for (k, line) in b.chunks_exact(width).enumerate() {
        let mut terms = [0.0; LANES];
        terms.copy_from_slice(&line[column..column + LANES]);
        for r in 0..R {
            let factor = rows[r][k];
            for j in 0..LANES {
                sums[r][j] += factor * terms[j];
            }
        }
    }
    for (r, sum) in sums.iter().enumerate() {
        c[place(r)..place(r) + LANES].copy_from_slice(sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the definition, in the stated order of additions: equal bits.
    #[test]
    fn products_are_sums_of_products_in_order() {
        for (rows, inner, columns) in [(1, 1, 1), (4, 7, 16), (7, 13, 20), (9, 40, 48), (3, 0, 5)] {
            let width = padded(columns);
            let number = |i: usize| (i as f64 * 0.73).fract() - 0.4;
            let a: Vec<f64> = (0..rows * inner).map(number).collect();
            let b: Vec<f64> = (0..inner * width).map(|i| number(i + 5)).collect();
            let start: Vec<f64> = (0..rows * width).map(|i| number(i + 9)).collect();
            let mut c = start.clone();
            add_product(&mut c, &a, &b, inner, width);
            for i in 0..rows {
                for j in 0..width {
                    let expected = (0..inner).fold(start[i * width + j], |s, k| {
                        s + a[i * inner + k] * b[k * width + j]
                    });
                    assert_eq!(
                        c[i * width + j].to_bits(),
                        expected.to_bits(),
                        "{rows} {i} {j}"
                    );
                }
            }
        }
    }
}
