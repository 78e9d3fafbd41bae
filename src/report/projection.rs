//! Orthographic views of a scene: which way they look, what they frame, where a point falls on the
//! paper.

use crate::geometry::DVec3;
use crate::scene::{Role, Scene};

/// A wall or an occluder is cut at the frame where it would make it larger than this many times
/// what matters.
const ROOM: f64 = 3.0;
/// A device is left outside the frame where it would make it larger than this many times the
/// surfaces.
const REACH: f64 = 1.35;

/// The direction of sight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum View {
    /// Along −x: y to the right, z upwards.
    Side,
    /// Along −z: x to the right, y upwards.
    Above,
}

impl View {
    /// (right, up) of a point or direction.
    pub(super) fn project(self, p: DVec3) -> [f64; 2] {
        match self {
            Self::Side => [p.y, p.z],
            Self::Above => [p.x, p.y],
        }
    }

    /// Names of the two axes.
    pub(super) fn axes(self) -> [&'static str; 2] {
        match self {
            Self::Side => ["y", "z"],
            Self::Above => ["x", "y"],
        }
    }

    /// What it is, in words.
    pub(super) fn caption(self) -> &'static str {
        match self {
            Self::Side => "From the side (looking along −x)",
            Self::Above => "From above the wall (looking along −z)",
        }
    }
}

/// The part of the plane that is drawn, in the scene's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// Left and lower end.
    pub low: [f64; 2],
    /// Right and upper end.
    pub high: [f64; 2],
}

impl Frame {
    const EMPTY: Self = Self {
        low: [f64::INFINITY; 2],
        high: [f64::NEG_INFINITY; 2],
    };

    /// Spots, view and hidden surfaces; other surfaces and the devices as far as these stay
    /// readable; a margin.
    pub(super) fn of(scene: &Scene, view: View) -> Self {
        let mut frame = Self::EMPTY;
        let view_corners = scene.camera.view.corners();
        let spots = scene.laser.spots.iter().map(|s| s.target.position);
        for p in spots.chain(view_corners) {
            frame = frame.with(view.project(p));
        }
        let boxes = |hidden: bool| {
            let wanted = scene
                .surfaces
                .iter()
                .filter(move |s| (s.role == Role::Hidden) == hidden);
            wanted.map(|s| s.shape.bounds())
        };
        for (low, high) in boxes(true) {
            frame = frame.with(view.project(low)).with(view.project(high));
        }
        let core = frame;
        for (low, high) in boxes(false) {
            let larger = frame.with(view.project(low)).with(view.project(high));
            if larger.size() <= ROOM * core.size() {
                frame = larger;
            }
        }
        let surfaces = frame;
        for p in [scene.laser.position, scene.camera.position] {
            let larger = frame.with(view.project(p));
            if larger.size() <= REACH * surfaces.size() {
                frame = larger;
            }
        }
        frame.with_margin()
    }

    fn with(self, p: [f64; 2]) -> Self {
        Self {
            low: [0, 1].map(|i| self.low[i].min(p[i])),
            high: [0, 1].map(|i| self.high[i].max(p[i])),
        }
    }

    /// Width and height.
    pub(super) fn extent(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.high[i] - self.low[i]).max(0.0))
    }

    /// The larger of width and height.
    fn size(&self) -> f64 {
        let [w, h] = self.extent();
        w.max(h)
    }

    /// Grown by 6 % of its size on all sides, and to at least a quarter of its size in height and
    /// width.
    fn with_margin(self) -> Self {
        let size = if self.size() > 0.0 { self.size() } else { 1.0 };
        let extent = self.extent();
        let grow = extent.map(|e| 0.06 * size + 0.5 * (0.25 * size - e).max(0.0));
        Self {
            low: [0, 1].map(|i| self.low[i] - grow[i]),
            high: [0, 1].map(|i| self.high[i] + grow[i]),
        }
    }

    /// Whether a point of the plane lies inside.
    pub(super) fn contains(&self, p: [f64; 2]) -> bool {
        (0..2).all(|i| self.low[i] <= p[i] && p[i] <= self.high[i])
    }
}

