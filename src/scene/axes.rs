//! The axes along which a scene's spots and view are given, where they are not those of its file:
//! a wall in any plane.

use serde::{Deserialize, Serialize};

use super::Role;
use super::error::{Fault, keys};
use super::exactly;
use super::surface::{Surface, of_role};
use crate::geometry::{DAffine3, DMat3, DVec3, Shape};

/// The `axes` table: directions of the scene's x and y in the coordinates of the file; z = x × y.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct AxesTable {
    /// Direction of the scene's x, of any length but 0.
    #[serde(deserialize_with = "exactly::one")]
    pub x: [f64; 3],
    /// Direction of the scene's y, at a right angle to x.
    #[serde(deserialize_with = "exactly::one")]
    pub y: [f64; 3],
}

/// Cosine of the angle between x and y that rounded directions may have.
const SKEW: f64 = 1e-6;

/// Turns what stands in the coordinates of the file into those of the scene,
///
/// > p ↦ (x̂·p, ŷ·p, ẑ·p),   ẑ = x̂ × ŷ,
///
/// and returns this rotation: the identity where the file names no axes.
pub(super) fn turn(surfaces: &mut [Surface], table: Option<&AxesTable>) -> Result<DAffine3, Fault> {
    let Some(table) = table else {
        return Ok(DAffine3::IDENTITY);
    };
    let turn = rotation(table)?;
    for (i, surface) in surfaces.iter_mut().enumerate() {
        surface.shape = surface.shape.moved(&turn).ok_or_else(|| {
            let cause = "the surface has no proper shape along these axes";
            Fault::new(keys!["surface", i], cause, "check its coordinates")
        })?;
    }
    Ok(turn)
}

fn rotation(table: &AxesTable) -> Result<DAffine3, Fault> {
    let direction = |key: &'static str, v: [f64; 3]| {
        DVec3::from_array(v).try_normalize().ok_or_else(|| {
            let cause = format!("{v:?} is no direction");
            let cure = "give three finite numbers that are not all 0";
            Fault::new(keys!["axes", key], cause, cure)
        })
    };
    let (x, y) = (direction("x", table.x)?, direction("y", table.y)?);
    let cosine = x.dot(y);
    if cosine.abs() > SKEW {
        let degrees = libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees();
        let cause = format!("x and y of `axes` are {degrees:.4}° apart, not 90°");
        let cure = "give the directions of two edges of the wall that meet at a right angle";
        return Err(Fault::new(keys!["axes"], cause, cure));
    }
    let z = x.cross(y).normalize();
    Ok(DAffine3::from_mat3(
        DMat3::from_cols(x, z.cross(x), z).transpose(),
    ))
}

/// Why x and y name no point of any wall, where every relay surface is parallel to z: cause and
/// cure.
pub(super) fn upright(surfaces: &[Surface]) -> Option<(String, String)> {
    let stands = |s: &Surface| {
        let middle = s.shape.at([0.5; 2]).position;
        s.shape.at_xy(middle.x, middle.y).is_empty()
    };
    let mut walls = of_role(Role::Relay, surfaces).map(|(_, s)| s);
    let first = walls.next()?;
    (stands(first) && walls.all(stands)).then(|| {
        (
            format!(
                "the wall `{}` stands parallel to z, so that no x and y name a point of it",
                first.name
            ),
            format!(
                "say with `axes` along what x and y of spots and view are: {}",
                along(first).unwrap_or_else(|| "axes = { x = […], y = […] }".to_owned())
            ),
        )
    })
}

