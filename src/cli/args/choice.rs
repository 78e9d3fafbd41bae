//! Options that take one of a few names, for the values of an enum of a floor below.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::num::named::Named;
use crate::photographs::set::ChannelName;
use crate::report::{Law, Map};

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

/// Parses a value by its name.
pub(super) fn named<T: Named + Clone + Send + Sync>() -> impl TypedValueParser<Value = T> {
    possible(T::NAMES).try_map(|name| T::by_name(&name).ok_or("no such value"))
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
