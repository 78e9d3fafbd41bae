//! Options that take one of a few names, for the values of an enum of a floor below.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::lab::options::{ESTIMATORS, SAMPLERS};
use crate::lab::{Errors, Integration};
use crate::model::Kernel;
use crate::num::stream::Sampling;
use crate::photographs::set::ChannelName;
use crate::recovery::{Rule, WeightRule};
use crate::report::{Law, Map};
use crate::transport::Estimator;

/// Parses one of `choices`: its name, its value, and what the help says of it.
pub(super) fn one_of<T: Clone + Send + Sync + 'static, const N: usize>(
    choices: [(&'static str, T, &'static str); N],
) -> impl TypedValueParser<Value = T> {
    let listed = choices.clone();
    let names = listed.map(|(name, _, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(names).try_map(move |given| {
        let found = choices.iter().find(|(name, ..)| *name == given);
        found
            .map(|(_, value, _)| value.clone())
            .ok_or("no such value")
    })
}

/// Values to choose from: their names, and what the help says of them.
pub(super) fn possible(names: &'static [(&'static str, &'static str)]) -> PossibleValuesParser {
    let value = |(name, help): &(&'static str, &'static str)| PossibleValue::new(*name).help(*help);
    PossibleValuesParser::new(names.iter().map(value))
}

pub(super) fn estimator() -> impl TypedValueParser<Value = Estimator> {
    possible(ESTIMATORS).try_map(|name| name.parse::<Estimator>())
}

pub(super) fn sampler() -> impl TypedValueParser<Value = Sampling> {
    possible(SAMPLERS).try_map(|name| name.parse::<Sampling>())
}

pub(super) fn kernel() -> impl TypedValueParser<Value = Kernel> {
    let kernels = [
        (Kernel::Physical, "The true cosine at the hidden surface"),
        (Kernel::Published, "The one in the published simulation"),
    ];
    one_of(kernels.map(|(kernel, help)| (kernel.name(), kernel, help)))
}

pub(super) fn channel() -> impl TypedValueParser<Value = ChannelName> {
    one_of([
        ("red", ChannelName::Red, "Red"),
        ("green", ChannelName::Green, "Green"),
        ("blue", ChannelName::Blue, "Blue"),
        (
            "mean",
            ChannelName::Mean,
            "The mean of the light in all three",
        ),
        ("all", ChannelName::All, "Each in a folder of its own"),
    ])
}

pub(super) fn integration() -> impl TypedValueParser<Value = Integration> {
    let integrations = [
        (
            Integration::Centres,
            "Elements, pixels and spots by their centres, with a bound on what that leaves out",
        ),
        (
            Integration::Quadrature,
            "Converged quadrature over elements, footprints and spots",
        ),
    ];
    one_of(integrations.map(|(integration, help)| (integration.name(), integration, help)))
}

pub(super) fn errors() -> impl TypedValueParser<Value = Errors> {
    one_of(Errors::ALL.map(|errors| {
        let help = match errors {
            Errors::Independent => "None",
            Errors::WithinRows => "Those of one pixel, as of estimator shared",
            Errors::Everywhere => "All, as of estimator factored",
        };
        (errors.name(), errors, help)
    }))
}

pub(super) fn rule() -> impl TypedValueParser<Value = Rule> {
    one_of(Rule::ALL.map(|rule| {
        let help = match rule {
            Rule::Discrepancy => "The strongest regularisation whose residual the noise explains",
            Rule::Gcv => "Generalised cross-validation; needs no noise model",
            Rule::LCurve => "The corner of the L-curve; needs no noise model",
        };
        (rule.name(), rule, help)
    }))
}

pub(super) fn weighting() -> impl TypedValueParser<Value = WeightRule> {
    one_of(WeightRule::ALL.map(|rule| {
        let help = match rule {
            WeightRule::Noise => "By the noise, where it is known",
            WeightRule::Entries => {
                "By the noise of each entry, as joint-gp and more than 512 elements have it"
            }
            WeightRule::Unweighted => "All alike",
        };
        (rule.name(), rule, help)
    }))
}

pub(super) fn law() -> impl TypedValueParser<Value = Law> {
    one_of([
        ("linear", Law::Linear, "Evenly"),
        ("log", Law::Logarithmic, "Evenly over the logarithm"),
    ])
}

pub(super) fn map() -> impl TypedValueParser<Value = Map> {
    one_of([
        ("grey", Map::Grey, "Black to white"),
        (
            "viridis",
            Map::Viridis,
            "Dark blue to yellow, perceptually uniform",
        ),
        (
            "diverging",
            Map::Diverging,
            "Blue, white, red: for signed values, symmetric about 0 unless --range is given",
        ),
    ])
}
