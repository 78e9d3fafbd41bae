//! Arguments of the studies of bands, of wall BRDFs and of the laboratory experiment.

use std::path::PathBuf;

use clap::Args as Arguments;

#[derive(Debug, Arguments)]
pub(in crate::cli) struct ExperimentArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "experiment")]
    pub scene: String,
    /// Folder for experiment.json, experiment.csv, experiment.svg and report.html
    #[arg(long, short, default_value = "out/experiment")]
    pub output: PathBuf,
    /// Built-in sensor (ideal, ccd, dslr, machine-vision); that of the scene's [sensor] table unless given, or ccd if it has none
    #[arg(long)]
    pub sensor: Option<String>,
    /// Glare over signal, separated by commas, growing
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0,0.1,1,3,10",
        allow_negative_numbers = true
    )]
    pub glares: Vec<f64>,
    /// Exposures over the longest that the sensor bears, separated by commas, growing
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0.0001,0.001,0.003,0.01,0.1,1",
        allow_negative_numbers = true
    )]
    pub exposures: Vec<f64>,
    /// Distance, in the scene's unit, at which the falling glare has halved
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    pub falloff: f64,
    /// Frames averaged at each spot in the sweep over glare
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
    /// Paths per pixel of the traced light
    #[arg(long, default_value_t = 512)]
    pub samples: u64,
    /// Draws of the sensor's noise
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub seeds: u64,
    /// Seed of the tracer and first one of the sensor
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print experiment.json instead of the findings
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct BrdfArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "satin")]
    pub scene: String,
    /// Folder for brdf.json, brdf.csv, brdf.svg and report.html
    #[arg(long, short, default_value = "out/brdf")]
    pub output: PathBuf,
    /// Points, or paths per pixel where the hidden surface is not Lambertian, of each of the two renders
    #[arg(long, default_value_t = 65536)]
    pub samples: u64,
    /// Noise of the photographs, relative to each entry, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "0.001,0.01,0.1",
        allow_negative_numbers = true
    )]
    pub noise: Vec<f64>,
    /// Recovery methods, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "pinv,tikhonov,joint")]
    pub method: Vec<String>,
    /// Draws of the noise
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub seeds: u64,
    /// Seed of the tracer and first one of the noise
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Probability of rejecting a right model
    #[arg(long, default_value_t = 1e-4, allow_negative_numbers = true)]
    pub significance: f64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print brdf.json instead of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct CoverageArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "bench")]
    pub scene: String,
    /// Folder for coverage.json and report.html
    #[arg(long, short, default_value = "out/coverage")]
    pub output: PathBuf,
    /// Methods, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "pinv,tsvd,tikhonov,joint-unbounded,joint,nnls"
    )]
    pub method: Vec<String>,
    /// Elements a side, in place of the scene's
    #[arg(long)]
    pub elements: Option<usize>,
    /// Noise of the photographs, relative to each entry
    #[arg(long, default_value_t = 0.01, allow_negative_numbers = true)]
    pub noise: f64,
    /// Probability with which each element shall be covered
    #[arg(long, default_value_t = 0.95, allow_negative_numbers = true)]
    pub confidence: f64,
    /// Draws of the noise
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub seeds: u64,
    /// First seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print coverage.json instead of the table
    #[arg(long)]
    pub json: bool,
}
