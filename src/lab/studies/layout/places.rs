//! Where a laser spot may be.

use rayon::prelude::*;

use crate::geometry::Ray;
use crate::scene::Scene;

/// The rules for places of spots.
#[derive(Clone, Debug)]
pub(super) struct Places {
    scene: Scene,
    /// Least distance from the camera's view.
    margin: f64,
    /// Least distance of two spots.
    apart: f64,
}

impl Places {
    pub(super) fn new(scene: &Scene, margin: f64, apart: f64) -> Self {
        // One spot is moved about: the others need not be copied.
        let mut scene = scene.clone();
        scene.laser.spots.truncate(1);
        Self {
            scene,
            margin,
            apart,
        }
    }

    /// Whether a spot at (x, y) lies on the wall, on a side that faces the laser, is outside the
    /// view by the margin, and nothing stands between it and the laser.
    pub(super) fn allow(&self, place: [f64; 2]) -> bool {
        let Ok(lit) = self.scene.with_spots_at(&[place]) else {
            return false;
        };
        let spot = &lit.laser.spots[0];
        let target = spot.target.position;
        let view = &lit.camera.view;
        let [a, b] = view.coordinates(target);
        let beside = |x: f64, edge: f64| (x - x.clamp(0.0, 1.0)).abs() * edge;
        let away = libm::hypot(beside(a, view.u().length()), beside(b, view.v().length()));
        let reached = Ray::between(lit.laser.position, target)
            .is_some_and(|ray| !lit.bvh().blocked(&ray, [None, Some(spot.surface)]));
        away > 0.0 && away >= self.margin && reached
    }

    /// Whether two spots are far enough from each other.
    pub(super) fn apart(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        libm::hypot(a[0] - b[0], a[1] - b[1]) >= self.apart
    }

    /// Whether `place` is far enough from all of `others`.
    pub(super) fn apart_from(
        &self,
        place: [f64; 2],
        mut others: impl Iterator<Item = [f64; 2]>,
    ) -> bool {
        others.all(|other| self.apart(place, other))
    }

    /// Side of the cells of [`Self::grid`].
    pub(super) fn spacing(&self, points: usize) -> f64 {
        let ([x0, y0], [x1, y1]) = self.extent();
        (x1 - x0).max(y1 - y0) / points as f64
    }

    /// The middles of square cells over the walls, `points` along the longer side, where a spot may
    /// be: rows along +y, each along +x.
    pub(super) fn grid(&self, points: usize) -> Vec<[f64; 2]> {
        let (low, high) = self.extent();
        let side = self.spacing(points);
        let count = |k: usize| (((high[k] - low[k]) / side).round() as usize).max(1);
        let [nx, ny] = [count(0), count(1)];
        let at = |k: usize, i: usize, n: usize| {
            low[k] + (high[k] - low[k]) * (i as f64 + 0.5) / n as f64
        };
        let all = (0..nx * ny).into_par_iter();
        let places = all.map(|i| [at(0, i % nx, nx), at(1, i / nx, ny)]);
        places.filter(|place| self.allow(*place)).collect()
    }

    /// Corners of the walls' bounds in x and y.
    fn extent(&self) -> ([f64; 2], [f64; 2]) {
        let mut extent = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (_, wall) in self.scene.relays() {
            let (low, high) = wall.shape.bounds();
            extent.0 = [extent.0[0].min(low.x), extent.0[1].min(low.y)];
            extent.1 = [extent.1[0].max(high.x), extent.1[1].max(high.y)];
        }
        extent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bench's wall is [0, 11.5] × [0, 15.5], its view [3.25, 6.5] × [2.75, 6]: what is off the
    /// wall, in the view, or nearer than the margin to an edge or a corner of it is no place.
    #[test]
    fn places_by_hand() {
        let scene = Scene::load("bench").unwrap();
        let places = Places::new(&scene, 0.5, 0.3);
        for (place, allowed) in [
            ([1.0, 1.0], true),
            ([-0.1, 1.0], false),
            ([4.0, 4.0], false),
            ([2.8, 4.0], false),
            ([2.7, 4.0], true),
            ([6.8, 6.3], false),
            ([6.9, 6.4], true),
        ] {
            assert_eq!(places.allow(place), allowed, "{place:?}");
        }
        assert!(places.apart([0.0, 0.0], [0.3, 0.0]) && !places.apart([0.0, 0.0], [0.2, 0.2]));
        let grid = places.grid(31);
        assert!((places.spacing(31) - 0.5).abs() < 1e-12);
        // 23 × 31 cells of half an inch, less those of the view and half an inch around it.
        assert!((600..23 * 31).contains(&grid.len()), "{}", grid.len());
        assert!(grid.contains(&[0.25, 0.25]) && grid.iter().all(|p| places.allow(*p)));
    }

    /// A plate between laser and wall keeps the beam from what is behind it.
    #[test]
    fn no_beam_passes_an_occluder() {
        let scene = Scene::load("bench").unwrap();
        let target = glam::DVec3::new(9.0, 9.0, 0.0);
        let middle = scene.laser.position + (target - scene.laser.position) * 0.9;
        let (u, v) = (glam::DVec3::X, glam::DVec3::Y);
        let plate = crate::geometry::Parallelogram::new(middle - (u + v) * 0.05, u * 0.1, v * 0.1);
        let plate = plate.map(crate::geometry::Shape::Parallelogram);
        let blocked = scene.with_black(&[plate]).unwrap();
        assert!(Places::new(&scene, 0.1, 0.0).allow([9.0, 9.0]));
        assert!(!Places::new(&blocked, 0.1, 0.0).allow([9.0, 9.0]));
        assert!(Places::new(&blocked, 0.1, 0.0).allow([9.0, 7.0]));
    }
}
