//! Errors that say less than they seem to.

use super::*;

/// Two elements of equal columns are known by their sum alone: the shortest solution gives each a
/// half of it with an error that does not know that, and says so; without the second nothing is
/// said.
#[test]
fn elements_that_cannot_be_told_apart_are_told() {
    let camera = |alike: bool| {
        Matrix::from_fn(20, 4, |p, j| {
            let j = if alike && j == 3 { 2 } else { j };
            1.0 + libm::sin((p * (j + 2)) as f64)
        })
    };
    for alike in [true, false] {
        let model =
            MatrixModel::of_sides(camera(alike), Matrix::from_element(4, 1, 1.0), [4, 1]).unwrap();
        let exact = &model.camera_side * Matrix::from_row_slice(4, 1, &[0.3, 0.7, 0.6, 0.0]);
        let warnings = warnings(&model, &exact, Method::JointUnbounded);
        let told = warnings
            .iter()
            .any(|w| w.contains("do not determine 2 of 4"));
        assert_eq!(told, alike, "{warnings:?}");
    }
}

/// An element whose light is a hundred millionth of the others' has whatever noise makes of it by
/// `nnls`, which says so; of one that is seen nothing is said.
#[test]
fn an_element_that_is_not_seen_is_told() {
    for (light, unseen) in [(1e-8, true), (1.0, false)] {
        let camera = Matrix::from_fn(20, 4, |p, j| {
            (1.0 + libm::sin((p * (j + 2)) as f64)) * if j == 3 { light } else { 1.0 }
        });
        let model = MatrixModel::of_sides(camera, Matrix::from_element(4, 1, 1.0), [4, 1]).unwrap();
        let exact = &model.camera_side * Matrix::from_row_slice(4, 1, &[0.3, 0.7, 0.6, 0.5]);
        let phi = exact + model.camera_side.columns(3, 1) * (1e-3 / light);
        let warnings = warnings(&model, &phi, Method::Nnls);
        let told = warnings
            .iter()
            .any(|w| w.contains("1 of 4 elements, up to"));
        assert_eq!(told, unseen, "{warnings:?}");
    }
}

/// Right photographs whose errors are no product of one by pixel and one by spot: no method says
/// that nothing explains them, and one whose weights are of that form says what helps. Their errors
/// estimated from few replicates, those of the picture are told to be too small.
#[test]
fn errors_of_any_form_refute_nothing() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let phi = model.phi();
    for seed in 1..4 {
        let mut normal = normal(seed);
        let stderr = phi.map(|x| 0.01 * x * libm::exp(1.5 * normal()[0]));
        let noisy = phi.zip_map(&stderr, |x, s| x + s * normal()[0]);
        let mut told = 0;
        for (method, outcome) in by_every_method(&model, &noisy, Some(&stderr)) {
            let Ok(object) = outcome else { continue };
            assert!(!object.contradicted(), "{method}: {:?}", object.warnings);
            let helps = object.warnings.iter();
            told += usize::from(helps.filter(|w| w.contains("--weighting entries")).count() > 0);
        }
        assert!(told > 0, "{seed}");
    }
    for (replicates, few) in [(Some(5), true), (Some(32), false), (None, false)] {
        let right = Photographs::relative(&phi, 1e-2, 5);
        let certainty = Certainty {
            replicates,
            ..Certainty::STATED
        };
        let method = (Method::JointUnbounded, &Options::default());
        let warnings = recovered(&model, &right.phi, (&right.stderr, certainty), method).warnings;
        let told = warnings.iter().any(|w| w.contains("replicates"));
        assert_eq!(told, few, "{replicates:?}: {warnings:?}");
    }
}

/// Noisy photographs do not say how alike elements are, good ones of elements that are not do.
#[test]
fn how_alike_elements_are_is_told_or_not() {
    let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    model.albedo = (0..16)
        .map(|j| 0.5 + 0.3 * libm::sin(f64::from(j * j)))
        .collect();
    for (level, untold) in [(1e-9, false), (0.1, true)] {
        let of = Photographs::relative(&model.phi(), level, 5);
        let known = (&of.stderr, Certainty::STATED);
        let method = (Method::JointGp, &Options::default());
        let warnings = recovered(&model, &of.phi, known, method).warnings;
        let told = warnings.iter().any(|w| w.contains("how alike"));
        assert_eq!(told, untold, "{level}: {warnings:?}");
    }
}
