use super::*;
use std::ops::ControlFlow;

use crate::num::stream::Sampling;
use crate::num::summation::mean_and_stderr;
use crate::transport::{Budget, Estimator};

const PIXELS: usize = 37;
const COLUMNS: usize = 5;
const ORDERS: usize = 2;

fn value(b: u32, n: usize, p: usize, l: usize) -> f64 {
    let i = b as usize * 7919 + n * 104_729 + p * 31 + l;
    1.0 + 0.1 * p as f64 + 1e-9 * libm::sin(i as f64)
}

fn tally(blocks: u32, part: Range<u32>) -> Tally {
    let mut tally = Tally {
        orders: ORDERS,
        pixels: PIXELS,
        columns: COLUMNS,
        blocks,
        tree: Tree::new(blocks, part.start),
    };
    for b in part {
        let entries = (0..ORDERS).flat_map(|n| (0..PIXELS).map(move |p| (n, p)));
        let sums = entries
            .flat_map(|(n, p)| (0..COLUMNS).map(move |l| value(b, n, p, l)))
            .collect();
        tally
            .add(b..b + 1, Moments::of_block(sums, ORDERS))
            .unwrap();
    }
    tally
}

/// Against the two-pass formula for each entry, with blocks that differ in the ninth digit, of a
/// number that is no power of two.
#[test]
fn means_and_standard_errors_are_the_two_pass_ones() {
    let blocks = 11;
    let traced = tally(blocks, 0..blocks)
        .means(1.0, &mut |_, _| true)
        .unwrap();
    for (p, l) in (0..PIXELS).flat_map(|p| (0..COLUMNS).map(move |l| (p, l))) {
        let totals: Vec<f64> = (0..blocks)
            .map(|b| value(b, 0, p, l) + value(b, 1, p, l))
            .collect();
        let (mean, stderr) = mean_and_stderr(&totals);
        assert!((traced.flux[(p, l)] - mean).abs() <= 1e-15 * mean.abs() * 4.0);
        let found = traced.stderr[(p, l)];
        assert!((found - stderr).abs() <= 1e-6 * stderr, "{found} {stderr}");
    }
}

/// An entry without light is an upper bound from the brightest block of its column, or from the
/// laser where there is none; one that cannot be lit is 0 ± 0. No column stands in for another.
#[test]
fn an_entry_without_light_has_a_bound() {
    let mut tally = tally(32, 0..0);
    for b in 0..32 {
        let mut sums = vec![0.0; ORDERS * PIXELS * COLUMNS];
        let lit = [(3, 0), (4, 0), (3, 1)];
        lit.iter()
            .for_each(|(p, l)| sums[p * COLUMNS + l] = 1.0 + f64::from(b));
        tally
            .add(b..b + 1, Moments::of_block(sums, ORDERS))
            .unwrap();
    }
    let traced = tally.means(500.0, &mut |p, _| p != 9).unwrap();
    assert_eq!(traced.stderr[(8, 0)], 3.0 * 32.0 / 32.0);
    assert_eq!(traced.stderr[(8, 2)], 3.0 * 500.0 / 32.0);
    assert_eq!(traced.tails[(8, 0)], f64::from(UNLIT));
    for l in 0..COLUMNS {
        assert_eq!((traced.stderr[(9, l)], traced.tails[(9, l)]), (0.0, 0.0));
    }
    assert!(traced.stderr[(3, 0)] < 2.0);
}

