//! Photographs that do not fit.

use super::*;

/// Frames upside down, spots in another order, counts given as W, spots elsewhere by half an
/// inch, the published kernel: each is warned of by every method, or refused by it.
#[test]
fn every_method_warns_of_photographs_that_are_not_of_this_scene() {
    let scene = small("bench");
    let model = MatrixModel::new(&scene, Kernel::Physical, Some([4, 4])).unwrap();
    let right = Photographs::relative(&model.phi(), 1e-3, 1);
    let both = |f: &dyn Fn(&Matrix) -> Matrix| (f(&right.phi), f(&right.stderr));
    let (columns, rows) = (scene.camera.columns, scene.camera.rows);
    let upside_down = both(&|m| {
        Matrix::from_fn(m.nrows(), m.ncols(), |p, l| {
            m[((rows - 1 - p / columns) * columns + p % columns, l)]
        })
    });
    let permuted = both(&|m| {
        let n = m.ncols();
        Matrix::from_fn(m.nrows(), n, |p, l| m[(p, (l + 1) % n)])
    });
    let counts = both(&|m| m * 1e15);
    let shifted = scene.with_shifted_spots([0.5, 0.0]).unwrap();
    let elsewhere = MatrixModel::new(&shifted, Kernel::Physical, Some([4, 4])).unwrap();
    let published = MatrixModel::new(&scene, Kernel::Published, Some([4, 4])).unwrap();
    let own = (right.phi.clone(), right.stderr.clone());
    for (fault, model, (phi, stderr)) in [
        ("upside down", &model, &upside_down),
        ("permuted", &model, &permuted),
        ("counts", &model, &counts),
        ("elsewhere", &elsewhere, &own),
        ("published", &published, &own),
    ] {
        let mut told = 0;
        for (method, outcome) in by_every_method(model, phi, Some(stderr)) {
            let Ok(object) = outcome else { continue };
            assert!(
                loud(&object) && object.contradicted(),
                "{fault} {method}: {object:?}"
            );
            told += 1;
        }
        assert!(told >= 8, "{fault}: {told} recovered");
    }
    // Of counts no noise is needed to see it, unless bounds or levels hide it.
    for (method, outcome) in by_every_method(&model, &counts.0, None) {
        let Ok(object) = outcome else { continue };
        let first = &object.warnings[0];
        assert!(
            first.contains("CANNOT BE JUDGED") && object.fit.is_none(),
            "{method}"
        );
        let second = object.warnings.iter().skip(1);
        let second: Vec<&String> = second
            .filter(|w| w.contains("on a bound") || w.contains("beyond 0 to 1"))
            .collect();
        assert!(
            !second.is_empty() || method == Method::JointTwoValued,
            "{method}"
        );
    }
}

/// Right photographs but for one entry, five times as bright, whose standard error is given as 0:
/// it moves the picture and no test sees it, so it is among what is to be checked; and of numbers
/// that fit worse than reflectances do, nothing is said.
#[test]
fn a_wrong_entry_without_an_error_is_among_the_cures() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    let mut right = Photographs::relative(&model.phi(), 1e-3, 1);
    right.phi[(2, 3)] *= 5.0;
    right.stderr[(2, 3)] = 0.0;
    for (method, outcome) in by_every_method(&model, &right.phi, Some(&right.stderr)) {
        let Ok(object) = outcome else { continue };
        if method != Method::Joint {
            continue;
        }
        let told = object.warnings.join(" ");
        assert!(told.contains("DOES NOT FIT, by any method"), "{told}");
        assert!(told.contains("whose standard error is 0"), "{told}");
        assert!(!told.contains("no numbers at all"), "{told}");
    }
}

