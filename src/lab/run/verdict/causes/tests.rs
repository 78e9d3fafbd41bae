use super::*;
use crate::lab::comparison::score::PictureFit;

fn deviation(chi2_per_dof: f64) -> Deviation {
    Deviation {
        name: "hinge angle".to_owned(),
        unit: "deg".to_owned(),
        value: 6.4,
        stderr: 3e-4,
        bias: 0.0,
        z: 2e4,
        p: 0.0,
        detectable: 1e-3,
        reach: None,
        chi2_per_dof,
        same: Vec::new(),
        spot: None,
        is_followed: true,
    }
}

/// A parameter that takes the excess of χ² is the cause; one that leaves it is none, however
/// large its fit is against its error.
#[test]
fn what_leaves_the_difference_is_no_cause() {
    let cause = |left: f64, whole: f64| {
        let likely = vec![deviation(left)];
        let score = Score {
            likely,
            ..Score::default()
        };
        score.cause(whole, 1000.0, 1e-3)
    };
    for (left, whole, named) in [(3e5, 4e5, false), (1.05, 40.0, true), (90.0, 1e4, true)] {
        let told = cause(left, whole);
        assert_eq!(!told.starts_with("no single parameter"), named, "{told}");
        assert!(told.contains("hinge angle"), "{told}");
    }
}

/// What would have to be larger than any scene has it is said to be unseen.
#[test]
fn what_no_scene_can_have_is_not_detected() {
    let told = |reach: Option<f64>| {
        let score = Score {
            deviations: vec![Deviation {
                reach,
                ..deviation(1.0)
            }],
            ..Score::default()
        };
        score.detectable()
    };
    assert_eq!(told(Some(90.0)), "hinge angle 0.0010\u{a0}deg");
    assert_eq!(told(None), told(Some(90.0)));
    assert_eq!(
        told(Some(1e-4)),
        "hinge angle never (a scene cannot have so much of it)"
    );
}

/// What leaves more than chance explains not all, and says so; a factor of all light is turned into
/// the albedo that makes it, of light that meets the wall twice: (1 − 0.968)² = 0.001.
#[test]
fn what_explains_not_all_says_so() {
    let told = |left: f64| {
        let likely = vec![Deviation {
            value: -99.9,
            unit: "%".to_owned(),
            same: vec![("albedo of `wall`".to_owned(), 0.5)],
            ..deviation(left)
        }];
        let score = Score {
            likely,
            ..Score::default()
        };
        score.cause(40.0, 1000.0, 1e-3)
    };
    assert!(!told(1.02).contains("more than chance"), "{}", told(1.02));
    assert!(
        told(1.02).contains("its ± if nothing else is off"),
        "{}",
        told(1.02)
    );
    assert!(told(1.3).contains("more than chance"), "{}", told(1.3));
    assert!(
        told(1.02).contains("albedo of `wall` −96.8"),
        "{}",
        told(1.02)
    );
}

/// Which of a picture and a parameter explains what the other leaves stands first, or that neither
/// does, or that they are not told apart.
#[test]
fn a_picture_is_named_by_what_it_explains() {
    let told = |left: f64, misses: f64, is_missed: bool| {
        let picture = PictureFit {
            elements: 64,
            free: 10,
            chi2_per_dof: left,
            misses,
            is_missed,
        };
        let score = Score {
            likely: vec![deviation(1.0)],
            picture: Some(picture),
            ..Score::default()
        };
        score.cause(40.0, 1000.0, 1e-3)
    };
    let [first, single] = ["another picture than the scene's", "hinge angle +6.40"];
    for (left, misses, is_missed, starts, holds) in [
        (1.0, 3.0, true, first, "of single parameters hinge angle"),
        (1.3, 3.0, true, first, "leave χ²/dof 1.300, which is more"),
        (1.0, 5.0, false, single, "explains less"),
        (1.0, -3.0, false, single, "not told from another picture"),
        (1.0, -5.0, true, single, "each explain"),
        (20.0, 3.0, true, single, "does not explain it"),
    ] {
        let words = told(left, misses, is_missed);
        assert!(words.starts_with(starts), "{words}");
        assert!(words.contains(holds), "{words}");
        assert!(words.contains(&format!("χ²/dof {left}")), "{words}");
    }
}

/// Light of occluders that the model does not have is named first where no single parameter
/// explains the difference, and not where one does.
#[test]
fn light_of_occluders_is_named_where_nothing_else_explains_it() {
    let mut agreement = crate::lab::sample::run("bench").agreement.unwrap();
    (agreement.chi2_per_dof, agreement.dof) = (1e4, 1000.0);
    agreement.sent_on = Some("`floor`".to_owned());
    let told = |left: f64| {
        let score = Score {
            likely: vec![deviation(left)],
            ..Score::default()
        };
        agreement.cause(&score)
    };
    assert!(
        told(9e3).starts_with("light that `floor` send on"),
        "{}",
        told(9e3)
    );
    assert!(told(1.0).starts_with("hinge angle"), "{}", told(1.0));
}
