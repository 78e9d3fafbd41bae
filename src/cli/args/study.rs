//! Arguments of `phicam study`, from the registry of studies.

use std::path::PathBuf;

use clap::builder::ValueParser;
use clap::error::{Error, ErrorKind};
use clap::{Arg, ArgAction, ArgMatches, Args as Arguments, Command, FromArgMatches, value_parser};

use super::choice::possible;
use super::value::count;
use crate::lab::options::{Kind, Opt, OptionError, Values};
use crate::lab::{Registered, STUDIES};

/// A study that is asked for.
#[derive(Debug)]
pub(in crate::cli) struct StudyArgs {
    pub study: &'static Registered,
    pub scene: String,
    pub output: PathBuf,
    pub threads: Option<usize>,
    pub replace: bool,
    pub json: bool,
    /// Every option with its values as they were given, or as they are unless given.
    pub options: Vec<(&'static str, Vec<String>)>,
}

impl StudyArgs {
    /// The values of the options.
    pub(in crate::cli) fn values(&self) -> Result<Values, OptionError> {
        let set =
            |values: Values, (name, given): &(&str, Vec<String>)| values.with(name, given.clone());
        let values = Values::defaults(self.study.options);
        self.options.iter().try_fold(values, set)
    }

    /// The options that have values, with them, as a command line spells them.
    pub(in crate::cli) fn spelled(&self) -> Vec<(String, String)> {
        let given = self.options.iter().filter(|(_, values)| !values.is_empty());
        let spelled =
            |(name, values): &(&str, Vec<String>)| (format!("--{name}"), values.join(","));
        given.map(spelled).collect()
    }
}

fn command(study: &'static Registered) -> Command {
    let name = study.name;
    let files = match study.files {
        "" => format!("{name}.json"),
        files => format!("{name}.json, {files}"),
    };
    let scene = Arg::new("scene")
        .value_name("SCENE")
        .help("Built-in scene or path of a scene file");
    Command::new(name)
        .about(study.about)
        .arg(match study.scene {
            Some(scene_name) => scene.default_value(scene_name),
            None => scene.required(true),
        })
        .arg(
            Arg::new("output")
                .long("output")
                .short('o')
                .value_name("OUTPUT")
                .help(format!("Folder for {files} and report.html"))
                .default_value(format!("out/{name}"))
                .value_parser(value_parser!(PathBuf)),
        )
        .args(study.options.iter().map(argument))
        .arg(
            Arg::new("threads")
                .long("threads")
                .value_name("THREADS")
                .help("Threads; all cores unless given")
                .value_parser(count),
        )
        .arg(
            Arg::new("replace")
                .long("replace")
                .action(ArgAction::SetTrue)
                .help("Replace results of other settings, of another scene or of another study"),
        )
        .arg(
            Arg::new("json")
                .long("json")
                .action(ArgAction::SetTrue)
                .help(format!("Print {name}.json instead of the table")),
        )
}

fn argument(option: &'static Opt) -> Arg {
    let name = option.value.map_or_else(
        || option.name.to_uppercase().replace('-', "_"),
        str::to_owned,
    );
    let parser = match option.kind {
        Kind::Name(names) => possible(names).into(),
        _ => ValueParser::new(|text: &str| option.parses(text).map(|()| text.to_owned())),
    };
    let argument = Arg::new(option.name)
        .long(option.name)
        .value_name(name)
        .help(option.help)
        .value_parser(parser)
        .allow_negative_numbers(matches!(option.kind, Kind::Number));
    let argument = match option.default {
        Some(default) => argument.default_value(default),
        None => argument,
    };
    let argument = match option.alias {
        Some(alias) => argument.visible_alias(alias),
        None => argument,
    };
    if option.list {
        argument.value_delimiter(',').action(ArgAction::Append)
    } else {
        argument
    }
}

impl FromArgMatches for StudyArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let chosen = matches.subcommand().and_then(|(name, given)| {
            let study = STUDIES.iter().find(|s| s.name == name)?;
            Some((study, given))
        });
        let (study, given) = chosen.ok_or_else(|| Error::new(ErrorKind::MissingSubcommand))?;
        let text = |option: &'static Opt| {
            let values = given.get_many::<String>(option.name);
            (option.name, values.into_iter().flatten().cloned().collect())
        };
        let missing = || Error::new(ErrorKind::MissingRequiredArgument);
        Ok(Self {
            study,
            scene: given
                .get_one::<String>("scene")
                .cloned()
                .ok_or_else(missing)?,
            output: given
                .get_one::<PathBuf>("output")
                .cloned()
                .ok_or_else(missing)?,
            threads: given.get_one("threads").copied(),
            replace: given.get_flag("replace"),
            json: given.get_flag("json"),
            options: study.options.iter().map(text).collect(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Arguments for StudyArgs {
    fn augment_args(base: Command) -> Command {
        base.subcommands(STUDIES.iter().copied().map(command))
            .subcommand_required(true)
            .arg_required_else_help(true)
    }

    fn augment_args_for_update(base: Command) -> Command {
        Self::augment_args(base)
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::super::{Args, Command as Top};
    use super::*;

    fn parsed(line: &str) -> StudyArgs {
        let words = std::iter::once("phicam").chain(line.split_whitespace());
        match Args::try_parse_from(words).unwrap().command {
            Top::Study(args) => args,
            other => panic!("{other:?}"),
        }
    }

    /// What is told of a study is the whole of it: asked for in these words it is the same study.
    #[test]
    fn the_options_that_are_told_repeat_the_study() {
        for line in [
            "study budget s.toml --samples 32 -o elsewhere --threads 1 --json",
            "study power s.toml --estimator shared,factored --sampler pcg --samples=8,16",
            "study tolerance --noise 1e-3",
            "study convergence s.toml --samples 8,16 --seed 7",
            "study noise s.toml --axis photons --noise 1e-3,1e-2 --seeds 3 --boards 2,4 --method pinv,joint",
            "study indicator s.toml --seeds 3",
            "study brdf s.toml --samples 64",
            "study coverage s.toml --noise 0.02 --confidence 0.9",
            "study experiment s.toml --glares 1 --exposures 1,2 --seeds 2 -q",
        ] {
            let first = parsed(line);
            let told = |args: &StudyArgs| {
                let options = args.spelled().into_iter().map(|(o, v)| format!(" {o} {v}"));
                format!(
                    "study {} {}{}",
                    args.study.name,
                    args.scene,
                    options.collect::<String>()
                )
            };
            let again = parsed(&told(&first));
            assert_eq!(first.options, again.options, "{line}");
            let values = |args: &StudyArgs| format!("{:?}", args.values().unwrap());
            assert_eq!(values(&first), values(&again), "{line}");
            assert_eq!(first.scene, again.scene, "{line}");
        }
    }

    /// What is named twice is studied once, as it stands first.
    #[test]
    fn each_value_is_taken_once() {
        let args = parsed("study power --samples 16,8,1.6e1 --estimator shared,factored,shared");
        let values = args.values().unwrap();
        assert_eq!(values.list::<u64>("samples").unwrap(), [16, 8]);
        let estimators: Vec<String> = values.list("estimator").unwrap();
        assert_eq!(estimators, ["shared", "factored"]);
        let args = parsed("study noise --noise 0.1,1e-1,0.01");
        let noise: Vec<f64> = args.values().unwrap().list("noise").unwrap();
        assert_eq!(noise, [0.1, 0.01]);
    }
}
