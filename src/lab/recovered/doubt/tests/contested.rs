//! Pictures that others contest.

use super::*;
use crate::lab::sample::fit;

/// Elements about two levels, and on them: at the same noise the first are told from two
/// reflectances and have errors that hold all the same, the second are taken for two.
#[test]
fn greys_about_two_levels_are_told_from_two_levels() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    let level = |j: usize| if j % 4 == j / 4 || j < 4 { 0.8 } else { 0.2 };
    let off = |j: usize| 0.12 * libm::sin(7.0 * j as f64);
    for grey in [true, false] {
        let truth: Vec<f64> = (0..16)
            .map(|j| level(j) + if grey { off(j) } else { 0.0 })
            .collect();
        let of = MatrixModel {
            albedo: truth.clone(),
            ..model.clone()
        };
        for seed in 1..4 {
            let right = Photographs::relative(&of.phi(), 1e-3, seed);
            let known = (&right.stderr, Certainty::STATED);
            let two = (Method::JointTwoValued, &Options::default());
            let found = recovered(&of, &right.phi, known, two);
            let assumed = found.patterns.as_ref().unwrap().assumed();
            let exact = assumed.exact.unwrap();
            let told = found
                .warnings
                .iter()
                .any(|w| w.contains("exactly two reflectances"));
            assert!(told == grey && (exact < 0.5) == grey, "{seed}: {exact}");
            let errors = found.standard_error.as_ref().unwrap();
            for (j, error) in errors.iter().enumerate() {
                let z = (found.reflectance[j] - truth[j]) / error;
                assert!(z.abs() < 4.0, "{grey} {seed} {j}: {z}");
            }
        }
    }
}

/// Little noise leaves one pattern; more of it leaves many, and the one that is shown says so.
#[test]
fn a_pattern_that_is_one_of_many_says_so() {
    let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
    model.albedo = (0..16)
        .map(|j: usize| if (j * 7 + j / 4) % 3 == 1 { 0.8 } else { 0.2 })
        .collect();
    let options = Options {
        levels: Some([0.2, 0.8]),
        ..Options::default()
    };
    for (level, many) in [(1e-4, false), (0.3, true)] {
        let of = Photographs::relative(&model.phi(), level, 5);
        let known = (&of.stderr, Certainty::STATED);
        let found = recovered(&model, &of.phi, known, (Method::JointTwoValued, &options));
        let told = found.warnings.iter().any(|w| w.contains("one of many"));
        assert_eq!(
            told, many,
            "{level}: {:?} {:?}",
            found.patterns, found.warnings
        );
    }
}

/// Two pictures of the same photographs that lie apart by more than their errors are both
/// contested; where one is far likelier, the other alone; and those that agree are not.
#[test]
fn pictures_that_contradict_each_other_are_told() {
    let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
    let right = Photographs::relative(&model.phi(), 1e-3, 4);
    let problem = crate::lab::problem::problem(&model, &right.phi, Some(&right.stderr)).unwrap();
    let grids = [[2, 2]];
    let problem = problem.with_grids(&grids).unwrap();
    let methods = [Method::JointGp, Method::JointUnbounded];
    let found = methods.map(|m| crate::recovery::recover(m, &problem, &Options::default()));
    let mut found = found.map(Result::unwrap);
    let fit = Fit {
        dof: 200.0,
        p: 0.5,
        entries: 200,
        ..fit(1.0)
    };
    let contested = |found: &[Recovered; 2]| {
        let mut judged = [(); 2].map(|()| Judged {
            fit: Some(fit.clone()),
            ..Judged::default()
        });
        let [a, b] = &mut judged;
        contest(&mut [(&found[0], a), (&found[1], b)]);
        judged.map(|j| j.against.map(|rival| rival.method))
    };
    assert_eq!(contested(&found), [None, None]);
    let errors = found[0].standard_error.clone().unwrap();
    found[0].reflectance += errors * 10.0;
    let [gp, unbounded] = [Some(Method::JointGp), Some(Method::JointUnbounded)];
    assert_eq!(contested(&found), [unbounded, gp]);
    for (ahead, expected) in [
        (5.0, [unbounded, gp]),
        (20.0, [None, gp]),
        (-20.0, [unbounded, None]),
    ] {
        found[0].log_evidence = Some(-3.0);
        found[1].log_evidence = Some(-3.0 - ahead);
        assert_eq!(contested(&found), expected, "{ahead}");
    }
    // Two levels that lie close to a wider picture are told where evidence does not settle it.
    found[1].method = Method::JointTwoValued;
    found[1].reflectance = found[0].reflectance.clone();
    found[1].standard_error = found[0].standard_error.as_ref().map(|s| s / 20.0);
    // Alike neighbours that two levels make less likely are told by themselves.
    let levels = Some(Method::JointTwoValued);
    for (ahead, expected) in [
        (2.0, [None, gp]),
        (5.0, [levels, gp]),
        (20.0, [levels, None]),
    ] {
        found[1].log_evidence = found[0].log_evidence.map(|e| e + ahead);
        assert_eq!(contested(&found), expected, "{ahead}");
    }
}