/// Against the norms of the two-pass means and standard errors of the blocks that are there,
/// however many parts they make.
#[test]
fn the_relative_error_is_that_of_the_blocks_that_are_there() {
    for part in [0..11, 0..7, 0..2, 4..9, 1..4] {
        let (mut noise, mut flux) = (0.0, 0.0);
        for (p, l) in (0..PIXELS).flat_map(|p| (0..COLUMNS).map(move |l| (p, l))) {
            let totals: Vec<f64> = part
                .clone()
                .map(|b| value(b, 0, p, l) + value(b, 1, p, l))
                .collect();
            let (mean, stderr) = mean_and_stderr(&totals);
            noise += stderr * stderr;
            flux += mean * mean;
        }
        let want = (noise / flux).sqrt();
        let found = tally(11, part).relative_error().unwrap();
        assert!((found / want - 1.0).abs() < 1e-6, "{found:e} {want:e}");
    }
    let traced = tally(11, 0..11).means(1.0, &mut |_, _| true).unwrap();
    let found = tally(11, 0..11).relative_error().unwrap();
    let want = traced.stderr.norm() / traced.flux.norm();
    assert!((found / want - 1.0).abs() < 1e-9, "{found:e} {want:e}");
    assert_eq!(tally(11, 3..4).relative_error(), None);
    assert_eq!(tally(11, 0..0).relative_error(), None);
    let mut dark = tally(11, 0..0);
    dark.add_part(0..8, &vec![0; dark.part_bytes()]).unwrap();
    assert_eq!(dark.relative_error(), None);
}

#[test]
fn parts_go_through_bytes_and_come_out_as_the_whole() {
    let whole = tally(11, 0..11);
    let mut merged = tally(11, 0..0);
    for part in [0..3, 3..4, 4..11] {
        for (range, bytes) in tally(11, part).parts() {
            merged.add_part(range, &bytes).unwrap();
        }
    }
    assert_eq!(merged, whole);
    assert_eq!(tally(11, 0..10).means(1.0, &mut |_, _| true), None);
}

#[test]
fn what_cannot_be_a_part_is_refused() {
    let mut tally = tally(11, 0..4);
    let bytes = vec![0u8; tally.part_bytes()];
    let misplaced = tally.add_part(5..6, &bytes).unwrap_err();
    assert_eq!(
        misplaced,
        TallyError::Misplaced {
            range: 5..6,
            after: 4
        }
    );
    let short = tally.add_part(4..8, &bytes[8..]).unwrap_err();
    assert!(matches!(short, TallyError::Length { .. }), "{short}");
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let mut bytes = bytes.clone();
        bytes[80..88].copy_from_slice(&f64::to_le_bytes(bad));
        assert_eq!(
            tally.add_part(4..8, &bytes),
            Err(TallyError::NoFlux { range: 4..8 })
        );
    }
    assert_eq!(tally.add_part(4..8, &bytes), Ok(()));
}

/// Every estimator, cut anywhere, gives the bits of the whole; tracing goes on from what the
/// control stopped.
#[test]
fn traced_in_pieces_or_at_once_the_bits_are_the_same() {
    let text = Scene::load("bench").unwrap().text;
    let text = text
        .replace("per_side = 30", "per_side = 2")
        .replace("pixels = [16, 16]", "pixels = [3, 4]");
    let scene = Scene::from_toml("toy", &text).unwrap();
    let never = std::sync::atomic::AtomicBool::new(false);
    let control = crate::transport::Control {
        progress: &|_| (),
        stop: &never,
    };
    for (estimator, sampling) in Estimator::ALL
        .into_iter()
        .flat_map(|e| [(e, Sampling::Pcg), (e, Sampling::Sobol)])
    {
        let budget = Budget::new(32 * 37, sampling).unwrap();
        let plan = Plan {
            estimator,
            sampling,
            seed: 3,
            budget,
        };
        let whole = crate::transport::render(&scene, &plan, 0..5, control).unwrap();
        let mut merged = Tally::new(&scene, &plan, 5, 0);
        for part in [0..1, 1..7, 7..8, 8..32] {
            let start = Tally::new(&scene, &plan, 5, part.start);
            let mut looks = 0;
            let once = &mut |_: &Tally| {
                looks += 1;
                if looks == 1 {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(1)
                }
            };
            let piece =
                crate::transport::trace(&scene, &plan, 0..5, start, part.end, control, once)
                    .unwrap();
            let go_on = &mut |_: &Tally| ControlFlow::Continue(1);
            let piece =
                crate::transport::trace(&scene, &plan, 0..5, piece, part.end, control, go_on)
                    .unwrap();
            assert_eq!(piece.range(), part);
            for (range, bytes) in piece.parts() {
                merged.add_part(range, &bytes).unwrap();
            }
        }
        assert_eq!(
            merged.traced(&scene, 0..5).unwrap(),
            whole,
            "{estimator:?} {sampling:?}"
        );
    }
}
