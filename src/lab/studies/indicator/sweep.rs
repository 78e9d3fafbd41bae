//! The benches that an indicator is tried on.

use crate::lab::studies::foot_on_wall::foot_on_wall;
use crate::model::Kernel;
use crate::num::named::named;
use crate::scene::{Scene, SceneError, spots};

named! {
    /// How the spots lie.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Layout {
        /// The sides of a square.
        Square = "square",
        /// The same with the published stagger of −1, +1 and 0 in.
        Staggered = "square, staggered",
        /// A circle.
        Ring = "ring",
        /// A square grid.
        Grid = "grid",
        /// Two lines: the bottom and the top side of the square.
        Lines = "lines",
        /// Uniformly random in the square.
        Random = "random",
    }
}

impl Layout {
    /// About `number` places around `centre` (as many as the layout can), at half-width or radius
    /// `half`, `inch` the length of an inch.
    fn places(self, centre: [f64; 2], half: f64, number: usize, inch: f64) -> Vec<[f64; 2]> {
        let side = |parts: usize| (number / parts).max(2) as u32;
        match self {
            Self::Square => spots::square(centre, half, side(4), &[]),
            Self::Staggered => spots::square(centre, half, side(4), &[-inch, inch, 0.0]),
            Self::Ring => spots::ring(centre, half, number as u32, 0.0),
            Self::Grid => {
                let n = (number as f64).sqrt().round().max(2.0) as u32;
                spots::grid(centre, half, n)
            }
            Self::Lines => {
                let n = side(2) as usize;
                let all = spots::square(centre, half, n as u32, &[]);
                [&all[..n], &all[2 * n..3 * n]].concat()
            }
            Self::Random => spots::random(centre, half, number as u32, 1),
        }
    }
}

/// One arrangement of spots, and the elements and kernel that it is seen through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arrangement {
    pub(super) layout: Layout,
    pub(super) spots: usize,
    pub(super) half_width: f64,
    pub(super) elements: usize,
    pub(super) kernel: Kernel,
}

/// A scene whose wall holds every spot of a sweep, and the point that layouts lie around.
pub(super) struct Site {
    scene: Scene,
    centre: [f64; 2],
}

impl Site {
    /// The scene with its wall extended so far that spots up to `reach` from the centre lie on it.
    /// The centre is the foot on the wall of the first hidden surface's normal through its middle.
    /// `None` if that normal misses the wall.
    pub(super) fn new(scene: &Scene, reach: f64) -> Result<Option<Self>, SceneError> {
        let scene = scene.with_extended_relay(reach)?;
        Ok(foot_on_wall(&scene).map(|centre| Self { scene, centre }))
    }

    /// The scene with the spots of `arrangement`, less those that no hidden surface faces (on the
    /// bench: behind the hinge); `None` if none is left.
    pub(super) fn arranged(&self, arrangement: &Arrangement) -> Result<Option<Scene>, SceneError> {
        let Arrangement {
            layout,
            spots,
            half_width,
            ..
        } = *arrangement;
        let inch = self.scene.unit.per_inch();
        let places = layout.places(self.centre, half_width * inch, spots, inch);
        let scene = self.scene.with_spots_at(&places)?;
        let faced = |spot: usize| {
            let target = scene.laser.spots[spot].target.position;
            scene.hidden().any(|(_, s)| {
                let middle = s.shape.at([0.5, 0.5]);
                (target - middle.position).dot(middle.normal) > 1e-9 * inch
            })
        };
        let left: Vec<[f64; 2]> = (0..places.len())
            .filter(|i| faced(*i))
            .map(|i| places[i])
            .collect();
        if left.is_empty() {
            return Ok(None);
        }
        self.scene.with_spots_at(&left).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrangement(layout: Layout, half_width: f64) -> Arrangement {
        Arrangement {
            layout,
            spots: 120,
            half_width,
            elements: 8,
            kernel: Kernel::Physical,
        }
    }

    /// On the bench the centre is C = (5, 15.5 − 7.86764·√2), and the staggered square of 120 spots
    /// at 6 in. is the published one.
    #[test]
    fn the_thesis_is_one_of_the_sites() {
        let thesis = Scene::load("thesis").unwrap();
        let site = Site::new(&thesis, 20.0).unwrap().unwrap();
        assert!((site.centre[0] - 5.0).abs() < 1e-9);
        assert!((site.centre[1] - (15.5 - 7.86764 * 2f64.sqrt())).abs() < 1e-9);
        let scene = site
            .arranged(&arrangement(Layout::Staggered, 6.0))
            .unwrap()
            .unwrap();
        assert_eq!(scene.laser.spots.len(), 120);
        for (a, b) in scene.laser.spots.iter().zip(&thesis.laser.spots) {
            assert!((a.target.position - b.target.position).length() < 1e-9);
        }
    }

    /// At 14 in. the top side of the square lies behind the hinge at y = 15.5.
    #[test]
    fn spots_behind_the_hinge_are_left_out() {
        let site = Site::new(&Scene::load("bench").unwrap(), 20.0)
            .unwrap()
            .unwrap();
        for layout in Layout::ALL {
            let scene = site.arranged(&arrangement(layout, 14.0)).unwrap().unwrap();
            let spots = &scene.laser.spots;
            assert!(
                spots.len() < 120 && spots.len() > 40,
                "{layout:?}: {}",
                spots.len()
            );
            assert!(spots.iter().all(|s| s.target.position.y < 15.5));
            let scene = site.arranged(&arrangement(layout, 3.0)).unwrap().unwrap();
            assert!((119..=121).contains(&scene.laser.spots.len()), "{layout:?}");
        }
    }
}
