//! The settings of `phicam recover`, checked.

use std::fmt::Display;

use super::args::RecoverArgs;
use super::console::Console;
use super::failure::Failure;
use crate::model::MatrixModel;
use crate::num::linalg::Tolerance;
use crate::recovery::{Method, Options, Uncertainty, WeightRule};

/// The options that the arguments describe, for `methods`.
pub(super) fn checked(args: &RecoverArgs, methods: &[Method]) -> Result<Options, Failure> {
    let positive = |x: f64| x > 0.0 && x.is_finite();
    let fraction = |x: f64| (0.0..1.0).contains(&x);
    within(
        "--noise",
        args.noise,
        positive,
        "positive: relative to the flux, e.g. 0.01",
    )?;
    within(
        "--damping",
        args.damping,
        |x| x >= 0.0 && x.is_finite(),
        "0 or more: a fraction of σ1",
    )?;
    within(
        "--tolerance",
        args.tolerance,
        fraction,
        "0 or more and below 1: a fraction of σ1",
    )?;
    within("--rank", args.rank, |k| k > 0, "at least 1")?;
    within(
        "--tv",
        args.joint.tv,
        |x| x >= 0.0 && x.is_finite(),
        "0 or more: a fraction of σ1²",
    )?;
    within(
        "--bands",
        args.bands,
        |x| x > 0.0 && x < 1.0,
        "above 0 and below 1: a probability, e.g. 0.95",
    )?;
    let deviation = |x: f64| x > 0.0 && x <= 1.0;
    let range = "above 0 and at most 1: a standard deviation relative to 1, e.g. 0.05";
    within("--frame-gain", args.joint.frame_gain, deviation, range)?;
    within("--scale-error", args.joint.scale_error, deviation, range)?;
    within("--memory", args.memory, positive, "positive: GiB, e.g. 4")?;
    used(args, methods)?;
    let mut options = Options {
        rank: args.rank,
        damping: args.damping,
        rule: args.rule,
        total_variation: args.joint.tv,
        levels: args.joint.levels,
        bands: args.bands,
        weighting: args.joint.weighting,
        ..Options::default()
    };
    if let Some(tolerance) = args.tolerance {
        options.tolerance = Tolerance::Relative(tolerance);
    }
    Ok(options)
}

/// Refuses a given value that is not `allowed`; `range` says in words what is.
fn within<T: Copy + Display>(
    name: &str,
    given: Option<T>,
    allowed: impl Fn(T) -> bool,
    range: &str,
) -> Result<(), Failure> {
    match given {
        Some(value) if !allowed(value) => Err(Failure::new(
            format!("{name} {value} has no meaning"),
            format!("use a number that is {range}"),
        )),
        _ => Ok(()),
    }
}

/// Refuses settings that none of the methods takes.
fn used(args: &RecoverArgs, methods: &[Method]) -> Result<(), Failure> {
    let joint = &args.joint;
    let any = |of: &[Method]| methods.iter().any(|m| of.contains(m));
    let all_joint = [
        Method::JointUnbounded,
        Method::Joint,
        Method::Nnls,
        Method::JointGp,
        Method::JointTv,
        Method::JointTwoValued,
    ];
    let damped = [Method::Tikhonov, Method::TikhonovGradient];
    let cutting = [
        Method::Pinv,
        Method::LeftInverse,
        Method::RightInverse,
        Method::Rdivide,
        Method::RdivideMinNorm,
        Method::JointUnbounded,
    ];
    let bounded = &all_joint[..5];
    let needs: [(&str, bool, &[Method]); 16] = [
        ("--rank", args.rank.is_some(), &[Method::Tsvd]),
        ("--damping", args.damping.is_some(), &damped),
        ("--tolerance", args.tolerance.is_some(), &cutting),
        ("--tv", joint.tv.is_some(), &[Method::JointTv]),
        (
            "--levels",
            joint.levels.is_some(),
            &[Method::JointTwoValued],
        ),
        (
            "--weighting none",
            joint.weighting == WeightRule::Unweighted,
            &all_joint,
        ),
        ("--frame-constant", joint.frame_constant, &all_joint),
        (
            "--frame-polynomial",
            joint.frame_polynomial.is_some(),
            &all_joint,
        ),
        (
            "--frame-patterns",
            joint.frame_patterns.is_some(),
            &all_joint,
        ),
        ("--left-out", args.left_out.is_some(), &all_joint),
        ("--background", joint.background, &all_joint),
        ("--free-scale", joint.free_scale, &all_joint),
        ("--frame-gain", joint.frame_gain.is_some(), &all_joint),
        ("--scale-error", joint.scale_error.is_some(), &all_joint),
        ("--occluder-light", joint.occluder_light, bounded),
        ("--glare-pattern", joint.glare_pattern.is_some(), &all_joint),
    ];
    match needs.iter().find(|(_, given, of)| *given && !any(of)) {
        None => Ok(()),
        Some((name, _, of)) => {
            let names: Vec<&str> = of.iter().map(|m| m.name()).collect();
            Err(Failure::new(
                format!("{name} means nothing to the methods asked for"),
                format!(
                    "ask for one that takes it (--method {}), or leave it out",
                    names.join(" or ")
                ),
            ))
        }
    }
}

/// How much of the uncertainty fits the elements of the model.
pub(super) fn uncertainty(model: &MatrixModel, console: Console) -> Uncertainty {
    let found = Uncertainty::of(model.laser_side.nrows());
    if found == Uncertainty::StandardError {
        console.say(format!(
            "more than {} elements: no covariance and no resolution of the methods that work pixel by pixel",
            Uncertainty::MOST_CORRELATED
        ));
    }
    found
}