/// The line of a scene file that lays x along the first edge of a flat wall, and z along its
/// normal.
fn along(wall: &Surface) -> Option<String> {
    let Shape::Parallelogram(p) = &wall.shape else {
        return None;
    };
    let z = p.normal();
    let x = p.u().normalize();
    let told = |d: DVec3| {
        let [x, y, z] = d.to_array().map(|c| c + 0.0);
        format!("[{x}, {y}, {z}]")
    };
    let y = told(z.cross(x));
    Some(format!("axes = {{ x = {}, y = {y} }}", told(x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file::{RotationTable, SceneFile};
    use crate::scene::{Parameter, Scene};

    /// The file of a built-in scene, everything in it turned: the same scene, told in other axes.
    fn told(name: &str, to_file: &DMat3) -> SceneFile {
        let mut file = SceneFile::builtin(name).unwrap();
        let turn = |v: &mut [f64; 3]| *v = (*to_file * DVec3::from_array(*v)).to_array();
        if let Some(laser) = &mut file.laser {
            turn(&mut laser.position);
        }
        turn(&mut file.camera.position);
        for s in &mut file.surface {
            if let Some(r) = &mut s.rectangle {
                [&mut r.corner, &mut r.u, &mut r.v]
                    .into_iter()
                    .for_each(turn);
            }
            if let Some(d) = &mut s.disc {
                [&mut d.centre, &mut d.normal].into_iter().for_each(turn);
            }
            if let Some(b) = &mut s.sphere {
                turn(&mut b.centre);
            }
            if let Some(m) = &mut s.mesh {
                let (axis, angle) = crate::geometry::DQuat::from_mat3(to_file).to_axis_angle();
                m.rotate.get_or_insert_default().push(RotationTable {
                    axis: axis.to_array(),
                    angle: angle.to_degrees(),
                });
                m.translate.iter_mut().for_each(turn);
            }
        }
        file.axes = Some(AxesTable {
            x: (to_file.x_axis * 2.5).to_array(),
            y: to_file.y_axis.to_array(),
        });
        file
    }

    /// The wall in x–z, its normal along −y; and a rotation that no axis shares.
    fn turns() -> [DMat3; 2] {
        let upright = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
        [
            upright,
            DMat3::from_axis_angle(DVec3::new(2.0, -1.0, 2.0) / 3.0, 1.9),
        ]
    }

    /// Largest distance between points of two scenes that should be one.
    fn apart(a: &Scene, b: &Scene) -> f64 {
        let mut pairs = vec![
            (a.camera.position, b.camera.position),
            (a.laser.position, b.laser.position),
        ];
        pairs.extend(
            a.camera
                .view
                .corners()
                .into_iter()
                .zip(b.camera.view.corners()),
        );
        let spots = a.laser.spots.iter().zip(&b.laser.spots);
        pairs.extend(spots.map(|(s, t)| (s.target.position, t.target.position)));
        for (s, t) in a.surfaces.iter().zip(&b.surfaces) {
            for uv in [[0.1, 0.2], [0.9, 0.3], [0.4, 0.8]] {
                let (p, q) = (s.shape.at(uv), t.shape.at(uv));
                pairs.push((p.position, q.position));
                pairs.push((p.normal, q.normal));
            }
        }
        pairs
            .iter()
            .map(|(p, q)| p.distance(*q))
            .fold(0.0, f64::max)
    }

    /// Rectangles, discs, meshes, spheres, a laser and a screen that shines.
    #[test]
    fn a_scene_told_along_other_axes_is_the_same_scene() {
        for name in [
            "bench",
            "satin",
            "shelf",
            "periscope",
            "masked-card",
            "screen",
        ] {
            let own = Scene::load(name).unwrap();
            for turn in &turns() {
                let scene = Scene::new(&told(name, turn), None).unwrap();
                let error = apart(&own, &scene);
                assert!(error < 1e-12 * 50.0, "{name}: {error:e}");
                let back = scene.to_file().matrix3;
                assert!(back.abs_diff_eq(*turn, 1e-15), "{back} {turn}");
            }
        }
    }

    /// A calibrated scene is written along the axes of its own file.
    #[test]
    fn a_displaced_scene_keeps_its_axes() {
        for name in ["bench", "satin"] {
            for turn in &turns() {
                let scene = Scene::new(&told(name, turn), None).unwrap();
                let names = ["hinge.angle", "wall.x", "camera.z", "spots.x"];
                let named = |name: &&str| Parameter::named(&scene, name).unwrap();
                let each: Vec<Parameter> = names.iter().flat_map(named).collect();
                let values = [2.0, 0.1, 1.5, 0.2];
                let moved = scene.displaced(&each, &values).unwrap();
                let file = scene.displaced_file(&each, &values).unwrap();
                assert_eq!(file.axes, told(name, turn).axes);
                let error = apart(&moved, &Scene::new(&file, None).unwrap());
                assert!(error < 1e-12 * 50.0, "{name}: {error:e}");
            }
        }
    }

    /// Studies of layouts write the places of rectangles into the text.
    #[test]
    fn listed_spots_keep_the_axes() {
        for turn in &turns() {
            let scene = Scene::new(&told("bench", turn), None).unwrap();
            let listed = scene.with_listed_spots(&[[2.0, 4.0], [7.5, 5.0]]).unwrap();
            let read = Scene::from_toml("listed", &listed.text).unwrap();
            assert!(apart(&listed, &read) < 1e-12 * 50.0);
        }
    }

    #[test]
    fn axes_that_are_none_are_refused() {
        let refused = |key: &str, x, y, words: &str| {
            let mut file = told("bench", &turns()[0]);
            file.axes = Some(AxesTable { x, y });
            let error = Scene::new(&file, None).unwrap_err();
            assert!(error.cause.contains(words), "{}", error.cause);
            let line = error.place.unwrap().text;
            assert!(line.contains("axes") || line.starts_with(key), "{line}");
        };
        refused("x =", [0.0; 3], [0.0, 1.0, 0.0], "no direction");
        refused("y =", [1.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], "no direction");
        refused(
            "y =",
            [1.0, 0.0, 0.0],
            [0.0, 0.0, f64::INFINITY],
            "no direction",
        );
        refused(
            "[axes]",
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
            "45.0000° apart, not 90°",
        );
        refused("[axes]", [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], "0.0000° apart");
    }

    /// The refusal of an upright wall gives the line that is missing.
    #[test]
    fn the_cure_of_an_upright_wall_cures_it() {
        for turn in &turns()[..1] {
            let mut file = told("bench", turn);
            file.axes = None;
            let text = file.toml().unwrap();
            let error = Scene::from_toml("own", &text).unwrap_err();
            assert!(
                error.cause.contains("stands parallel to z"),
                "{}",
                error.cause
            );
            let (_, line) = error.cure.split_once(": ").unwrap();
            let line = line.split(';').next().unwrap();
            let mended = text.replacen("max_bounces", &format!("{line}\nmax_bounces"), 1);
            let scene = Scene::from_toml("own", &mended).unwrap();
            assert!(apart(&Scene::load("bench").unwrap(), &scene) < 1e-12 * 50.0);
        }
    }
}
