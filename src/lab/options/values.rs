//! The options of a study with their values.

use std::fmt::Display;
use std::str::FromStr;

use super::{Kind, Opt, OptionError, whole};
use crate::recovery::Method;

/// The options of a study with their values.
#[derive(Clone, Debug)]
pub struct Values(Vec<(&'static Opt, Vec<String>)>);

impl Values {
    /// The options as they are unless given.
    pub fn defaults(options: &'static [Opt]) -> Self {
        let default = |o: &'static Opt| {
            let values = o.default.iter().flat_map(|d| d.split(','));
            (o, values.map(str::to_owned).collect())
        };
        Self(options.iter().map(default).collect())
    }

    /// The same with other values of one option, each once.
    ///
    /// # Errors
    /// [`OptionError`], where there is no such option or a value is none of its values.
    pub fn with(mut self, name: &str, values: Vec<String>) -> Result<Self, OptionError> {
        let mut options = self.0.iter_mut();
        let Some((option, own)) = options.find(|(o, _)| o.name == name) else {
            let cause = format!("there is no option --{name}");
            return Err(OptionError::new(cause, "leave it out"));
        };
        values.iter().try_for_each(|value| option.check(value))?;
        // 1e4 is 10000 for whoever reads it as a whole number.
        let digits = |value: String| match option.kind {
            Kind::Whole(_) => whole(&value).map_or(value, |n| n.to_string()),
            _ => value,
        };
        own.clear();
        for value in values.into_iter().map(digits) {
            let is_there = |other: &String| match option.kind {
                Kind::Number => other.parse::<f64>() == value.parse::<f64>(),
                _ => *other == value,
            };
            if !own.iter().any(is_there) {
                own.push(value);
            }
        }
        Ok(self)
    }

    /// The values of an option.
    ///
    /// # Errors
    /// [`OptionError`], where one is none of this type.
    pub fn list<T: FromStr<Err: Display>>(&self, name: &str) -> Result<Vec<T>, OptionError> {
        let own = self.0.iter().find(|(o, _)| o.name == name);
        let values = own.into_iter().flat_map(|(_, values)| values);
        let read = |text: &String| text.parse().map_err(|e: T::Err| OptionError(e.to_string()));
        values.map(read).collect()
    }

    /// The value of an option that may have none.
    ///
    /// # Errors
    /// [`OptionError`], where it is none of this type.
    pub fn maybe<T: FromStr<Err: Display>>(&self, name: &str) -> Result<Option<T>, OptionError> {
        Ok(self.list(name)?.pop())
    }

    /// The value of an option.
    ///
    /// # Errors
    /// [`OptionError`], where it has none, or one of another type.
    pub fn one<T: FromStr<Err: Display>>(&self, name: &str) -> Result<T, OptionError> {
        let none = || OptionError::new(format!("--{name} has no value"), "give it one");
        self.maybe(name)?.ok_or_else(none)
    }

    /// Refuses values of these options other than they have unless given: beside those of the
    /// others they would change nothing.
    ///
    /// # Errors
    /// The option, and `why`.
    pub fn refuse_idle(&self, names: &[&str], why: &str) -> Result<(), OptionError> {
        let own = |(option, values): &(&'static Opt, Vec<String>)| {
            let usual = option.default.iter().flat_map(|d| d.split(','));
            let is_idle = names.contains(&option.name) && !usual.eq(values.iter());
            (option.name, is_idle)
        };
        let options: Vec<_> = self.0.iter().map(own).collect();
        OptionError::refuse_idle(&options, why)
    }

    /// Numbers of checks or elements a side, sorted, each once.
    ///
    /// # Errors
    /// [`OptionError`].
    pub fn sides(&self, name: &str) -> Result<Vec<usize>, OptionError> {
        let mut sides = self.list(name)?;
        sides.sort_unstable();
        sides.dedup();
        Ok(sides)
    }

    /// The recovery methods of `--method`, each once, in the order of [`Method::ALL`].
    ///
    /// # Errors
    /// [`OptionError`].
    pub fn methods(&self) -> Result<Vec<Method>, OptionError> {
        let given: Vec<Method> = self.list("method")?;
        let known = Method::ALL.into_iter();
        Ok(known.filter(|m| given.contains(m)).collect())
    }
}
