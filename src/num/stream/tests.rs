use super::*;

fn key(block: u32) -> Key {
    Key {
        seed: 1,
        spot: 2,
        pixel: 3,
        block,
    }
}

#[test]
fn a_stream_depends_on_every_part_of_its_key() {
    let first = |k: Key, s| {
        let mut stream = Stream::new(s, k);
        stream.start(0);
        stream.next_four()
    };
    for s in [Sampling::Pcg, Sampling::Sobol] {
        let base = first(key(0), s);
        assert_eq!(base, first(key(0), s));
        assert_ne!(base, first(key(1), s));
        assert_ne!(base, first(Key { seed: 2, ..key(0) }, s));
        assert_ne!(base, first(Key { spot: 3, ..key(0) }, s));
        assert_ne!(base, first(Key { pixel: 2, ..key(0) }, s));
        // Spot and pixel must not be exchangeable.
        assert_ne!(
            first(
                Key {
                    spot: 7,
                    pixel: 9,
                    ..key(0)
                },
                s
            ),
            first(
                Key {
                    spot: 9,
                    pixel: 7,
                    ..key(0)
                },
                s
            )
        );
    }
}

/// A net of 2^m points has exactly one point in every interval of length 2^−m, in each
/// dimension, and one in every elementary box of the first two dimensions.
#[test]
fn sobol_blocks_are_nets() {
    let m = 256;
    for block in 0..4 {
        let mut stream = Stream::new(Sampling::Sobol, key(block));
        let mut seen = [[false; 256]; 4];
        let mut boxes = [false; 256];
        for i in 0..m {
            stream.start(i);
            let x = stream.next_four();
            for d in 0..4 {
                let cell = (x[d] * 256.0) as usize;
                assert!(
                    !seen[d][cell],
                    "dimension {d}: two points in interval {cell}"
                );
                seen[d][cell] = true;
            }
            let cell = (x[0] * 16.0) as usize * 16 + (x[1] * 16.0) as usize;
            assert!(!boxes[cell]);
            boxes[cell] = true;
        }
    }
}

/// Mean ½ and variance 1/12 within 4 standard errors; neighbouring keys uncorrelated.
#[test]
fn pcg_numbers_are_uniform_and_neighbouring_blocks_unrelated() {
    let n = 40_000u32;
    let (mut sum, mut square, mut product) = (0.0, 0.0, 0.0);
    for block in 0..n {
        let x = Stream::new(Sampling::Pcg, key(block)).next_four()[0];
        let y = Stream::new(Sampling::Pcg, key(block + 1)).next_four()[0];
        sum += x;
        square += (x - 0.5) * (x - 0.5);
        product += (x - 0.5) * (y - 0.5);
    }
    let n = f64::from(n);
    assert!((sum / n - 0.5).abs() < 4.0 * (1.0 / 12.0 / n).sqrt());
    // Var[(x − ½)²] = 1/80 − 1/144 = 1/180; Var[(x − ½)(y − ½)] = 1/144.
    assert!((square / n - 1.0 / 12.0).abs() < 4.0 * (1.0 / 180.0 / n).sqrt());
    assert!((product / n).abs() < 4.0 * (1.0 / 144.0 / n).sqrt());
}

/// The streams are pinned: a change of these numbers is a change of every rendered byte, and
/// must be decided.
#[test]
fn the_streams_are_pinned() {
    let mut pcg = Stream::new(Sampling::Pcg, key(0));
    let mut sobol = Stream::new(Sampling::Sobol, key(0));
    sobol.start(5);
    let bits = |x: [f64; 4]| x.map(f64::to_bits);
    assert_eq!(
        (bits(pcg.next_four())[0], bits(sobol.next_four())[0]),
        (PINNED_PCG, PINNED_SOBOL)
    );
}
const PINNED_PCG: u64 = 4598364495060289958;
const PINNED_SOBOL: u64 = 4605239706447647378;