/// A view on the paper: pixels per unit, the same in both directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    /// Direction of sight.
    pub view: View,
    /// What is drawn.
    pub frame: Frame,
    /// Upper left corner on the paper.
    pub corner: [f64; 2],
    /// Pixels per unit.
    pub scale: f64,
}

impl Projection {
    /// Where a point falls on the paper.
    pub(super) fn at(&self, p: DVec3) -> [f64; 2] {
        self.at_plane(self.view.project(p))
    }

    /// Where a point of the plane falls on the paper: y grows downwards there.
    pub(super) fn at_plane(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        [
            self.corner[0] + (a - self.frame.low[0]) * self.scale,
            self.corner[1] + (self.frame.high[1] - b) * self.scale,
        ]
    }

    /// A direction on the paper, per unit length.
    pub(super) fn direction(&self, d: DVec3) -> [f64; 2] {
        let [a, b] = self.view.project(d);
        [a, -b]
    }

    /// Width and height on the paper.
    pub(super) fn size(&self) -> [f64; 2] {
        self.frame.extent().map(|e| e * self.scale)
    }

    /// Where the way from the frame's middle to a point outside crosses the frame, and its
    /// direction on the paper; `None` for a point inside.
    pub(super) fn exit(&self, p: DVec3) -> Option<([f64; 2], [f64; 2])> {
        let target = self.view.project(p);
        if self.frame.contains(target) {
            return None;
        }
        let Frame { low, high } = self.frame;
        let middle = [0, 1].map(|i| 0.5 * low[i] + 0.5 * high[i]);
        let way = [0, 1].map(|i| target[i] - middle[i]);
        let t = (0..2)
            .filter(|&i| way[i] != 0.0)
            .map(|i| 0.5 * (high[i] - low[i]) / way[i].abs())
            .fold(1.0, f64::min);
        let length = libm::hypot(way[0], way[1]);
        let place = self.at_plane([0, 1].map(|i| middle[i] + t * way[i]));
        Some((place, [way[0] / length, -way[1] / length]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bench_is_framed_by_its_surfaces() {
        let scene = Scene::load("bench").unwrap();
        let side = Frame::of(&scene, View::Side);
        assert!(side.contains([0.0, 0.0]) && side.contains([15.5, 4.149]));
        // The devices are at (−20, 10, 15): they fit into the side view, but would double the view
        // from above.
        assert!(side.contains([10.0, 15.0]));
        let above = Frame::of(&scene, View::Above);
        assert!(above.contains([11.5, 15.5]) && !above.contains([-20.0, 10.0]));
    }

    #[test]
    fn one_unit_is_as_long_across_as_upwards() {
        let scene = Scene::load("bench").unwrap();
        for view in [View::Side, View::Above] {
            let frame = Frame::of(&scene, view);
            let p = Projection {
                view,
                frame,
                corner: [10.0, 20.0],
                scale: 7.0,
            };
            let [o, a, b] = [[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]].map(|q| p.at_plane(q));
            assert!((a[0] - o[0] - 7.0).abs() < 1e-9 && (a[1] - o[1]).abs() < 1e-9);
            assert!((o[1] - b[1] - 7.0).abs() < 1e-9 && (o[0] - b[0]).abs() < 1e-9);
        }
    }

    #[test]
    fn arrows_leave_on_the_frame_towards_the_device() {
        let scene = Scene::load("bench").unwrap();
        let frame = Frame {
            low: [0.0, 0.0],
            high: [10.0, 10.0],
        };
        let p = Projection {
            view: View::Above,
            frame,
            corner: [0.0, 0.0],
            scale: 1.0,
        };
        // From the middle (5, 5) to (−20, 10): slope −1/5, so the left edge is crossed at y = 6.
        let (place, way) = p.exit(scene.camera.position).unwrap();
        assert!(
            (place[0] - 0.0).abs() < 1e-12 && (place[1] - 4.0).abs() < 1e-12,
            "{place:?}"
        );
        assert!((way[1] / way[0] - 0.2).abs() < 1e-12);
        assert!(p.exit(DVec3::new(3.0, 3.0, 99.0)).is_none());
    }
}
