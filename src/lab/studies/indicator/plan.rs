//! What is swept.

use super::sweep::{Arrangement, Layout};
use crate::model::Kernel;
use crate::recovery::Method;

/// The sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct IndicatorPlan {
    /// Layouts of the spots.
    pub layouts: Vec<Layout>,
    /// Numbers of spots, roughly.
    pub spots: Vec<usize>,
    /// Half-widths or radii, in.
    pub half_widths: Vec<f64>,
    /// Elements a side.
    pub elements: Vec<usize>,
    /// Checks a side of the objects; those that do not divide the elements are left out with them.
    pub boards: Vec<usize>,
    /// Kernels, each for data and inversion.
    pub kernels: Vec<Kernel>,
    /// Methods that are compared under noise.
    pub methods: Vec<Method>,
    /// Relative noise of each entry of Φcam.
    pub noise: Vec<f64>,
    /// Under noise each configuration whose position is a multiple of this.
    pub every: usize,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
}

impl IndicatorPlan {
    /// Every combination of kernel, layout, spots, half-width and elements.
    pub(super) fn arrangements(&self) -> Vec<Arrangement> {
        let mut all = Vec::new();
        for &kernel in &self.kernels {
            for &layout in &self.layouts {
                for &spots in &self.spots {
                    for &half_width in &self.half_widths {
                        for &elements in &self.elements {
                            all.push(Arrangement {
                                layout,
                                spots,
                                half_width,
                                elements,
                                kernel,
                            });
                        }
                    }
                }
            }
        }
        all
    }
}
