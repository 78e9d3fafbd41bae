//! Options of a study as data: what a command line, or a program, may set.

mod values;

use std::fmt::Display;
use std::ops::RangeInclusive;

use crate::num::decimal::Decimal;
pub use values::Values;

/// What a value is.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A whole number in this range.
    Whole(RangeInclusive<u64>),
    /// A number.
    Number,
    /// One of these names, each with what it means.
    Name(&'static [(&'static str, &'static str)]),
    /// Any text.
    Text,
}

/// What a number must be beside its kind.
#[derive(Clone, Debug)]
pub struct Rule {
    /// Whether a number keeps it.
    pub fine: fn(f64) -> bool,
    /// What a number is that does not.
    pub wrong: &'static str,
    /// What to do then.
    pub cure: &'static str,
}

/// An option of a study.
#[derive(Clone, Debug)]
pub struct Opt {
    /// Its name: `--name` on the command line.
    pub name: &'static str,
    /// What it sets, in one sentence.
    pub help: &'static str,
    /// What its value is.
    pub kind: Kind,
    /// What else its value must be.
    pub rule: Option<Rule>,
    /// Its value unless given, as it would be given.
    pub default: Option<&'static str>,
    /// Whether it takes several values, separated by commas.
    pub list: bool,
    /// What its value is called in the help, where that is not the option's name.
    pub value: Option<&'static str>,
    /// Another name that it answers to.
    pub alias: Option<&'static str>,
}

/// The whole number that `text` is, as 10000 or 1e4.
fn whole(text: &str) -> Option<u64> {
    Decimal::parse(text)?.whole()
}

impl Opt {
    const fn new(name: &'static str, help: &'static str, kind: Kind) -> Self {
        Self {
            name,
            help,
            kind,
            rule: None,
            default: None,
            list: false,
            value: None,
            alias: None,
        }
    }

    /// A whole number.
    pub const fn whole(name: &'static str, help: &'static str) -> Self {
        Self::new(name, help, Kind::Whole(0..=u64::MAX))
    }

    /// A number.
    pub const fn number(name: &'static str, help: &'static str) -> Self {
        Self::new(name, help, Kind::Number)
    }

    /// One of some names.
    pub const fn choice(
        name: &'static str,
        help: &'static str,
        names: &'static [(&'static str, &'static str)],
    ) -> Self {
        Self::new(name, help, Kind::Name(names))
    }

    /// Any text.
    pub const fn text(name: &'static str, help: &'static str) -> Self {
        Self::new(name, help, Kind::Text)
    }

    /// A number of paths that can be traced ([`crate::transport::Budget::new`]).
    pub const fn paths(name: &'static str, help: &'static str) -> Self {
        Self::whole(name, help).rule(
            |n| (1.0..=4_294_967_296.0).contains(&n),
            "is not a number of paths that can be traced",
            "use at least 1 and at most 2³²",
        )
    }

    /// The first of the seeds, 1 unless given.
    pub const fn seed(help: &'static str) -> Self {
        Self::whole("seed", help).or("1")
    }

    /// The probability of rejecting a right model.
    pub const fn significance(default: &'static str) -> Self {
        Self::number("significance", "Probability of rejecting a right model")
            .or(default)
            .rule(
                |x| x > 0.0 && x < 1.0,
                "is not a probability",
                "use a number between 0 and 1, e.g. 0.001",
            )
    }

    /// Levels of noise relative to each entry.
    pub const fn relative_noise(help: &'static str) -> Self {
        Self::number("noise", help).list().rule(
            |x| x > 0.0 && x <= 1.0,
            "has no meaning here",
            "a relative noise is a number above 0 and not above 1, e.g. 0.01",
        )
    }

    /// The distance at which glare has halved.
    pub const fn falloff(help: &'static str) -> Self {
        Self::number("falloff", help).rule(
            |x| x > 0.0 && x.is_finite(),
            "is no distance",
            "use a length above 0 in the scene's unit",
        )
    }

    /// Recovery methods.
    pub const fn methods(help: &'static str, default: &'static str) -> Self {
        Self::text("method", help).or(default).list()
    }

    /// The same with a value unless given.
    pub const fn or(self, default: &'static str) -> Self {
        Self {
            default: Some(default),
            ..self
        }
    }

    /// The same with several values, separated by commas.
    pub const fn list(self) -> Self {
        Self { list: true, ..self }
    }

    /// The same for whole numbers of this range only.
    pub const fn within(self, least: u64, most: u64) -> Self {
        let kind = Kind::Whole(least..=most);
        Self { kind, ..self }
    }

    /// The same for numbers that are `fine`; of others it is said what is `wrong` and what the
    /// `cure` is.
    pub const fn rule(
        self,
        fine: fn(f64) -> bool,
        wrong: &'static str,
        cure: &'static str,
    ) -> Self {
        let rule = Some(Rule { fine, wrong, cure });
        Self { rule, ..self }
    }

    /// Whether `text` is a value of the option's kind.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parses(&self, text: &str) -> Result<(), String> {
        match &self.kind {
            Kind::Whole(_) => match whole(text) {
                Some(_) => Ok(()),
                None => Err(self.form("a whole number, 0 or more, as 512 or 1e4", "8,16,32")),
            },
            Kind::Number => match text.parse::<f64>() {
                Ok(_) => Ok(()),
                Err(_) => Err(self.form("a number, as 0.01 or 1e-2", "0.01,0.03,0.1")),
            },
            Kind::Name(names) if !names.iter().any(|(name, _)| *name == text) => {
                let names: Vec<&str> = names.iter().map(|n| n.0).collect();
                Err(format!("it is none of {}", names.join(", ")))
            }
            Kind::Name(_) | Kind::Text => Ok(()),
        }
    }

    /// How values are written: `one` of them, and as an example `several`.
    fn form(&self, one: &str, several: &str) -> String {
        if self.list {
            format!("write {one}, several separated by commas, as {several}")
        } else {
            format!("write {one}")
        }
    }

    /// Whether `text` is a value of the option.
    fn check(&self, text: &str) -> Result<(), OptionError> {
        let name = self.name;
        self.parses(text).map_err(|why| {
            OptionError::new(format!("--{name} {text} has no meaning: {why}"), self.help)
        })?;
        if let (Kind::Whole(range), Some(n)) = (&self.kind, whole(text))
            && !range.contains(&n)
        {
            let (least, most) = (range.start(), range.end());
            let cure = if *most == u64::MAX {
                format!("use whole numbers from {least}")
            } else {
                format!("use whole numbers from {least} to {most}")
            };
            return Err(OptionError::new(
                format!("--{name} {n} is out of range"),
                cure,
            ));
        }
        if let (Some(rule), Ok(x)) = (&self.rule, text.parse::<f64>())
            && !(rule.fine)(x)
        {
            return Err(OptionError::new(
                format!("--{name} {text} {}", rule.wrong),
                rule.cure,
            ));
        }
        Ok(())
    }
}

/// An option that cannot be accepted: cause and cure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct OptionError(String);

impl OptionError {
    /// What is wrong, and what to do.
    pub fn new(cause: impl Display, cure: impl Display) -> Self {
        Self(format!("{cause}\n  cure: {cure}"))
    }

    /// Refuses the first of these options that is given: beside the others it would change nothing.
    ///
    /// # Errors
    /// The option, and `why`.
    pub fn refuse_idle(options: &[(&str, bool)], why: &str) -> Result<(), Self> {
        match options.iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((name, _)) => Err(Self::new(
                format!("--{name} would change nothing: {why}"),
                "leave it out",
            )),
        }
    }
}
