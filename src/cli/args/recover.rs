//! Arguments of `phicam recover`.

use std::path::PathBuf;

use clap::Args as Arguments;

use super::terms::explained;
use super::value::{count, elements, levels};
use super::{BesideArgs, OcclusionArgs, choice};
use crate::lab::Integration;
use crate::model::Kernel;
use crate::recovery::{Method, Rule, WeightRule};

#[derive(Clone, Debug, Arguments)]
#[command(after_long_help = explained(&["G12", "determined", "by centres", "degrees of freedom", "MTF raw", "MTF normalized", "RMSE", "singular values"]))]
pub(in crate::cli) struct RecoverArgs {
    /// Folder of a run; with --phi a folder with a scene.toml is enough, with --camera-side none is
    /// needed
    #[arg(
        required_unless_present = "camera_side",
        conflicts_with = "camera_side"
    )]
    pub dir: Option<PathBuf>,
    /// Folder for the results; DIR/recovered unless given, and for another Φcam than the run's
    /// DIR/recovered-NAME-DIGEST
    #[arg(long, short, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    #[arg(long, value_delimiter = ',', value_name = "METHOD", help = methods())]
    pub method: Vec<String>,
    /// Φcam to invert, pixels × spots in W, in place of DIR/phi.npy
    #[arg(long, value_name = "FILE")]
    pub phi: Option<PathBuf>,
    /// Its standard error, in place of DIR/phi.stderr.npy
    #[arg(long, value_name = "FILE", conflicts_with = "noise")]
    pub stderr: Option<PathBuf>,
    /// Replicates from which --stderr was estimated, at least 2; those of fewer than 32 are pooled
    /// over pixels and spots where these say more. Known errors unless given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..), requires = "stderr")]
    pub replicates: Option<u32>,
    /// Noise model: standard deviation of each entry relative to its value, in place of a standard
    /// error
    #[arg(long, value_name = "RELATIVE", allow_negative_numbers = true)]
    pub noise: Option<f64>,
    /// Use entries that `expose` has marked as saturated or cut off beside the --phi file
    /// (saturated.npy) as if they were right
    #[arg(long, requires = "phi")]
    pub keep_clipped: bool,
    /// Entries that do not count, pixels × spots: those that are not 0; left_out.npy beside Φcam
    /// unless given
    #[arg(long, value_name = "FILE", conflicts_with = "keep_clipped")]
    pub left_out: Option<PathBuf>,
    /// Invert this matrix C in place of a model's, pixels × elements: Φcam = C·diag(x)·D
    #[arg(
        long,
        value_name = "FILE",
        requires_all = ["phi", "output"],
        conflicts_with_all = ["kernel", "no_occlusion", "integration", "occluder_light", "memory"]
    )]
    pub camera_side: Option<PathBuf>,
    /// D that belongs to --camera-side, elements × spots; all 1 unless given: a surface that shines
    #[arg(long, value_name = "FILE", requires = "camera_side")]
    pub laser_side: Option<PathBuf>,
    /// Columns and rows of a photograph, for --frame-polynomial beside --camera-side: N or NxM
    #[arg(long, value_name = "NxM", value_parser = elements, requires = "camera_side")]
    pub pixels: Option<[usize; 2]>,
    /// Kernel of the model that is inverted
    #[arg(long, value_parser = choice::named::<Kernel>(), default_value = "physical")]
    pub kernel: Kernel,
    /// Elements along u and v, in place of the scene's: N or NxM. Beside --camera-side they are as
    /// C has them, u fastest; v is drawn upwards, so that the first row of elements is the lowest
    #[arg(long, value_name = "N", value_parser = elements)]
    pub elements: Option<[usize; 2]>,
    #[command(flatten)]
    pub occlusion: OcclusionArgs,
    /// How the model of the joint methods integrates, quadrature unless given; the published
    /// kernel, more than 1024 elements and the other methods are by centres
    #[arg(long, value_parser = choice::named::<Integration>())]
    pub integration: Option<Integration>,
    /// How tsvd, tikhonov and tikhonov-gradient choose their parameter; discrepancy unless given
    #[arg(long, value_parser = choice::named::<Rule>())]
    pub rule: Option<Rule>,
    /// Singular directions that tsvd keeps, in place of the rule's choice
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = count)]
    pub rank: Option<usize>,
    /// Damping of tikhonov and tikhonov-gradient relative to σ1, in place of the rule's choice
    #[arg(long, value_name = "LAMBDA", allow_negative_numbers = true)]
    pub damping: Option<f64>,
    /// Relative singular value below which pinv, the divisions and joint-unbounded cut;
    /// max(size)·eps unless given
    #[arg(long, value_name = "RELATIVE", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    #[command(flatten)]
    pub joint: JointArgs,
    #[command(flatten)]
    pub beside: BesideArgs,
    /// Bands that cover with this probability, each element alone (linear methods without bias) or
    /// all together (joint, nnls): METHOD.lower.npy and METHOD.upper.npy
    #[arg(long, value_name = "LEVEL", allow_negative_numbers = true)]
    pub bands: Option<f64>,
    /// Memory that may be taken, GiB: where Φcam is larger it is read by rows, by the methods that
    /// can; three quarters of what is free unless given
    #[arg(long, value_name = "GIB", allow_negative_numbers = true)]
    pub memory: Option<f64>,
    /// Print the results as JSON
    #[arg(long)]
    pub json: bool,
}

/// What the methods over all pixels and spots can do besides.
#[derive(Clone, Debug, Arguments)]
pub(in crate::cli) struct JointArgs {
    /// By what the joint methods weigh the entries of Φcam; noise unless given
    #[arg(long, value_parser = choice::named::<WeightRule>())]
    pub weighting: Option<WeightRule>,
    /// Weight of joint-tv's total variation relative to σ1², in place of the one of the largest
    /// evidence
    #[arg(long, value_name = "LAMBDA", allow_negative_numbers = true)]
    pub tv: Option<f64>,
    /// The two reflectances of joint-two-valued, estimated unless given: DARK,LIGHT
    #[arg(long, value_name = "DARK,LIGHT", value_parser = levels, allow_hyphen_values = true)]
    pub levels: Option<[f64; 2]>,
    /// Where the noise is not known, joint-gp takes what it leaves over for noise of single pixels
    /// and a field of errors that neighbours share, in place of noise that so many pixels share
    #[arg(long)]
    pub error_field: bool,
    /// Estimate the light that occluders reflect, with one albedo for each of their sides
    #[arg(long, conflicts_with_all = ["no_occlusion", "free_scale"])]
    pub occluder_light: bool,
}

/// The help of `--method`.
fn methods() -> String {
    let names = |methods: &[Method]| {
        methods
            .iter()
            .map(|m| m.name())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let few = Method::OF_FEW.map(|(method, most)| format!("{method} (up to {most})"));
    format!(
        "Methods, separated by commas: {}; unless given {}, and of few enough elements {}",
        names(&Method::ALL),
        names(&Method::USUAL),
        few.join(" and ")
    )
}
