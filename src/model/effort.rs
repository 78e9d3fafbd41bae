//! How far elements, footprints and spots are divided past what stands in the way.

/// Relative change below which no finer cells are tried; the next halving would change a fourth.
const TARGET: f64 = 1e-3;

/// When the division of cells, footprints and spots ends.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Relative change of all A_j below which it is enough.
    pub(super) target: f64,
    /// Of all pairs of cells with pixels and spots, the share that a finer division of footprints
    /// and spots may take.
    pub(super) share: f64,
}

impl Effort {
    /// To a thousandth, in a tenth of the pairs: descents ask for the light dozens of times.
    pub const USUAL: Self = Self {
        target: TARGET,
        share: 0.1,
    };
    /// In as many pairs as [`visible`](super::visible::visible) takes: once, to see what the others
    /// leave.
    pub const FINEST: Self = Self {
        target: 0.03 * TARGET,
        share: 1.0,
    };

    /// The usual one, but to no less than this change.
    pub fn coarse(change: f64) -> Self {
        Self {
            target: change.max(TARGET),
            ..Self::USUAL
        }
    }
}
