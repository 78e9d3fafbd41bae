//! Lines and dots over a preview: spots, the camera's view, beams, devices, edges of hidden
//! surfaces.

use super::light::Colour;
use super::viewpoint::Lens;
use crate::geometry::{DVec3, Shape};
use crate::image::Transfer;
use crate::scene::{Role, Scene};

/// Okabe and Ito's vermillion, green and blue.
const LASER: [u8; 3] = [0xd5, 0x5e, 0x00];
const CAMERA: [u8; 3] = [0x00, 0x9e, 0x73];
const OBJECT: [u8; 3] = [0x00, 0x72, 0xb2];
/// Half widths, px: of a beam, of an edge, of a spot, of a device.
const BEAM: f64 = 0.8;
const EDGE: f64 = 1.3;
const SPOT: f64 = 2.6;
const DEVICE: f64 = 7.0;
/// How much of what is behind a beam it covers; everything else covers all.
const SHEER: f64 = 0.45;
/// Beams that are drawn, of however many spots.
const BEAMS: usize = 6;
/// A mark is shown unless something stands before it by more than this part of its distance: it has
/// no thickness, and lies on a surface.
const SLACK: f64 = 4e-3;

/// A line in the picture with round ends; a dot if both ends are one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    /// Where it begins and ends, px.
    ends: [[f64; 2]; 2],
    /// 1 over the depth of each end.
    nearness: [f64; 2],
    half: f64,
    colour: Colour,
    opacity: f64,
}

impl Mark {
    /// The part of the line from `a` to `b` that is ahead of the viewer.
    fn between(lens: &Lens, [a, b]: [DVec3; 2], near: f64) -> Option<Self> {
        let [da, db] = [a, b].map(|p| lens.depth(p));
        if da.max(db) < near {
            return None;
        }
        let cut = |from: DVec3, to: DVec3, d: f64, e: f64| {
            if d < near {
                from + (to - from) * ((near - d) / (e - d))
            } else {
                from
            }
        };
        let ends = [cut(a, b, da, db), cut(b, a, db, da)];
        Some(Self {
            ends: ends.map(|p| lens.place(p)),
            nearness: ends.map(|p| lens.depth(p).max(near).recip()),
            half: EDGE,
            colour: [0.0; 3],
            opacity: 1.0,
        })
    }

    /// Its depth where it covers `at`.
    fn depth_at(&self, at: [f64; 2]) -> Option<f64> {
        let [[ax, ay], [bx, by]] = self.ends;
        let (dx, dy) = (bx - ax, by - ay);
        let square = dx * dx + dy * dy;
        let along = if square > 0.0 {
            (((at[0] - ax) * dx + (at[1] - ay) * dy) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let off = [at[0] - ax - along * dx, at[1] - ay - along * dy];
        let covered = off[0] * off[0] + off[1] * off[1] <= self.half * self.half;
        // 1/depth is linear along a line in the picture.
        covered.then(|| (self.nearness[0] + along * (self.nearness[1] - self.nearness[0])).recip())
    }

    /// Whether it may cover something between the lines `y` and `y` + 1 of the picture.
    fn touches_row(&self, y: usize) -> bool {
        let [a, b] = [self.ends[0][1], self.ends[1][1]];
        a.min(b) - self.half <= (y + 1) as f64 && a.max(b) + self.half >= y as f64
    }
}

/// Everything that is marked, later marks over earlier ones.
#[derive(Default)]
pub(super) struct Overlay {
    marks: Vec<Mark>,
}

impl Overlay {
    pub(super) fn of(scene: &Scene, lens: &Lens) -> Self {
        let spots = scene.laser.beams();
        let camera = &scene.camera;
        let target = |i: usize| spots[i].target.position;
        let near = 1e-3 * lens.depth(camera.view.at([0.5, 0.5]).position).abs();
        let mut overlay = Self::default();
        let mut add = |ends: [DVec3; 2], ink: [u8; 3], half: f64, opacity: f64| {
            if let Some(mark) = Mark::between(lens, ends, near) {
                overlay.marks.push(Mark {
                    half,
                    opacity,
                    colour: ink.map(|c| Transfer::Srgb.decode(f64::from(c) / 255.0)),
                    ..mark
                });
            }
        };
        for surface in scene.surfaces.iter().filter(|s| s.role == Role::Hidden) {
            if let Shape::Parallelogram(patch) = &surface.shape {
                let corners = patch.corners();
                for k in 0..4 {
                    add([corners[k], corners[(k + 1) % 4]], OBJECT, EDGE, 1.0);
                }
            }
        }
        for i in (0..spots.len()).step_by(spots.len().div_ceil(BEAMS).max(1)) {
            add([scene.laser.position, target(i)], LASER, BEAM, SHEER);
        }
        let corners = camera.view.corners();
        for corner in corners {
            add([camera.position, corner], CAMERA, BEAM, SHEER);
        }
        for k in 0..4 {
            add([corners[k], corners[(k + 1) % 4]], CAMERA, EDGE, 1.0);
        }
        for i in 0..spots.len() {
            add([target(i); 2], LASER, SPOT, 1.0);
        }
        let laser = (!scene.laser.is_shining()).then_some((scene.laser.position, LASER));
        for (position, ink) in [(camera.position, CAMERA)].into_iter().chain(laser) {
            add([position; 2], [0xff; 3], DEVICE + 1.5, 1.0);
            add([position; 2], ink, DEVICE, 1.0);
        }
        overlay
    }

    /// Those that may touch row `y` of the picture.
    pub(super) fn of_row(&self, y: usize) -> Vec<&Mark> {
        self.marks.iter().filter(|s| s.touches_row(y)).collect()
    }
}

/// The colour at a place where what lies behind has the colour `behind` and the depth `depth`.
pub(super) fn over(marks: &[&Mark], at: [f64; 2], depth: f64, behind: Colour) -> Colour {
    marks.iter().fold(behind, |under, mark| {
        match mark.depth_at(at).filter(|d| d * (1.0 - SLACK) < depth) {
            Some(_) => [0, 1, 2].map(|c| under[c] + mark.opacity * (mark.colour[c] - under[c])),
            None => under,
        }
    })
}
