//! Rigid motions of surfaces.

use super::{Kind, Motion, surfaces, unknown};
use crate::geometry::{DVec3, Shape};
use crate::scene::error::{Fault, keys};
use crate::scene::{Role, Scene};

/// A motion of surfaces by their name or role.
pub(super) fn of_surfaces(
    scene: &Scene,
    what: &str,
    which: &str,
    name: &str,
) -> Result<Kind, Fault> {
    let ids = surfaces(scene, what);
    let Some(first) = ids.first().map(|id| &scene.surfaces[*id]) else {
        return Err(unknown(name));
    };
    let frame = frame(&first.shape);
    let axis = match which {
        "x" => DVec3::X,
        "y" => DVec3::Y,
        "z" => DVec3::Z,
        "u" | "pitch" => frame.u,
        "v" | "yaw" => frame.v,
        "normal" | "roll" => frame.normal,
        _ => return Err(unknown(name)),
    };
    let motion = match which {
        "pitch" | "yaw" | "roll" => Motion::About {
            point: frame.middle,
            axis,
        },
        _ => Motion::Along(axis),
    };
    let hidden = || ids.iter().map(|id| &scene.surfaces[*id]);
    let flat = hidden().all(|s| s.role == Role::Hidden && s.shape.is_flat());
    let normals = || hidden().map(|s| s.shape.at([0.5; 2]).normal);
    let within = match motion {
        Motion::Along(axis) => normals().all(|n| n.dot(axis).abs() < WITHIN),
        Motion::About { axis, .. } => normals().all(|n| n.cross(axis).length() < WITHIN),
    };
    if flat && within {
        let cause = format!(
            "`{name}` moves the hidden surface within its own plane: that is where on it the picture lies, no matter of calibration"
        );
        let cure = "leave it out; free its shift along the normal and its turns instead";
        return Err(Fault::new(keys!["surface"], cause, cure));
    }
    Ok(Kind::Surfaces(ids, motion))
}

/// Sine of the angle below which a motion stays within a plane.
const WITHIN: f64 = 1e-9;

/// The middle of a shape and its axes.
struct Frame {
    middle: DVec3,
    u: DVec3,
    v: DVec3,
    normal: DVec3,
}

fn frame(shape: &Shape) -> Frame {
    let middle = match shape {
        Shape::Parallelogram(_) | Shape::Disc(_) => shape.at([0.5; 2]).position,
        Shape::Sphere(_) | Shape::Instance(_) => shape.circumsphere().0,
    };
    let [u, normal] = match shape {
        Shape::Parallelogram(p) => [p.u().normalize_or_zero(), p.normal()],
        Shape::Disc(d) => [d.normal().any_orthonormal_vector(), d.normal()],
        Shape::Sphere(_) | Shape::Instance(_) => [DVec3::X, DVec3::Z],
    };
    Frame {
        middle,
        u,
        v: normal.cross(u),
        normal,
    }
}
