//! How a matrix is thinned for the explorer.

use super::*;

#[test]
fn a_small_matrix_is_taken_whole() {
    let excerpt = Excerpt::new([3, 2], 4, 1e6);
    assert_eq!(excerpt.every, 1);
    assert_eq!(excerpt.spots, [0, 1, 2, 3]);
    assert_eq!(excerpt.pixels, [0, 1, 2, 3, 4, 5]);
    let matrix = Matrix::from_fn(6, 4, |p, l| (10 * l + p) as f64);
    let found = excerpt.of(&matrix);
    assert_eq!(found[..7], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 10.0]);
}

/// Never more entries than asked for, every index within the matrix, each the middle of its
/// block.
#[test]
fn a_large_matrix_is_thinned_to_what_fits() {
    for (size, spots, entries) in [
        ([1000, 700], 300, 1e6),
        ([64, 64], 10_000, 1e6),
        ([5, 4000], 13, 5000.0),
        ([1, 1], 100_000, 500.0),
    ] {
        let e = Excerpt::new(size, spots, entries);
        assert!(
            (e.spots.len() * e.pixels.len()) as f64 <= entries.max(12.0),
            "{size:?}"
        );
        assert!(e.spots.iter().all(|s| *s < spots) && e.spots.len() >= 7.min(spots));
        assert!(e.pixels.iter().all(|p| *p < size[0] * size[1]));
        assert!(e.pixels.windows(2).all(|w| w[0] < w[1]));
    }
    let e = Excerpt::new([7, 4], 1, 6.0);
    // Blocks of 3: columns 0–2, 3–5, 6; rows 0–2, 3.
    assert_eq!((e.every, &e.pixels[..]), (3, &[8, 11, 13, 22, 25, 27][..]));
}
