//! Which entries of Φcam light may reach at all.

use std::ops::Range;

use rayon::prelude::*;

use super::beam::Beams;
use super::camera::{PixelView, sees_nothing};
use super::direct_light::DirectLight;
use super::visibility::{End, all_ends, all_shapes, may_light, may_reach, sends_light};
use crate::geometry::ShapeId;
use crate::scene::Scene;

/// What pixels may see and what beams may light, judged conservatively.
#[derive(Debug)]
pub(super) struct MayBeLit<'a> {
    scene: &'a Scene,
    direct: DirectLight,
    /// By pixel: what it may see that reflects; none where that is anything.
    seen: Vec<Option<Side>>,
    /// Anything that reflects.
    anything: Side,
    /// By column: what the beam may light.
    lit: Vec<Side>,
}

/// Where paths begin or end.
#[derive(Debug)]
struct Side {
    ends: Vec<End>,
    /// Shapes that reflect and that light may come from or go to, in order.
    faced: Vec<ShapeId>,
}

impl Side {
    fn new(scene: &Scene, ends: Vec<End>) -> Self {
        let is_faced = |t: &ShapeId| ends.iter().any(|end| may_reach(scene, end, *t));
        let faced = all_shapes(scene).filter(is_faced).collect();
        Self { ends, faced }
    }
}

/// What the light of a spot may meet next.
fn lit(scene: &Scene, beams: &Beams<'_>, spot: usize) -> Side {
    let mut ends = beams.ends(spot);
    ends.retain(|(id, _)| sends_light(scene, *id));
    Side::new(scene, ends)
}

impl<'a> MayBeLit<'a> {
    pub(super) fn new(scene: &'a Scene, spots: Range<usize>) -> Self {
        let beams = Beams::new(scene);
        let reflecting = |mut ends: Vec<End>| {
            ends.retain(|(s, _)| !scene.surfaces[*s as usize].is_black());
            Side::new(scene, ends)
        };
        let seen = |pixel: usize| {
            let known = PixelView::new(scene, pixel).end(scene);
            let nothing = || sees_nothing(scene, pixel).then(Vec::new);
            let ends = known.map(|end| vec![end]).or_else(nothing);
            ends.map(reflecting)
        };
        let pixels = (0..scene.camera.pixels()).into_par_iter();
        Self {
            scene,
            direct: DirectLight::new(&beams, &spots),
            seen: pixels.map(seen).collect(),
            anything: reflecting(all_ends(scene)),
            lit: spots.map(|spot| lit(scene, &beams, spot)).collect(),
        }
    }

    /// Whether light of a column may reach a pixel: no where the beam lands on nothing that
    /// reflects, where the pixel sees nothing, or where between any two ends of a path one lies
    /// behind the other or is black. Shapes in between are not considered, so a yes may be wrong.
    pub(super) fn entry(&self, pixel: usize, column: usize) -> bool {
        let (scene, lit) = (self.scene, &self.lit[column]);
        let seen = self.seen[pixel].as_ref().unwrap_or(&self.anything);
        if seen.ends.is_empty() || lit.ends.is_empty() {
            return false;
        }
        let two = || {
            let from = |t: &End| seen.ends.iter().any(|s| may_light(scene, s, t));
            lit.ends.iter().any(from)
        };
        let is_between = |t: &ShapeId| scene.max_bounces > 3 || lit.faced.binary_search(t).is_ok();
        self.direct.may_reach(pixel, column)
            || scene.max_bounces > 1 && two()
            || scene.max_bounces > 2 && seen.faced.iter().any(is_between)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::DVec3;
    use crate::scene::Parameter;
    use crate::scene::file::SceneFile;

    /// Of spots and pixels on the wall those behind the plane of the board are dark, as its
    /// equation says, and a spot whose light lands on something black; no others, but for a pixel
    /// that sees the spot itself.
    #[test]
    fn behind_the_board_it_is_dark() {
        let mut file = SceneFile::builtin("bench").unwrap();
        (file.camera.view.x, file.camera.view.y) = ([0.0, 10.0], [0.0, 15.0]);
        let plate = "\n[[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
            rectangle = { corner = [4.5, 2.5, 0.1], u = [1, 0, 0], v = [0, 1, 0] }\n\
            material = { lambertian = 0.0 }\n";
        let scene = Scene::from_toml("plate", &(file.toml().unwrap() + plate)).unwrap();
        let spots: Vec<[f64; 2]> = (0..15).map(|k| [5.0, f64::from(k)]).collect();
        let scene = scene.with_spots_at(&spots).unwrap();
        // So near that its plane meets the wall within the view.
        let normal = Parameter::named(&scene, "hidden.normal").unwrap();
        let scene = scene.displaced(&normal, &[3.0]).unwrap();
        let (_, board) = scene.hidden().next().unwrap();
        let middle = board.shape.at([0.5; 2]);
        let front = |p: DVec3| (p - middle.position).dot(middle.normal) > 0.0;
        let judged = MayBeLit::new(&scene, 0..spots.len());
        let mut dark = 0;
        for pixel in 0..scene.camera.pixels() {
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
            let footprint = scene.camera.footprint(pixel);
            let is_seen = corners.iter().any(|ab| front(footprint.at(*ab)));
            // A pixel in which the plate is seen may hold anything.
            if PixelView::new(&scene, pixel).shape().is_none() {
                continue;
            }
            for (column, spot) in scene.laser.spots.iter().enumerate() {
                let at = spot.target.position;
                let by_itself = column != 3 && scene.camera.pixel_of(at) == Some(pixel);
                let expected = by_itself || column != 3 && is_seen && front(at);
                assert_eq!(judged.entry(pixel, column), expected, "{pixel} {column}");
                dark += usize::from(!expected && column != 3);
            }
        }
        assert!(dark > scene.camera.pixels());
    }
}
