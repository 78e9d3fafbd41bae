//! Arguments of `phicam study`.

use std::path::PathBuf;

use clap::error::Error;
use clap::{ArgMatches, Args as Arguments, Command, FromArgMatches, Subcommand};

use super::laboratory::{BrdfArgs, CoverageArgs, ExperimentArgs};
use super::sweep::{IndicatorArgs, NoiseArgs};
use super::{EstimatorName, SamplerName};

/// A study with every option of it as it was given, or as it is unless given.
#[derive(Debug)]
pub(in crate::cli) struct StudyArgs {
    pub command: StudyCommand,
    /// Name of the study.
    pub name: String,
    /// Options that decide what comes out, with their values.
    pub options: Vec<(String, String)>,
}

/// What does not change what comes out, or is no option.
const APART: [&str; 7] = [
    "scene",
    "output",
    "threads",
    "json",
    "quiet",
    "also_read",
    "help",
];

impl StudyArgs {
    fn command(base: Command) -> Command {
        StudyCommand::augment_subcommands(base)
            .subcommand_required(true)
            .arg_required_else_help(true)
    }

    /// The options of the study that `matches` names, in the order in which its help lists them.
    fn said(matches: &ArgMatches) -> (String, Vec<(String, String)>) {
        let Some((name, given)) = matches.subcommand() else {
            return Default::default();
        };
        let studies = Self::command(Command::new("study"));
        let known = studies.find_subcommand(name).into_iter();
        let option = |arg: &clap::Arg| {
            let id = arg.get_id().as_str();
            let values = given.get_raw(id).filter(|_| !APART.contains(&id))?;
            let values: Vec<_> = values.map(|v| v.to_string_lossy()).collect();
            Some((format!("--{}", arg.get_long()?), values.join(",")))
        };
        let options = known.flat_map(Command::get_arguments).filter_map(option);
        (name.to_owned(), options.collect())
    }
}

impl FromArgMatches for StudyArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let (name, options) = Self::said(matches);
        Ok(Self {
            command: StudyCommand::from_arg_matches(matches)?,
            name,
            options,
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Arguments for StudyArgs {
    fn augment_args(base: Command) -> Command {
        Self::command(base)
    }

    fn augment_args_for_update(base: Command) -> Command {
        Self::command(base)
    }
}

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum StudyCommand {
    /// What the matrix model leaves out, cause by cause: table, JSON, CSV, figure
    Budget(BudgetArgs),
    /// How small a model error validate detects, and how often it errs: table and JSON
    Power(PowerArgs),
    /// How wrong the assumed geometry may be: table, JSON, CSV, figure
    Tolerance(ToleranceArgs),
    /// How fast the error of each estimator falls: table, JSON, figure
    Convergence(ConvergenceArgs),
    /// How much noise each recovery bears: table, JSON, CSV, figures; a rerun goes on where the last one stopped
    Noise(NoiseArgs),
    /// What predicts the modulation of the published inversion: table, JSON, CSV, figure
    Indicator(IndicatorArgs),
    /// The matrix model on a wall that is not Lambertian, its BRDF known, ignored, or wrong: table, JSON, CSV, figure
    Brdf(BrdfArgs),
    /// How often bands around recovered reflectances cover the truth: table and JSON
    Coverage(CoverageArgs),
    /// The failed laboratory experiment with a real sensor and glare: findings in words, tables, JSON, CSV, figure
    Experiment(ExperimentArgs),
}

impl StudyCommand {
    /// The scene that is studied.
    pub(in crate::cli) fn scene(&self) -> &str {
        match self {
            Self::Budget(a) => &a.scene,
            Self::Power(a) => &a.scene,
            Self::Tolerance(a) => &a.scene,
            Self::Convergence(a) => &a.scene,
            Self::Noise(a) => &a.scene,
            Self::Indicator(a) => &a.scene,
            Self::Brdf(a) => &a.scene,
            Self::Coverage(a) => &a.scene,
            Self::Experiment(a) => &a.scene,
        }
    }
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct ConvergenceArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "thesis")]
    pub scene: String,
    /// Folder for convergence.json, convergence.svg and report.html
    #[arg(long, short, default_value = "out/convergence")]
    pub output: PathBuf,
    /// Numbers of paths, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "64,128,256,512,1024")]
    pub samples: Vec<u64>,
    /// Seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print convergence.json instead of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct ToleranceArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "bench")]
    pub scene: String,
    /// Folder for tolerance.json, tolerance.csv, tolerance.svg and report.html
    #[arg(long, short, default_value = "out/tolerance")]
    pub output: PathBuf,
    /// Noise of the photographs, relative to each entry
    #[arg(long, default_value_t = 0.01)]
    pub noise: f64,
    /// Print tolerance.json instead of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct PowerArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "bench")]
    pub scene: String,
    /// Folder for power.json and report.html
    #[arg(long, short, default_value = "out/power")]
    pub output: PathBuf,
    /// Estimators, separated by commas; all unless given
    #[arg(long, value_enum, value_delimiter = ',')]
    pub estimator: Vec<EstimatorName>,
    /// Where random numbers come from
    #[arg(long, value_enum, default_value_t = SamplerName::Sobol)]
    pub sampler: SamplerName,
    /// Numbers of paths, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "64,256")]
    pub samples: Vec<u64>,
    /// Renders of each kind
    #[arg(long, default_value_t = 40, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub seeds: u64,
    /// First seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Probability of rejecting a right model
    #[arg(long, default_value_t = 0.01)]
    pub significance: f64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print power.json instead of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct BudgetArgs {
    /// Built-in scene or path of a scene file
    pub scene: String,
    /// Folder for budget.json, budget.csv, budget.svg and report.html
    #[arg(long, short, default_value = "out/budget")]
    pub output: PathBuf,
    /// Paths per pixel of the precise renders, all together
    #[arg(long, default_value_t = 16384)]
    pub samples: u64,
    /// Paths per pixel and spot of the run that is taken apart
    #[arg(long, default_value_t = 512)]
    pub run_samples: u64,
    /// Seed of everything
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print budget.json instead of the table
    #[arg(long)]
    pub json: bool,
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
                let options = args.options.iter().map(|(o, v)| format!(" {o} {v}"));
                format!(
                    "study {} {}{}",
                    args.name,
                    args.command.scene(),
                    options.collect::<String>()
                )
            };
            let again = parsed(&told(&first));
            assert_eq!(first.options, again.options, "{line}");
            let apart = |args: &StudyArgs| {
                let text = format!("{:?}", args.command);
                let text = text.replace("\"elsewhere\"", &format!("\"out/{}\"", args.name));
                let text = text.replace("threads: Some(1)", "threads: None");
                text.replace("json: true", "json: false")
            };
            assert_eq!(apart(&first), apart(&again), "{line}");
        }
    }
}
