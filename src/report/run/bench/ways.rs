//! Ways of the light over a few points of the hidden surfaces, and which of them are free.

use serde::Serialize;

use super::super::super::encode::base64;
use crate::geometry::{DVec3, Interaction, Ray, ShapeId};
use crate::scene::{Role, Scene};

/// Points at most; each has a bit of a byte.
const MOST_POINTS: usize = 5;
/// Candidates a side on every hidden surface.
const CANDIDATES: usize = 8;
/// With more pixels than this no way to them is asked for.
const MOST_PIXELS: usize = 1 << 16;

/// Points over which ways are drawn. Bit k of a byte: whether nothing stands between the spot, or
/// what the pixel sees, and the front of point k.
#[derive(Serialize)]
pub(super) struct Ways {
    points: Vec<[f64; 3]>,
    /// A byte for every spot that is drawn, in base64.
    spots: String,
    /// A byte for every pixel, in base64; `None` where the pixels are too many.
    pixels: Option<String>,
}

/// A point on a shape.
type Place = (ShapeId, Interaction);

/// Whether light passes between the fronts of two points.
fn free(scene: &Scene, (a, p): &Place, (b, q): &Place) -> bool {
    let way = q.position - p.position;
    way.dot(p.normal) > 0.0
        && way.dot(q.normal) < 0.0
        && Ray::between(p.position, q.position)
            .is_some_and(|ray| !scene.bvh().blocked(&ray, [Some(*a), Some(*b)]))
}

/// The point of a relay surface that a line of sight through `point` of the view's plane meets, if
/// it does.
fn seen(scene: &Scene, point: DVec3) -> Option<Place> {
    let eye = scene.camera.position;
    let ray = Ray::new(eye, (point - eye).try_normalize()?);
    let hit = scene.bvh().closest(&ray, None)?;
    let surface = scene.surfaces.get(hit.shape as usize)?;
    (surface.role == Role::Relay).then(|| (hit.shape, scene.bvh().point(&ray, hit)))
}

impl Ways {
    /// `step`: every which spot is drawn.
    pub(super) fn of(scene: &Scene, step: usize) -> Self {
        let camera = &scene.camera;
        let spots: Vec<Place> = scene
            .laser
            .beams()
            .iter()
            .step_by(step)
            .map(|s| (s.surface, s.target))
            .collect();
        let ends: Vec<Place> = spots
            .get(spots.len() / 2)
            .copied()
            .into_iter()
            .chain(seen(scene, camera.view.at([0.5, 0.5]).position))
            .collect();
        let points = chosen(scene, &ends);
        let bits = |end: &Place| {
            let bit = |(k, point): (usize, &Place)| u8::from(free(scene, point, end)) << k;
            points.iter().enumerate().map(bit).sum::<u8>()
        };
        let pixel = |pixel: usize| {
            let centre = camera.footprint(pixel).at([0.5, 0.5]);
            seen(scene, centre).map_or(0, |place| bits(&place))
        };
        let count = camera.pixels();
        let few = count <= MOST_PIXELS;
        Self {
            points: points.iter().map(|(_, p)| p.position.to_array()).collect(),
            spots: base64(&spots.iter().map(bits).collect::<Vec<u8>>()),
            pixels: few.then(|| base64(&(0..count).map(pixel).collect::<Vec<u8>>())),
        }
    }
}

