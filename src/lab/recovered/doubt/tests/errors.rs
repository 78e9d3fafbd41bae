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
/// that nothing explains them, and joint methods do. Their errors estimated from few replicates,
/// those of the picture are told to be too small.
#[test]
fn errors_of_any_form_refute_nothing() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let phi = model.phi();
    for seed in 1..4 {
        let mut normal = normal(seed);
        let stderr = phi.map(|x| 0.01 * x * libm::exp(1.5 * normal()[0]));
        let noisy = phi.zip_map(&stderr, |x, s| x + s * normal()[0]);
        for (method, outcome) in by_every_method(&model, &noisy, Some(&stderr)) {
            let Ok(object) = outcome else { continue };
            assert!(!object.contradicted(), "{method}: {:?}", object.warnings);
            let fits = object.fit.is_some_and(|fit| fit.fits);
            let any = [Method::JointUnbounded, Method::Joint, Method::Nnls].contains(&method);
            assert!(fits || !any, "{seed} {method}: {:?}", object.warnings);
        }
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

/// Elements that no bound touches leave nothing of the reduced objective, and no search ended
/// early; photographs of unknown noise, 40 pixels and six elements.
#[test]
fn a_minimum_that_no_bound_touches_is_no_early_end() {
    let camera = Matrix::from_fn(40, 6, |p, j| 1.0 + libm::sin((p * (2 * j + 3)) as f64));
    let model = MatrixModel::of_sides(camera, Matrix::from_element(6, 1, 1.0), [6, 1]).unwrap();
    let mut normal = normal(2);
    let exact = &model.camera_side * Matrix::from_fn(6, 1, |j, _| 0.2 + 0.1 * j as f64);
    let phi = exact.map(|x| x + 1e-3 * normal()[0]);
    let bounded = [Method::Joint, Method::Nnls];
    let found = by_every_method(&model, &phi, None).into_iter();
    let warnings: Vec<(Method, Vec<String>)> = found
        .filter(|(method, _)| bounded.contains(method))
        .map(|(method, found)| (method, found.unwrap().warnings))
        .collect();
    assert_eq!(warnings.len(), bounded.len());
    let early = |told: &Vec<String>| told.iter().any(|w| w.contains("ended before"));
    assert!(
        !warnings.iter().any(|(_, told)| early(told)),
        "{warnings:?}"
    );
}

/// Noise that is a share of each entry, stated as one size for all: what is left grows with the
/// light, and no entry is taken for a hot pixel; of errors that are right nothing is said. 1600
/// pixels, one photograph.
#[test]
fn errors_that_do_not_go_with_the_light_are_told() {
    let camera = Matrix::from_fn(1600, 4, |p, j| {
        let own = 1.0 + 0.5 * libm::sin((p * (j + 2)) as f64);
        libm::exp(0.7 * libm::sin(2.7 * p as f64)) * own
    });
    let model = MatrixModel::of_sides(camera, Matrix::from_element(4, 1, 1.0), [4, 1]).unwrap();
    let exact = &model.camera_side * Matrix::from_row_slice(4, 1, &[0.3, 0.7, 0.6, 0.5]);
    let own = &exact * 0.01;
    let rms = (own.norm_squared() / 1600.0).sqrt();
    let alike = exact.map(|_| rms);
    let mut grows = 0;
    for seed in 0..20 {
        let mut normal = normal(seed);
        let phi = exact.zip_map(&own, |x, s| x + s * normal()[0]);
        let told = |stderr: &Matrix| {
            let method = (Method::JointUnbounded, &Options::default());
            let object = recovered(&model, &phi, (stderr, Certainty::STATED), method);
            let told = |words: &str| object.warnings.iter().any(|w| w.contains(words));
            assert!(
                !told("a hot or dead pixel"),
                "{seed}: {:?}",
                object.warnings
            );
            told("GROWS with the light")
        };
        grows += u32::from(told(&alike));
        assert!(!told(&own), "{seed}");
    }
    // Of one in a hundred χ² is refuted too, which is told instead.
    assert!(grows >= 18, "{grows}");
}

/// Of photographs that are noise most elements sit on a bound: bands are offered to decide how
/// much that says where the method has any, and to no other.
#[test]
fn bands_are_offered_where_there_are_any() {
    let camera = Matrix::from_fn(60, 9, |p, j| 1.5 + libm::sin((p * (2 * j + 3)) as f64));
    let model = MatrixModel::of_sides(camera, Matrix::from_element(9, 1, 1.0), [3, 3]).unwrap();
    let exact = &model.camera_side * Matrix::from_element(9, 1, 0.5);
    let stderr = exact.map(|_| 300.0);
    for (method, can) in [(Method::Joint, true), (Method::JointTv, false)] {
        let mut told = 0;
        for seed in 0..6 {
            let mut normal = normal(seed);
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal()[0]);
            let known = (&stderr, Certainty::STATED);
            let object = recovered(&model, &phi, known, (method, &Options::default()));
            for doubt in object.warnings.iter().filter(|w| w.contains("on a bound")) {
                assert_eq!(doubt.contains("--bands"), can, "{method}: {doubt}");
                told += 1;
            }
        }
        assert!(told > 0, "{method}");
    }
}
