//! The settings of `phicam recover`, checked.

use super::beside::refuse_meaningless;
use crate::cli::args::RecoverArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::settings::within;
use crate::model::MatrixModel;
use crate::num::linalg::Tolerance;
use crate::recovery::{Method, Options, Setting, Uncertainty, WeightRule};

/// The options that the arguments describe, for `methods`.
pub(super) fn checked(args: &RecoverArgs, methods: &[Method]) -> Result<Options, Failure> {
    let joint = &args.joint;
    for (setting, given) in [
        (Setting::Noise, args.noise),
        (Setting::Damping, args.damping),
        (Setting::Tolerance, args.tolerance),
        (Setting::Rank, args.rank.map(|k| k as f64)),
        (Setting::Tv, joint.tv),
        (Setting::Bands, args.bands),
    ] {
        let allows = |value: f64| setting.allows(value);
        within(
            setting.name(),
            given,
            allows,
            setting.range().unwrap_or_default(),
        )?;
    }
    refuse_meaningless(&args.beside)?;
    let positive = |x: f64| x > 0.0 && x.is_finite();
    within("memory", args.memory, positive, "positive: GiB, e.g. 4")?;
    used(args, methods)?;
    let mut options = Options {
        rank: args.rank,
        damping: args.damping,
        rule: args.rule,
        total_variation: args.joint.tv,
        levels: args.joint.levels,
        bands: args.bands,
        weighting: args.joint.weighting,
        error_field: args.joint.error_field,
        ..Options::default()
    };
    if let Some(tolerance) = args.tolerance {
        options.tolerance = Tolerance::Relative(tolerance);
    }
    Ok(options)
}

/// Refuses settings that none of the methods takes.
fn used(args: &RecoverArgs, methods: &[Method]) -> Result<(), Failure> {
    let (joint, beside) = (&args.joint, &args.beside);
    let given = [
        (Setting::Rank, args.rank.is_some()),
        (Setting::Damping, args.damping.is_some()),
        (Setting::Tolerance, args.tolerance.is_some()),
        (Setting::Tv, joint.tv.is_some()),
        (Setting::Levels, joint.levels.is_some()),
        (Setting::Bands, args.bands.is_some()),
        (
            Setting::Weighting,
            joint.weighting == WeightRule::Unweighted,
        ),
        (Setting::ErrorField, joint.error_field),
        (Setting::FrameConstant, beside.frame_constant),
        (Setting::FramePolynomial, beside.frame_polynomial.is_some()),
        (Setting::FramePatterns, beside.frame_patterns.is_some()),
        (Setting::LeftOut, args.left_out.is_some()),
        (Setting::Background, beside.background),
        (Setting::FreeScale, beside.free_scale),
        (Setting::FrameGain, beside.frame_gain.is_some()),
        (Setting::ScaleError, beside.scale_error.is_some()),
        (Setting::OccluderLight, joint.occluder_light),
        (Setting::GlarePattern, beside.glare_pattern.is_some()),
    ];
    let idle = |setting: Setting| !methods.iter().any(|m| setting.means_something_to(*m));
    match given
        .iter()
        .find(|(setting, given)| *given && idle(*setting))
    {
        None => Ok(()),
        Some((setting, _)) => {
            let names: Vec<&str> = setting.methods().iter().map(|m| m.name()).collect();
            Err(Failure::new(
                format!(
                    "--{} means nothing to the methods asked for",
                    setting.name()
                ),
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