/// Points of the hidden surfaces, far from each other, that as many of `ends` as possible see.
fn chosen(scene: &Scene, ends: &[Place]) -> Vec<Place> {
    let at = |k: usize| (k as f64 + 0.5) / CANDIDATES as f64;
    let grid = (0..CANDIDATES * CANDIDATES).map(|k| [at(k % CANDIDATES), at(k / CANDIDATES)]);
    let all: Vec<(usize, Place)> = scene
        .hidden()
        .flat_map(|(id, s)| grid.clone().map(move |uv| (id as ShapeId, s.shape.at(uv))))
        .map(|place| {
            let seen = ends.iter().filter(|end| free(scene, &place, end)).count();
            (seen, place)
        })
        .collect();
    let best = all.iter().map(|(seen, _)| *seen).max().unwrap_or(0);
    let mut left: Vec<Place> = all
        .into_iter()
        .filter(|(seen, _)| *seen == best)
        .map(|(_, place)| place)
        .collect();
    let mean = left.iter().map(|(_, p)| p.position).sum::<DVec3>() / left.len().max(1) as f64;
    // The one nearest to the middle, then always the one farthest from those taken.
    let mut taken: Vec<Place> = Vec::new();
    while taken.len() < MOST_POINTS && !left.is_empty() {
        let merit = |(_, p): &Place| {
            let to = |q: DVec3| (p.position - q).length();
            let nearest = taken
                .iter()
                .map(|(_, q)| to(q.position))
                .fold(f64::INFINITY, f64::min);
            if taken.is_empty() { -to(mean) } else { nearest }
        };
        let best = (0..left.len()).reduce(|a, b| {
            if merit(&left[b]) > merit(&left[a]) {
                b
            } else {
                a
            }
        });
        taken.extend(best.map(|i| left.swap_remove(i)));
    }
    taken
}

#[cfg(test)]
mod tests {
    use base64::prelude::{BASE64_STANDARD, Engine};

    use super::*;

    fn bytes(text: &str) -> Vec<u8> {
        BASE64_STANDARD.decode(text).unwrap()
    }

    /// On the bench nothing stands between wall and object, and every spot is in front of its
    /// leaning face.
    #[test]
    fn on_the_bench_all_ways_are_free() {
        let scene = Scene::load("bench").unwrap();
        let ways = Ways::of(&scene, 1);
        assert_eq!(ways.points.len(), 5);
        // The object: x from 3 to 7, on the plane y + z = 15.5.
        for [x, y, z] in &ways.points {
            assert!((3.0..=7.0).contains(x) && (y + z - 15.5).abs() < 1e-12);
        }
        assert_eq!(bytes(&ways.spots), [0b11111; 120]);
        assert_eq!(bytes(&ways.pixels.unwrap()), [0b11111; 256]);
    }

    /// The shelf's board is the box [5.2, 7.4] × [6.9, 8] × [2.4, 2.525], its rod is left out: a
    /// segment is cut by the slab method, written on its own.
    #[test]
    fn a_board_blocks_what_it_is_in_the_way_of() {
        let text = include_str!("../../../../scenes/shelf.toml");
        let (without, _) = text.split_once("[[surface]]\nname = \"rod\"").unwrap();
        let scene = Scene::from_toml("test", without).unwrap();
        let ways = Ways::of(&scene, 1);
        let (low, high) = ([5.2, 6.9, 2.4], [7.4, 8.0, 2.525]);
        let cut = |a: [f64; 3], b: [f64; 3]| {
            let mut range = [0.0f64, 1.0];
            for i in 0..3 {
                let t = [low[i], high[i]].map(|x| (x - a[i]) / (b[i] - a[i]));
                range = [range[0].max(t[0].min(t[1])), range[1].min(t[0].max(t[1]))];
            }
            range[0] < range[1]
        };
        let check = |byte: u8, end: DVec3| {
            for (k, point) in ways.points.iter().enumerate() {
                assert_eq!(
                    byte >> k & 1 == 1,
                    !cut(end.to_array(), *point),
                    "{k} {end}"
                );
            }
        };
        for (spot, byte) in scene.laser.spots.iter().zip(bytes(&ways.spots)) {
            check(byte, spot.target.position);
        }
        let pixels = bytes(ways.pixels.as_ref().unwrap());
        for (pixel, byte) in pixels.iter().enumerate() {
            check(*byte, scene.camera.footprint(pixel).at([0.5, 0.5]));
        }
        let blocked = |bytes: &[u8]| bytes.iter().any(|b| *b != 0b11111);
        assert!(blocked(&bytes(&ways.spots)) || blocked(&pixels));
    }
}
