//! What elements send, and how it differs by two divisions.

use crate::matrix::Matrix;
use crate::model::occlusion::Both;
use crate::model::terms::Terms;

/// An element's terms, and its light without and with what stands in the way, summed over its
/// cells.
pub(super) struct Own {
    pub camera: Matrix,
    pub laser: Matrix,
    /// By pixel.
    pub seen: Vec<Both>,
    /// By spot.
    pub lit: Vec<Both>,
    /// Variance of all its light together by the choice of viewpoints.
    pub variance: f64,
}

/// ‖A′ − A‖/‖A′‖ over all elements.
pub(super) fn moved(before: &[Own], now: &[Own]) -> f64 {
    let each = before.iter().zip(now);
    let change: f64 = each
        .map(|(a, b)| dot(a, a) - 2.0 * dot(a, b) + dot(b, b))
        .sum();
    (change.max(0.0) / whole(now)).sqrt()
}

/// Standard deviation of all A by the choice of viewpoints over ‖A‖.
pub(super) fn chance(all: &[Own]) -> f64 {
    (all.iter().map(|own| own.variance).sum::<f64>() / whole(all)).sqrt()
}

/// ‖A‖² over all elements.
fn whole(all: &[Own]) -> f64 {
    let sum: f64 = all.iter().map(|own| dot(own, own)).sum();
    sum.max(f64::MIN_POSITIVE)
}

/// ⟨C D, C′ D′⟩ = ⟨CᵀC′, D D′ᵀ⟩.
fn dot(a: &Own, b: &Own) -> f64 {
    let laser = &a.laser * b.laser.transpose();
    a.camera.tr_mul(&b.camera).dot(&laser)
}

/// The terms of all elements one behind the other.
pub(super) fn stacked(all: &[Own]) -> Terms {
    let size = all
        .first()
        .map_or((0, 0), |own| (own.seen.len(), own.lit.len()));
    let each: Vec<_> = all.iter().map(|own| (&own.camera, &own.laser)).collect();
    Terms::stacked(&each, size)
}
