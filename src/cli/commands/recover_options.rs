//! The settings of `phicam recover`, checked.

use super::beside::refuse_meaningless;
use crate::cli::args::RecoverArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::settings::within;
use crate::lab::options::OptionError;
use crate::lab::{Integration, MOST_INTEGRATED};
use crate::model::{Kernel, MatrixModel};
use crate::num::linalg::Tolerance;
use crate::recovery::{Method, Options, Setting, Uncertainty};

/// The options that the arguments describe, for `methods` and so many elements.
pub(super) fn checked(
    args: &RecoverArgs,
    methods: &[Method],
    elements: usize,
) -> Result<Options, Failure> {
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
    refuse_idle(args, methods, elements)?;
    let mut options = Options {
        rank: args.rank,
        damping: args.damping,
        rule: args.rule.unwrap_or_default(),
        total_variation: args.joint.tv,
        levels: args.joint.levels,
        bands: args.bands,
        weighting: args.joint.weighting.unwrap_or_default(),
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
        (Setting::Rule, args.rule.is_some()),
        (Setting::Rank, args.rank.is_some()),
        (Setting::Damping, args.damping.is_some()),
        (Setting::Tolerance, args.tolerance.is_some()),
        (Setting::Tv, joint.tv.is_some()),
        (Setting::Levels, joint.levels.is_some()),
        (Setting::Bands, args.bands.is_some()),
        (Setting::Weighting, joint.weighting.is_some()),
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

/// Refuses what would change nothing beside other settings.
fn refuse_idle(args: &RecoverArgs, methods: &[Method], elements: usize) -> Result<(), Failure> {
    let chosen = |method: &Method| {
        Setting::Rule.means_something_to(*method)
            && (args.rank.is_none() || !Setting::Rank.means_something_to(*method))
            && (args.damping.is_none() || !Setting::Damping.means_something_to(*method))
    };
    if !methods.iter().any(chosen) {
        let why = "the parameter of each method is given (--rank, --damping)";
        OptionError::refuse_idle(&[("rule", args.rule.is_some())], why)?;
    }
    let asked = args.integration == Some(Integration::Quadrature);
    let why = if args.kernel == Kernel::Published {
        "the published kernel is by centres"
    } else if !methods.iter().any(|method| method.is_joint()) {
        "methods that work pixel by pixel are by centres"
    } else if elements > MOST_INTEGRATED {
        "more than 1024 elements are by centres"
    } else {
        return Ok(());
    };
    Ok(OptionError::refuse_idle(&[("integration", asked)], why)?)
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