/// Right photographs with an entry whose standard error is given as 0: the picture fits, and it is
/// said that no test sees that entry.
#[test]
fn entries_that_no_test_sees_are_counted() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    let mut right = Photographs::relative(&model.phi(), 1e-3, 1);
    let told = |stderr: &Matrix| {
        let found = by_every_method(&model, &right.phi, Some(stderr));
        let joint = found
            .into_iter()
            .find(|(method, _)| *method == Method::Joint);
        joint.unwrap().1.unwrap().warnings.join(" ")
    };
    assert!(!told(&right.stderr).contains("standard error of 0"));
    let all = right.stderr.len();
    right.stderr[(2, 3)] = 0.0;
    let words = told(&right.stderr);
    assert!(
        words.contains(&format!("1 of {all} entries that the surface lights")),
        "{words}"
    );
}

/// Right photographs: nothing contradicts, and `joint` fits.
#[test]
fn right_photographs_are_not_warned_of() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    for seed in 1..6 {
        let right = Photographs::relative(&model.phi(), 1e-3, seed);
        for (method, outcome) in by_every_method(&model, &right.phi, Some(&right.stderr)) {
            let Ok(object) = outcome else { continue };
            assert!(!object.contradicted(), "{method}: {object:?}");
            assert!(object.fit.is_some());
            let joint = [Method::Joint, Method::JointUnbounded, Method::Nnls];
            assert!(
                !joint.contains(&method) || !loud(&object),
                "{method}: {object:?}"
            );
        }
    }
}

/// One entry of all is 10 standard errors too bright: it is named, and without it none is.
#[test]
fn an_entry_that_noise_does_not_explain_is_named() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let right = Photographs::relative(&model.phi(), 1e-3, 4);
    for off in [0.0, 10.0] {
        let mut phi = right.phi.clone();
        phi[(5, 3)] += off * right.stderr[(5, 3)];
        for (method, outcome) in by_every_method(&model, &phi, Some(&right.stderr)) {
            let Ok(object) = outcome else { continue };
            let named = |w: &&String| w.contains("the entry of pixel 5 and spot 3 lies");
            let told = object.warnings.iter().filter(named).count();
            // Where a method leaves light of many entries over none of them is to blame.
            let fits = object
                .fit
                .as_ref()
                .is_some_and(|fit| fit.chi2_per_dof < 5.0);
            let expected = usize::from(off > 0.0 && fits);
            assert_eq!(told, expected, "{method} {off}: {:?}", object.warnings);
        }
    }
}

/// One frame of another spot, or one pixel that is dark in all, is named with the cure, beside
/// another method's misfit too; none of photographs that are right, and of all frames in another
/// order.
#[test]
fn a_frame_or_pixel_that_is_not_of_the_others_is_named() {
    let scene = small("bench");
    let model = MatrixModel::new(&scene, Kernel::Physical, Some([2, 2])).unwrap();
    for seed in 1..4 {
        let right = Photographs::relative(&model.phi(), 1e-2, seed);
        let of = |from: &dyn Fn(usize, usize) -> f64| {
            let (pixels, spots) = right.phi.shape();
            Matrix::from_fn(pixels, spots, from)
        };
        let spots = right.phi.ncols();
        let displaced = of(&|p, l| right.phi[(p, if l == 5 { 11 } else { l })]);
        let hot = of(&|p, l| right.phi[(p, l)] * if p == 3 { 1.5 } else { 1.0 });
        let permuted = of(&|p, l| right.phi[(p, (5 * l + 3) % spots)]);
        let all = [
            (&right.phi, None),
            (&displaced, Some("photograph of spot 5: has")),
            (&hot, Some("for pixel 3: has")),
            (&permuted, None),
        ];
        for (k, (phi, due)) in all.into_iter().enumerate() {
            let own = (Method::JointUnbounded, &Options::default());
            let found = recovered(&model, phi, (&right.stderr, Certainty::STATED), own);
            assert_eq!(found.contradicted(), k > 0, "{seed} {k}");
            let named = found.warnings.iter().find(|w| w.contains("% of χ²"));
            assert_eq!(named.is_some(), due.is_some(), "{seed} {k} {named:?}");
            let told = named.map_or("", String::as_str);
            assert!(told.contains(due.unwrap_or("")), "{seed} {k} {told}");
        }
    }
}
