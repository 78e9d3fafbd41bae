//! The point of the wall that published layouts lie around.

use crate::geometry::Ray;
use crate::scene::Scene;

/// (x, y) of the foot on the wall of the first hidden surface's normal through its middle; `None`
/// where nothing is hidden or that normal misses the wall.
pub(super) fn foot_on_wall(scene: &Scene) -> Option<[f64; 2]> {
    let (_, hidden) = scene.hidden().next()?;
    let middle = hidden.shape.at([0.5, 0.5]);
    let normal = Ray::new(middle.position, middle.normal);
    let nearest = scene
        .relays()
        .filter_map(|(_, wall)| wall.shape.intersect(&normal, false))
        .min_by(|a, b| a.t.total_cmp(&b.t))?;
    let foot = middle.position + middle.normal * nearest.t;
    Some([foot.x, foot.y])
}
