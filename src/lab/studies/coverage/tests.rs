use super::*;
use crate::lab::finding::{Describe, Tone};
use crate::lab::study::tests::{divides, refuses, small};
use crate::model::Kernel;
use crate::recovery::{BandKind, Bands};

#[test]
fn bands_that_cover_too_little_are_named() {
    let row = |method: &str, covered: Option<f64>, stderr| CoverageRow {
        method: method.to_owned(),
        covered,
        stderr,
        ..CoverageRow::default()
    };
    let of = |rows: Vec<CoverageRow>| {
        let found = Coverage {
            scene: "bench".to_owned(),
            scene_hash: String::new(),
            noise: 0.01,
            confidence: 0.95,
            seeds: 10,
            elements: 4,
            rows,
        };
        found.describe()
    };
    let found = of(vec![
        row("joint", Some(0.93), Some(0.01)),
        row("tsvd", Some(0.6), Some(0.01)),
        row("none", None, None),
    ]);
    assert_eq!(found.tone, Tone::Bad);
    for words in [
        "Of 10 draws",
        "are not shown to cover the true reflectance less often than stated: joint 93.0 % ± 1.0;",
        "standard errors: tsvd 60.0 % ± 1.0. 1 of the methods gave no bands.",
    ] {
        assert!(found.sentence.contains(words), "{}", found.sentence);
    }
    // One draw tells nothing of how often, be it of all elements or of few.
    for covered in [0.0, 1.0] {
        let found = of(vec![row("pinv", Some(covered), None)]);
        assert_eq!(found.tone, Tone::Plain);
        let said = format!(
            "tell nothing, as of one draw: pinv {:.1} %.",
            100.0 * covered
        );
        assert!(found.sentence.ends_with(&said), "{}", found.sentence);
    }
}

/// Twelve seeds are a full task and a rest.
#[test]
fn it_divides() {
    let scene = small("bench");
    let model = MatrixModel::new(&scene, Kernel::Physical, Some([2, 2])).unwrap();
    let plan = CoveragePlan {
        noise: 0.01,
        confidence: 0.95,
        methods: vec![Method::Pinv, Method::Joint],
        seeds: 12,
        first_seed: 5,
    };
    let tasks = CoverageTasks::new(("name", "hash"), model, plan);
    assert_eq!(divides(&tasks).rows.len(), 2);
    refuses(&tasks, 1, &(0..3).map(|_| Err(String::new())).collect());
}

/// Of ten recoveries that all cover, the share is 1 and its error that of Laplace's rule, 1/12.
#[test]
fn draws_that_agree_are_not_certain() {
    let trial = || -> Result<Trial, String> {
        Ok(Trial {
            bands: Some(Bands {
                confidence: 0.95,
                intervals: vec![[0.0, 1.0]; 2],
                kind: BandKind::Posterior,
            }),
            reflectance: vec![0.5; 2],
        })
    };
    let mut trials: Vec<_> = (0..10).map(|_| trial()).collect();
    let found = row(Method::JointGp, &[0.2, 0.7], &trials);
    assert_eq!(found.covered, Some(1.0));
    assert!((found.stderr.unwrap() * 12.0 - 1.0).abs() < 1e-12);
    // Two of ten whose photographs nothing explains cover nothing.
    for trial in trials.iter_mut().take(2).flatten() {
        trial.bands = None;
    }
    let found = row(Method::Joint, &[0.2, 0.7], &trials);
    assert_eq!(
        (found.covered, found.least, found.together),
        (Some(0.8), Some(0.8), Some(0.8))
    );
    assert_eq!(
        (found.refuted, found.failed, found.width),
        (2, 0, Some(1.0))
    );
}
