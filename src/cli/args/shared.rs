//! Arguments that several commands share.

use clap::Args as Arguments;

use super::choice;
use super::value::{count, whole};
use crate::lab::Integration;
use crate::model::{Kernel, Occlusion};
use crate::num::stream::Sampling;
use crate::transport::Estimator;

/// The paths that are traced.
#[derive(Debug, Arguments)]
pub(in crate::cli) struct PathArgs {
    /// Which paths are shared. Given neither this nor --samples: factored or shared where other
    /// surfaces than the hidden reflect between the walls, with as many samples as a pilot says
    /// make the overall standard error 1 %; else independent
    #[arg(long, value_parser = choice::named::<Estimator>())]
    pub estimator: Option<Estimator>,
    /// Where random numbers come from
    #[arg(long, value_parser = choice::named::<Sampling>(), default_value = "sobol")]
    pub sampler: Sampling,
    /// Paths per pixel and spot (independent) or per pixel (shared), points between the walls
    /// (factored); rounded up to whole blocks. 512 unless given or chosen as above
    #[arg(long, allow_negative_numbers = true, value_parser = whole)]
    pub samples: Option<u64>,
    /// Seed: the same seed gives the same bytes
    #[arg(long, default_value_t = 1, allow_negative_numbers = true, value_parser = whole)]
    pub seed: u64,
}

/// What has to be traced, and how.
#[derive(Debug, Arguments)]
pub(in crate::cli) struct TraceArgs {
    #[command(flatten)]
    pub paths: PathArgs,
    /// Threads; all cores unless given. Does not change a byte of the result
    #[arg(long, allow_negative_numbers = true, value_parser = count)]
    pub threads: Option<usize>,
}

/// Whether the model knows what stands in the way.
#[derive(Clone, Debug, Arguments)]
pub(in crate::cli) struct OcclusionArgs {
    /// Leave out of the model what stands in the way, as the published one does
    #[arg(long)]
    pub no_occlusion: bool,
    /// What stands in the way is considered without being asked
    #[arg(long = "occlusion", hide = true, conflicts_with = "no_occlusion")]
    _occlusion: bool,
}

impl OcclusionArgs {
    pub(in crate::cli) fn occlusion(&self) -> Occlusion {
        if self.no_occlusion {
            Occlusion::Ignored
        } else {
            Occlusion::Considered
        }
    }
}

/// How traced and modelled are compared.
#[derive(Debug, Arguments)]
pub(in crate::cli) struct TestArgs {
    /// Kernel of the model
    #[arg(long, value_parser = choice::named::<Kernel>(), default_value = "physical")]
    pub kernel: Kernel,
    /// How the model integrates
    #[arg(long, value_parser = choice::named::<Integration>(), default_value = "quadrature")]
    pub integration: Integration,
    /// Probability of rejecting a right model
    #[arg(long, default_value_t = 1e-3, allow_negative_numbers = true)]
    pub significance: f64,
}
