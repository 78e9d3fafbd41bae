//! Lit spots as Python literals.

use super::triple;
use crate::geometry::{Basis, DVec3, Ray, ShapeId};
use crate::num::warp;
use crate::scene::{Laser, Profile, Scene, Spot};

/// A spot that does not fall whole on one flat surface of one albedo is SIDE² points of equal
/// power.
pub(super) const SIDE: usize = 32;
/// A Gaussian ends here, in units of its radius w: exp(−2·3²) = 1.5e-8 of the peak.
const CUT: f64 = 3.0;

/// A map of the unit square.
type Warp = fn(warp::Point2) -> warp::Point2;

/// The point that a ray of the beam lights.
struct LitPoint {
    shape: ShapeId,
    position: DVec3,
    normal: DVec3,
    uv: [f64; 2],
    albedo: f64,
}

/// First surface that the ray from the laser through `aim` meets, if it meets its front.
fn lit_point(scene: &Scene, aim: DVec3) -> Option<LitPoint> {
    let from = scene.laser.position;
    let direction = (aim - from).try_normalize()?;
    let ray = Ray::new(from, direction);
    let hit = scene.bvh().closest(&ray, None)?;
    let surface = &scene.surfaces[hit.shape as usize];
    let point = scene.bvh().point(&ray, hit);
    (point.normal.dot(direction) < 0.0).then(|| LitPoint {
        shape: hit.shape,
        position: point.position,
        normal: point.normal,
        uv: point.uv,
        albedo: surface.albedo.albedo(point.uv),
    })
}

/// One entry of SPOTS.
pub(super) fn literal(scene: &Scene, spot: &Spot) -> String {
    let Laser { profile, .. } = scene.laser;
    let target = spot.target;
    let frame = Basis::around(target.normal);
    let aim = |[x, y]: [f64; 2], scale: f64| {
        lit_point(
            scene,
            target.position + frame.to_world([x * scale, y * scale, 0.0]),
        )
    };
    let lambertian = |at: &LitPoint| scene.surfaces[at.shape as usize].is_lambertian();
    let entry = |kind: &str, at: &LitPoint, size: f64| {
        let (position, normal) = (triple(at.position), triple(at.normal));
        if !lambertian(at) {
            let ([u, v], shape) = (at.uv, at.shape);
            return format!(
                "(\"glossy\", {position}, {normal}, {size:?}, {shape}, ({u:?}, {v:?}))"
            );
        }
        format!(
            "(\"{kind}\", {position}, {normal}, {:?}, {size:?})",
            at.albedo
        )
    };
    let centre = aim([0.0, 0.0], 0.0);
    let (kind, radius, reach, map): (_, _, _, Warp) = match profile {
        Profile::Shining { .. } => return String::new(),
        Profile::Ideal => {
            let at = centre.map_or(String::new(), |at| entry("point", &at, 1.0));
            return format!("    [{at}],\n");
        }
        Profile::Disc { radius } => ("disc", radius, radius, warp::disc),
        Profile::Gaussian { radius } => ("gaussian", radius, CUT * radius, warp::gaussian_spot),
    };
    let whole = centre.filter(lambertian).filter(|at| {
        let same = |p: LitPoint| p.shape == spot.surface && p.albedo == at.albedo;
        // The concentric map takes the border of the square to the rim.
        let rim = (0..64).flat_map(|k| {
            let t = f64::from(k) / 64.0;
            [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]]
        });
        scene.surfaces[spot.surface as usize].shape.is_flat()
            && grid(64)
                .chain(rim)
                .all(|u| aim(warp::disc(u), reach).is_some_and(same))
    });
    let parts: Vec<String> = match whole {
        Some(at) => vec![entry(kind, &at, radius)],
        None => grid(SIDE)
            .filter_map(|u| aim(map(u), radius))
            .map(|at| entry("point", &at, 1.0 / (SIDE * SIDE) as f64))
            .collect(),
    };
    format!("    [{}],\n", parts.join(", "))
}

/// Middles of the cells of an n × n grid over the unit square.
fn grid(n: usize) -> impl Iterator<Item = [f64; 2]> {
    let middle = move |i: usize| (i as f64 + 0.5) / n as f64;
    (0..n * n).map(move |k| [middle(k % n), middle(k / n)])
}
