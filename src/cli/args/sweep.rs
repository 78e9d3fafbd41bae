//! Arguments of the studies that sweep benches and noise.

use std::path::PathBuf;

use clap::{Args as Arguments, ValueEnum};

use super::KernelName;

/// What `study noise` varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum AxisName {
    /// Noise relative to each entry
    Relative,
    /// Photons per pixel and frame: shot noise alone
    Photons,
    /// Seconds that a sensor's frame takes; one dark frame is subtracted
    Exposure,
    /// Glare over signal, photographed by a sensor and left in
    Glare,
    /// Bits of a converter, nothing else being noisy
    Bits,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct NoiseArgs {
    /// Built-in scene or path of a scene file
    #[arg(default_value = "bench")]
    pub scene: String,
    /// Folder for noise.csv (every trial: what a rerun goes on from), noise-curves.csv, noise.json, the figures and report.html
    #[arg(long, short, default_value = "out/noise")]
    pub output: PathBuf,
    /// Checks a side of the objects, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "2,4,8")]
    pub boards: Vec<usize>,
    /// Elements a side, separated by commas; with each board those that it divides
    #[arg(long, value_delimiter = ',', default_value = "2,4,8")]
    pub elements: Vec<usize>,
    /// Methods, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "pinv,tsvd,tikhonov,joint-unbounded,joint"
    )]
    pub method: Vec<String>,
    /// Kernel of both the photographs and the inversion
    #[arg(long, value_enum, default_value_t = KernelName::Physical)]
    pub kernel: KernelName,
    /// What is varied
    #[arg(long, value_enum, default_value_t = AxisName::Relative)]
    pub axis: AxisName,
    /// Levels on the axis, separated by commas; unless given relative noise 1e-12 to 1 and 1 to 1e20 photons by decades, exposures over six decades up to
    /// what the sensor bears, glare 1e-4 to 100 times the signal by half decades, 4 to 24 bits
    #[arg(
        long,
        visible_alias = "levels",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub noise: Vec<f64>,
    /// Built-in sensor (ideal, ccd, dslr, machine-vision) of the axes exposure and glare; that of the scene's [sensor] table unless given, or ccd if it
    /// has none
    #[arg(long)]
    pub sensor: Option<String>,
    /// Distance, in the scene's unit, at which glare has halved, on the axis glare; spread evenly unless given
    #[arg(long, allow_negative_numbers = true)]
    pub falloff: Option<f64>,
    /// Draws of the noise at each level
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub seeds: u64,
    /// First seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Measure the noise of renders with these numbers of paths, separated by commas, and mark it on the axis
    #[arg(long, value_delimiter = ',')]
    pub render_samples: Vec<u64>,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print noise.json instead of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct IndicatorArgs {
    /// Built-in scene or path of a scene file; its wall is extended to hold every spot
    #[arg(default_value = "thesis")]
    pub scene: String,
    /// Folder for indicator.json, indicator.csv, indicator-noise.csv, indicator.svg and report.html
    #[arg(long, short, default_value = "out/indicator")]
    pub output: PathBuf,
    /// Numbers of spots, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "8,24,60,120,240,400")]
    pub spots: Vec<usize>,
    /// Half-widths or radii in inches, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "1,2,3,4.5,6,8,10,14",
        allow_negative_numbers = true
    )]
    pub half_widths: Vec<f64>,
    /// Elements a side, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "4,6,8")]
    pub elements: Vec<usize>,
    /// Checks a side of the objects, separated by commas; with each number of elements those that divide it
    #[arg(long, value_delimiter = ',', default_value = "2,4,8")]
    pub boards: Vec<usize>,
    /// Methods compared under noise, separated by commas; those that state their covariance are predicted
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "pinv,tsvd,tikhonov,joint-unbounded"
    )]
    pub method: Vec<String>,
    /// Relative noise of each entry, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "1e-10,1e-8,1e-6,1e-4,1e-2",
        allow_negative_numbers = true
    )]
    pub noise: Vec<f64>,
    /// Under noise every N-th configuration only
    #[arg(long, value_name = "N", default_value_t = 61, value_parser = clap::value_parser!(u64).range(1..))]
    pub every: u64,
    /// Draws of the noise
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    pub seeds: u64,
    /// First seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; all cores unless given
    #[arg(long)]
    pub threads: Option<usize>,
    /// Print indicator.json instead of the table
    #[arg(long)]
    pub json: bool,
}
