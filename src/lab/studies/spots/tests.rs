use super::*;
use crate::lab::finding::Describe;
use crate::lab::study::run;
use crate::lab::study::tests::{divides, refuses, small};

fn study(elements: usize) -> SpotsStudy {
    let scene = small("bench");
    let all = scene.laser.spots.len();
    SpotsStudy {
        model: MatrixModel::new(&scene, Kernel::Physical, Some([elements; 2])).unwrap(),
        spots: (1..=all).collect(),
        tolerances: vec![1e-2, 1e-6, 1e-12],
        scene,
    }
}

#[test]
fn it_divides() {
    let study = study(2);
    let found = divides(&study);
    assert_eq!(found.steps.len(), study.spots.len());
    let context = study.context(Control::none()).unwrap();
    let other = study.task(&context, 1, Control::none()).unwrap();
    refuses(&study, 0, &other);
}

/// Φ = Σ_k s_k·u_k·v_kᵀ of three orthogonal directions, of which v₁ is in the first column, v₂
/// in the second and v₃ in the last two: the rank of the first columns at each tolerance is
/// written down from s.
#[test]
fn a_matrix_of_known_rank_has_it() {
    let root = 0.5f64.sqrt();
    let u = Matrix::from_row_slice(
        4,
        3,
        &[
            0.5, 0.5, 0.5, 0.5, -0.5, 0.5, 0.5, 0.5, -0.5, 0.5, -0.5, -0.5,
        ],
    );
    let sv = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1e-3, 0.0, 0.0],
        [0.0, 0.0, root * 1e-6, root * 1e-6],
    ];
    let phi = u * Matrix::from_fn(3, 4, |i, j| sv[i][j]);
    let photographs = Photographs { phi, largest: 1.0 };
    let ranks = |l| {
        let found = rank(&photographs, 0..l, l.min(3), &[1e-2, 1e-4, 8e-7, 1e-8]);
        found.unwrap().ranks
    };
    assert_eq!(ranks(1), [1, 1, 1, 1]);
    assert_eq!(ranks(2), [1, 2, 2, 2]);
    // σ₃ is 7.1e-7 with one of the last two columns and 1e-6 with both.
    assert_eq!(ranks(3), [1, 2, 2, 3]);
    assert_eq!(ranks(4), [1, 2, 3, 3]);
    let last = rank(&photographs, 0..4, 3, &[]).unwrap().last;
    assert!((last / 1e-6 - 1.0).abs() < 1e-9, "{last}");
}

/// C·diag(ρ)·D with r₊ reflecting elements between: no more than r₊ directions, whatever the
/// spots; a further spot takes none away, and adds one at most; a smaller tolerance takes none
/// away.
#[test]
fn the_rank_stays_below_its_bound_and_grows_by_one_at_most() {
    for elements in [1, 2, 3] {
        let study = study(elements);
        let found = run(&study, Control::none()).unwrap();
        assert!(found.reflecting <= elements * elements);
        for step in &found.steps {
            let most = found.reflecting.min(found.pixels).min(step.spots);
            assert_eq!(step.bound, most);
            assert!(step.ranks.iter().all(|r| *r <= most), "{step:?}");
            assert!(step.ranks.is_sorted(), "{step:?}");
        }
        for pair in found.steps.windows(2) {
            for (before, after) in pair[0].ranks.iter().zip(&pair[1].ranks) {
                assert!((*before..=before + 1).contains(after), "{pair:?}");
            }
        }
        let last = found.steps.last().unwrap();
        assert_eq!(last.ranks[2], found.reflecting.min(last.spots));
        let said = found.describe();
        assert!(
            said.sentence
                .contains(&format!("cannot exceed {}", last.bound))
        );
        assert_eq!(said.tables[0].rows.len(), found.steps.len());
    }
}

/// Of five places on a line the middle one is first, then the two ends, then what is between; of
/// equals the first.
#[test]
fn spots_are_spread() {
    let line: Vec<DVec3> = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| DVec3::X * x).to_vec();
    assert_eq!(spread(&line), [2, 0, 4, 1, 3]);
    let crowded: Vec<DVec3> = [0.0, 0.1, 0.2, 9.0, 3.0].map(|x| DVec3::X * x).to_vec();
    assert_eq!(spread(&crowded), [4, 3, 0, 2, 1]);
    assert_eq!(spread(&[DVec3::X; 3]), [0, 1, 2]);
    assert!(spread(&[]).is_empty());
}
