use nalgebra::{DMatrix, DVector};

use super::*;
use crate::num::cosines::from_cosines;
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::{ErrorField, Method, Nuisance, recover as recover_by};

/// 3.5 standard errors of the mean z² of 40 photographs, √(2/40) where the elements of each err as
/// one.
const CHANCE: f64 = 0.78;

/// 16 × 16 pixels of 8 photographs, each the sum of 2 × 2 independent ones.
fn sums_of_four(mut normal: impl FnMut() -> f64) -> DMatrix<f64> {
    let white = DMatrix::from_fn(17 * 17, 8, |_, _| normal());
    DMatrix::from_fn(256, 8, |p, l| {
        let at = p % 16 + p / 16 * 17;
        let around = [at, at + 1, at + 17, at + 18];
        around.iter().map(|q| white[(*q, l)]).sum()
    })
}

/// z² = ((ρ̂ − ρ)/σ)² of 4 elements, mean of 40 photographs of 16 × 16 pixels with 8 spots: pixels
/// counted each for itself, and as what is left over tells; and least and most of ln of how much
/// likelier that is.
fn squares(mut errors: impl FnMut() -> DMatrix<f64>) -> ([f64; 2], [f64; 2]) {
    let bench = Bench::new(6.0, 2, 16);
    let truth = DVector::from_row_slice(&[0.45, 0.5, 0.55, 0.5]);
    let d = bench.d.columns(0, 8).into_owned();
    let exact = bench.phi(&truth).columns(0, 8).into_owned();
    let mut squares = [Vec::new(), Vec::new()];
    let mut likelier = [f64::INFINITY, f64::NEG_INFINITY];
    for _ in 0..40 {
        let phi = &exact + errors() * (1e-4 * exact.mean());
        let problem = Problem::new(&phi, &bench.c, &d, None).unwrap();
        let problem = problem.with_grids(&[[2, 2]]).unwrap();
        for (frame, squares) in [None, Some([16, 16])].into_iter().zip(&mut squares) {
            let options = Options {
                frame,
                error_field: frame.is_some(),
                ..Options::default()
            };
            let found = recover_by(Method::JointGp, &problem, &options).unwrap();
            let z = (found.reflectance - &truth).component_div(&found.standard_error.unwrap());
            squares.push(z.norm_squared() / 4.0);
            assert_eq!(found.field.is_some(), frame.is_some());
            assert_eq!(found.log_evidence.is_none(), frame.is_some());
            let [least, most] = likelier;
            likelier = found
                .log_likelier
                .map_or(likelier, |own| [least.min(own), most.max(own)]);
        }
    }
    let mean = squares.map(|values| values.iter().sum::<f64>() / 40.0);
    (mean, likelier)
}

/// Errors of the form that is supposed, neighbours sharing most of them: z² is 1 in the mean where
/// pixels that count each for itself make it several times as much.
#[test]
fn errors_that_neighbours_share_are_not_counted_as_many() {
    let field = ErrorField {
        pixel: 0.5,
        shared: 2.0,
        range: 4.0,
    };
    let v = field.variances([16, 16]);
    let mut normal = normal_stream(12);
    let ([alone, told], [least, _]) = squares(|| {
        let along = DMatrix::from_fn(256, 8, |k, _| v[k].sqrt() * normal());
        from_cosines(&along, [16, 16])
    });
    assert!(alone > 3.0, "{alone}");
    assert!((told - 1.0).abs() < CHANCE, "{told}");
    assert!(least > 100.0, "{least}");
}

/// Independent noise is told for what it is, and of sums of 2 × 2 independent pixels, which have no
/// such form, the errors are not too small.
#[test]
fn errors_of_other_forms_are_not_taken_for_less() {
    let mut normal = normal_stream(13);
    let ([alone, told], [_, most]) = squares(|| DMatrix::from_fn(256, 8, |_, _| normal()));
    // Twice what two more numbers gain is χ² of two: one of 40 is above 8 with 1.3 %.
    assert!(most < 8.0, "{most}");
    for mean in [alone, told] {
        assert!((mean - 1.0).abs() < CHANCE, "{alone} {told}");
    }
    let ([alone, told], _) = squares(|| sums_of_four(&mut normal));
    assert!(alone > 2.0, "{alone}");
    assert!(told < 1.0 + CHANCE, "{told}");
}

/// Unless a field is asked for what hangs together is counted: sums of 2 × 2 pixels as four. Where
/// entries are left out, without a grid of pixels and where the noise is known there is no field.
#[test]
fn a_field_is_found_where_there_can_be_one() {
    let bench = Bench::new(6.0, 2, 16);
    let d = bench.d.columns(0, 8).into_owned();
    let exact = bench.phi(&DVector::from_element(4, 0.5));
    let exact = exact.columns(0, 8).into_owned();
    let mut normal = normal_stream(14);
    let phi = &exact + sums_of_four(&mut normal) * (1e-4 * exact.mean());
    let counted = Options {
        frame: Some([16, 16]),
        ..Options::default()
    };
    let problem = Problem::new(&phi, &bench.c, &d, None).unwrap();
    let found = recover(&problem, &counted).unwrap();
    assert!(found.field.is_none());
    let alike = found.alike.unwrap();
    assert!((2.5..5.5).contains(&alike), "{alike}");
    let fitted = Options {
        error_field: true,
        ..counted
    };
    assert!(recover(&problem, &fitted).unwrap().field.is_some());
    let mut flags = DMatrix::zeros(256, 8);
    flags[(7, 3)] = 1.0;
    let holed = Nuisance {
        left_out: Some(&flags),
        ..Nuisance::default()
    };
    let holed = problem.with_nuisance(holed).unwrap();
    assert_eq!(recover(&holed, &fitted).unwrap_err(), NO_FIELD);
    let alone = Options {
        frame: None,
        ..fitted
    };
    assert_eq!(recover(&problem, &alone).unwrap_err(), NO_FIELD);
    let stderr = DMatrix::from_element(256, 8, 1e-4 * exact.mean());
    let known = Problem::new(&phi, &bench.c, &d, Some(&stderr)).unwrap();
    assert_eq!(recover(&known, &fitted).unwrap_err(), NOISE_IS_KNOWN);
}
