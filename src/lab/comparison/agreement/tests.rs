use super::*;
use crate::lab::comparison::misplaced::normal;
use crate::lab::comparison::score::{Derivatives, Parameter};
use crate::lab::uncertainty::certainty::Certainty;
use crate::num::stream::{Key, Sampling, Stream};

const ROWS: usize = 40;
const COLUMNS: usize = 30;
const REPLICATES: u32 = 16;

/// Of these alone.
fn alone<'a>(traced: &'a Matrix, stderr: &'a Matrix, model: &'a Matrix) -> Evidence<'a> {
    Evidence {
        traced,
        stderr,
        model,
        bound: None,
        left_out: None,
        eliminated: None,
    }
}

/// Normal replicates around 1 with standard deviation 0.04, their mean and standard error;
/// `shared` gives all entries of a row the same noise.
fn sample(seed: u64, shared: bool) -> (Matrix, Matrix) {
    let mut traced = Matrix::zeros(ROWS, COLUMNS);
    let mut stderr = Matrix::zeros(ROWS, COLUMNS);
    for p in 0..ROWS {
        for l in 0..COLUMNS {
            let spot = if shared { 0 } else { l as u32 };
            let mut stream = Stream::new(
                Sampling::Pcg,
                Key {
                    seed,
                    spot,
                    pixel: p as u32,
                    block: 0,
                },
            );
            let replicates: Vec<f64> = (0..REPLICATES)
                .map(|_| {
                    // Box–Muller.
                    let [a, b, ..] = stream.next_four();
                    1.0 + 0.04 * (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
                })
                .collect();
            let (mean, error) = mean_and_stderr(&replicates);
            traced[(p, l)] = mean;
            stderr[(p, l)] = error;
        }
    }
    (traced, stderr)
}

fn verdict(
    seed: u64,
    model: f64,
    bound: Option<f64>,
    errors: Errors,
    significance: f64,
) -> Agreement {
    let (traced, stderr) = sample(seed, errors == Errors::WithinRows);
    let model = Matrix::from_element(ROWS, COLUMNS, model);
    let bound = bound.map(|b| Matrix::from_element(ROWS, COLUMNS, b));
    let evidence = Evidence {
        traced: &traced,
        stderr: &stderr,
        model: &model,
        bound: bound.as_ref(),
        left_out: None,
        eliminated: None,
    };
    agree(
        evidence,
        Test {
            significance,
            known: Certainty::new(errors, Some(REPLICATES)),
        },
        None,
    )
    .0
}

/// False alarms on a right model: 400 trials at 10 % give 40 ± 6; 99.9 % of the binomial lies
/// in 21 … 61. The share of the largest |z| (5 %) shrinks with the correlation, to 5 % in 30
/// where rows are all one: 5.2 % remain, 6 … 37.
#[test]
#[ignore = "slow"]
fn false_alarms_come_at_the_stated_rate() {
    let alarms = |errors| {
        (0..400)
            .filter(|s| !verdict(*s, 1.0, None, errors, 0.1).agrees)
            .count()
    };
    let independent = alarms(Errors::Independent);
    assert!(
        (21..=61).contains(&independent),
        "{independent} of 400 at 10 %"
    );
    let shared = alarms(Errors::WithinRows);
    assert!((6..=37).contains(&shared), "{shared} of 400 at 5.2 %");
}

#[test]
fn chi_square_is_one_per_degree_of_freedom() {
    let mean = (0..20)
        .map(|s| verdict(s, 1.0, None, Errors::Independent, 0.01).chi2_per_dof)
        .sum::<f64>()
        / 20.0;
    // 24 000 values of z², each of variance 2: standard error 0.009.
    assert!((mean - 1.0).abs() < 0.04, "{mean}");
}

/// Noise of 1 % (0.04/√16): a model off by 1 % is rejected by both kinds of test, and accepted
/// under a bound of 1 %.
#[test]
fn wrong_models_are_rejected_unless_their_bound_covers_it() {
    for errors in [Errors::Independent, Errors::WithinRows] {
        assert!(!verdict(1, 1.01, None, errors, 0.001).agrees);
        assert!(verdict(1, 1.01, Some(0.01), errors, 0.001).agrees);
    }
}

#[test]
fn entries_without_error_are_compared_to_rounding() {
    let traced = Matrix::from_element(2, 2, 1.0);
    let zero = Matrix::zeros(2, 2);
    let test = Test {
        significance: 0.01,
        known: Certainty::new(Errors::Independent, Some(32)),
    };
    for (value, agrees) in [
        (1.0, true),
        (1.0 + 2e-16, true),
        (1.0 + 1e-10, false),
        (0.0, false),
    ] {
        let model = Matrix::from_element(2, 2, value);
        let evidence = Evidence {
            traced: &traced,
            stderr: &zero,
            model: &model,
            bound: None,
            left_out: None,
            eliminated: None,
        };
        let (verdict, z) = agree(evidence, test, None);
        assert_eq!(verdict.agrees, agrees, "{value}");
        assert!(z.iter().all(|z| z.is_finite()));
    }
    let (nothing, _) = agree(
        Evidence {
            traced: &zero,
            stderr: &zero,
            model: &zero,
            bound: None,
            left_out: None,
            eliminated: None,
        },
        test,
        None,
    );
    assert!(!nothing.agrees && !nothing.evidence);
}

/// Agreement with a model that may be off by most of itself is no evidence; disagreement beyond all
/// of that is.
#[test]
fn agreement_within_a_bound_of_half_the_model_is_no_evidence() {
    let of = |model: f64, bound: f64| verdict(1, model, Some(bound), Errors::Independent, 1e-3);
    let known = of(1.2, 0.4 * 1.2);
    assert!(known.evidence && known.agrees);
    let vague = of(1.2, 0.6 * 1.2);
    assert!(!vague.evidence && !vague.agrees);
    let words = "no evidence on the  model: of its light 60 % may be";
    assert!(vague.verdict().starts_with(words), "{}", vague.verdict());
    let wrong = of(4.0, 0.6 * 4.0);
    assert!(wrong.evidence && !wrong.agrees);
}

/// Standard errors that are three times too large refuse nothing, and the verdict says that they
/// are; of right ones it says nothing, whether entries share them or not.
#[test]
fn errors_that_are_too_large_are_told() {
    for errors in [Errors::Independent, Errors::WithinRows] {
        for seed in 0..20 {
            let (traced, stderr) = sample(seed, errors == Errors::WithinRows);
            let model = Matrix::from_element(ROWS, COLUMNS, 1.0);
            let told = |times: f64| {
                let stderr = &stderr * times;
                let evidence = alone(&traced, &stderr, &model);
                let test = Test {
                    significance: 1e-3,
                    known: Certainty::new(errors, Some(REPLICATES)),
                };
                let facts = agree(evidence, test, None).0.facts();
                let own = facts.into_iter().find(|(name, _)| *name == "errors");
                own.map(|(_, words)| words)
            };
            assert_eq!(told(1.0), None, "{errors:?} {seed}");
            if errors == Errors::Independent {
                let words = told(3.0).unwrap();
                let (_, about) = words.split_once("are about ").unwrap();
                let (times, _) = about.split_once(" times").unwrap();
                let times: f64 = times.parse().unwrap();
                assert!(
                    words.contains("CLOSER") && (times / 3.0 - 1.0).abs() < 0.1,
                    "{words}"
                );
            }
        }
    }
}

/// A fluctuation of 0.4 % that all entries share, stated as 1 % of each entry's own: χ² is small,
/// the scale is rejected, and the verdict says that entries share their errors.
#[test]
fn a_deviation_of_what_entries_share_is_told() {
    let model = Matrix::from_element(ROWS, COLUMNS, 1.0);
    let (traced, stderr) = (&model * 1.004, &model * 0.01);
    let scale = Parameter {
        name: "overall scale".to_owned(),
        unit: "%".to_owned(),
        reach: None,
        same: Vec::new(),
        each_spot: None,
    };
    let slope = &model * 0.01;
    let derivatives = Derivatives {
        parameters: &[scale],
        of: &|_| Some(slope.clone()),
        moved: &|_, size| Some([&slope * size, slope.clone()]),
        picture: None,
        bends: false,
        are_named: true,
    };
    let evidence = alone(&traced, &stderr, &model);
    let test = Test {
        significance: 1e-3,
        known: Certainty::STATED,
    };
    let found = agree(evidence, test, Some(&derivatives)).0;
    assert!(!found.agrees && found.chi2_per_dof < 0.2);
    let errors = found
        .facts()
        .into_iter()
        .find(|(name, _)| *name == "errors");
    let (_, words) = errors.unwrap();
    assert!(
        words.contains("CLOSER") && words.contains("What entries share"),
        "{words}"
    );
}

/// Frames that are dark, traced and modelled, change nothing: χ², its freedom and what the largest
/// |z| may be are those of the other frames alone, and nothing is said of the standard errors.
#[test]
fn what_is_dark_in_both_is_no_evidence() {
    let (traced, stderr) = sample(3, false);
    let model = Matrix::from_element(ROWS, COLUMNS, 1.0);
    let test = Test {
        significance: 1e-3,
        known: Certainty::new(Errors::Independent, Some(REPLICATES)),
    };
    let of = |dark: usize| {
        let more = |m: &Matrix| m.clone().resize_horizontally(COLUMNS + dark, 0.0);
        let [traced, stderr, model] = [&traced, &stderr, &model].map(more);
        let evidence = alone(&traced, &stderr, &model);
        agree(evidence, test, None).0
    };
    let (all, dark) = (of(0), of(3 * COLUMNS));
    let told = |a: &Agreement| (a.chi2_per_dof, a.dof, a.z_limit, a.entries, a.facts().len());
    assert_eq!(told(&dark), told(&all));
    assert_eq!(dark.left_out, 3 * COLUMNS * ROWS);
}

/// Light that answers a shift to the left a quarter as much as one to the right: what is detected
/// either way is four times what a straight model needs; of light that is straight it is that.
#[test]
fn what_is_detected_is_so_either_way() {
    let (traced, stderr) = sample(1, false);
    let model = Matrix::from_element(ROWS, COLUMNS, 1.0);
    let evidence = alone(&traced, &stderr, &model);
    let test = Test {
        significance: 1e-3,
        known: Certainty::STATED,
    };
    let slope = Matrix::from_fn(ROWS, COLUMNS, |p, l| libm::sin((p + 3 * l) as f64));
    let shift = Parameter {
        name: "view, x".to_owned(),
        unit: "in".to_owned(),
        reach: None,
        same: Vec::new(),
        each_spot: None,
    };
    let detected = |left: f64, bends: bool| {
        let change = |size: f64| &slope * (if size < 0.0 { left * size } else { size });
        let derivatives = Derivatives {
            parameters: std::slice::from_ref(&shift),
            of: &|_| Some(slope.clone()),
            moved: &|_, size| Some([change(size), slope.clone()]),
            bends,
            picture: None,
            are_named: true,
        };
        let found = agree(evidence, test, Some(&derivatives)).0;
        found.score.unwrap().deviations[0].detectable
    };
    let straight = detected(1.0, false);
    for (left, more) in [(1.0, 1.0), (0.25, 4.0), (1.5, 1.0)] {
        let found = detected(left, true) / straight;
        assert!((found / more - 1.0).abs() < 0.01, "{left}: {found}");
    }
}

/// Noise that is a share of each entry, stated as one size for all, is told to grow with the light,
/// whether χ² is right or not; of right errors nothing is said.
#[test]
fn errors_that_do_not_go_with_the_light_are_told() {
    let model = Matrix::from_fn(40, 10, |p, l| libm::exp(libm::sin((7 * p + l) as f64)));
    let own = &model * 0.01;
    let alike = model.map(|_| (own.norm_squared() / 400.0).sqrt());
    for seed in 0..20 {
        let mut draw = normal(seed);
        let traced = model.zip_map(&own, |x, s| x + s * draw()[0]);
        let told = |stderr: &Matrix| {
            let evidence = alone(&traced, stderr, &model);
            let test = Test {
                significance: 1e-3,
                known: Certainty::STATED,
            };
            let facts = agree(evidence, test, None).0.facts();
            facts.iter().any(|(_, words)| words.contains("GROWS"))
        };
        assert!(told(&alike) && !told(&own), "{seed}");
    }
}
