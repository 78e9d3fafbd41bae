//! Numbers of a scene that measurements know only roughly, by their names: of its geometry, and how
//! its laser and its walls spread light.
//!
//! | name | what it is | unit |
//! | --- | --- | --- |
//! | `hinge.angle` | turn of all hidden surfaces about the line where the first one's plane meets the wall's | deg |
//! | `WHAT.x`, `.y`, `.z`, `.normal`, `.u`, `.v` | shift along an axis of the scene, or of the surface | the scene's |
//! | `WHAT.pitch`, `.yaw`, `.roll` | turn about u, v and the normal through the surface's middle | deg |
//! | `spots.x`, `.y`, `.angle`, `.scale` | shift, turn and growth of all spots about their mean | the scene's, deg, % |
//! | `spots.3.x`, `spots.3.y` | shift of spot 3 alone, from 0 | the scene's |
//! | `view.x`, `.y`, `.scale` | shift and growth of what the camera sees | the scene's, % |
//! | `camera.x`, `.y`, `.z`, `laser.x`, `.y`, `.z` | shift of the pinhole, of where the beams start | the scene's |
//! | `laser.spot_diameter` | growth of the diameter of all spots | % |
//! | `WALL.roughness` | growth of the roughness of a wall's material, of all parts of a mixture | % |
//! | `WALL.ior` | growth of n − 1, n the refractive index of a wall's coat | % |
//! | `WALL.albedo` | growth of the albedo of a wall, if it is not the scale of all light | % |
//! | `WALL.mixture.K.weight` | what is added to the weight of part K of a wall's mixture, from 0, and taken from all others in proportion, so that their sum stays | percentage points |
//!
//! `WHAT` is a surface, or `hidden`, `wall`, `occluders`: all of that role, moved as one body. A
//! mesh and a sphere have the axes of the scene for u, v and normal. `WALL` is a wall, or `wall`:
//! all of them. `spots.shift` stands for
//! `spots.x` and `spots.y`, `spots.each` for both of every spot, `view.shift` and `WHAT.position`
//! (also of `camera` and `laser`) for their shifts along the axes.

mod motion;
mod reflection;

use std::collections::BTreeMap;

use super::error::{Fault, keys};
use super::parse;
use super::surface::{Surface, of_role};
use super::{Profile, Role, Scene, SceneError};
use crate::geometry::DVec3;
use motion::of_surfaces;

/// A number of a scene, 0 where the scene is as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Degrees, percent, percentage points, or the scene's unit of length.
    pub unit: String,
    pub(super) kind: Kind,
}

/// What a parameter changes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// A rigid motion of these surfaces together.
    Surfaces(Vec<usize>, Motion),
    /// A shift of all spots along x (0) or y (1).
    SpotsShift(usize),
    /// A turn of all spots about their mean.
    SpotsAngle,
    /// Growth of the layout of the spots about their mean.
    SpotsScale,
    /// A shift of one spot along x (0) or y (1).
    Spot(usize, usize),
    /// A shift of the view along x (0) or y (1).
    ViewShift(usize),
    /// Growth of the view about its middle.
    ViewScale,
    /// A shift of the pinhole.
    Camera(DVec3),
    /// A shift of where the beams start.
    Laser(DVec3),
    /// Growth of the diameter of all spots.
    SpotDiameter,
    /// Growth of the roughness of these walls.
    Roughness(Vec<usize>),
    /// Growth of n − 1 of the coats of these walls.
    Contrast(Vec<usize>),
    /// Growth of the albedo of these walls.
    Albedo(Vec<usize>),
    /// What is added to the weight of a part of the mixtures of these walls.
    Weight(Vec<usize>, usize),
}

impl Kind {
    fn is_of_reflection(&self) -> bool {
        matches!(
            self,
            Self::Roughness(_) | Self::Contrast(_) | Self::Albedo(_) | Self::Weight(..)
        )
    }
}

/// A rigid motion with one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// By a length along a unit vector.
    Along(DVec3),
    /// By degrees about the axis through a point.
    About { point: DVec3, axis: DVec3 },
}

const AXES: [(&str, DVec3); 3] = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];

impl Parameter {
    /// The parameters of `scene` that a name stands for.
    ///
    /// # Errors
    /// [`SceneError`] where it has none of that name, or one that no light can tell: a shift or
    /// turn of a flat hidden surface within its own plane moves the picture's coordinates, nothing
    /// else.
    pub fn named(scene: &Scene, name: &str) -> Result<Vec<Self>, SceneError> {
        named(scene, name).map_err(|fault| parse::locate(&scene.name, &scene.text, fault))
    }

    /// Shifts along u, v and the normal of what stands in the way: of each occluder, of all as one
    /// body where there are many.
    pub fn of_occluders(scene: &Scene) -> Vec<Self> {
        let names: Vec<&str> = of_role(Role::Occluder, &scene.surfaces)
            .filter(|(id, _)| scene.front_of(*id).is_none())
            .map(|(_, s)| s.name.as_str())
            .collect();
        let bodies = if names.len() > MOST_BODIES {
            vec!["occluders"]
        } else {
            names
        };
        let unit = scene.unit.symbol();
        let shift = |(what, which): (&str, &str)| {
            let name = format!("{what}.{which}");
            let kind = of_surfaces(scene, what, which, &name).ok()?;
            Some(Self {
                unit: unit.to_owned(),
                name,
                kind,
            })
        };
        let all = bodies.into_iter();
        let all = all.flat_map(|what| ["u", "v", "normal"].map(|which| (what, which)));
        all.filter_map(shift).collect()
    }

    /// Whether it turns things: its unit is degrees.
    pub fn is_angle(&self) -> bool {
        self.unit == DEGREES
    }

    /// Whether it is the size of the spots, which nothing tells that takes each for a point.
    pub fn is_spot_size(&self) -> bool {
        self.kind == Kind::SpotDiameter
    }

    /// Whether it is of how spots and walls spread light, not of where things are.
    pub fn is_of_spread(&self) -> bool {
        self.is_spot_size() || self.kind.is_of_reflection()
    }

    /// Whether its unit is percent, of itself or of a whole.
    pub fn is_percent(&self) -> bool {
        [PERCENT, Self::POINTS].contains(&self.unit.as_str())
    }

    /// The unit of a weight of a mixture: 2 of them make 0.32 of 0.3.
    pub const POINTS: &str = "percentage points";
}

/// Occluders up to which each has shifts of its own.
const MOST_BODIES: usize = 8;

/// The name of a surface's other side.
fn back(name: &str) -> String {
    format!("{name} (back)")
}

impl Scene {
    /// The surface of which surface `id` is the back; none of a front.
    pub fn front_of(&self, id: usize) -> Option<usize> {
        let own = &self.surfaces[id].name;
        self.surfaces.iter().position(|s| back(&s.name) == *own)
    }
}

/// The table of uncertainties, checked.
pub(super) fn uncertainty(
    scene: &Scene,
    table: &BTreeMap<String, f64>,
) -> Result<Vec<(String, f64)>, Fault> {
    for (name, sigma) in table {
        named(scene, name).map_err(|fault| Fault {
            path: keys!["uncertainty"].to_vec(),
            ..fault
        })?;
        if !(*sigma > 0.0 && sigma.is_finite()) {
            let cause = format!("`{name}` is uncertain by {sigma}");
            let cure = "give a standard deviation above 0, in degrees, percent or the scene's unit";
            return Err(Fault::new(keys!["uncertainty"], cause, cure));
        }
    }
    Ok(table.iter().map(|(name, s)| (name.clone(), *s)).collect())
}

const DEGREES: &str = "deg";
const PERCENT: &str = "%";

fn unknown(name: &str) -> Fault {
    let cause = format!("the scene has no parameter `{name}`");
    let cure = "use hinge.angle, hidden.normal, hidden.yaw, spots.shift, spots.each, view.shift, view.scale, camera.position, laser.position, laser.spot_diameter, a surface's name with .x .y .z .normal .u .v .pitch .yaw .roll, or a wall's with .roughness .ior .albedo .mixture.0.weight";
    Fault::new(keys![], cause, cure)
}

fn named(scene: &Scene, name: &str) -> Result<Vec<Parameter>, Fault> {
    let Some((what, which)) = name.rsplit_once('.') else {
        return Err(unknown(name));
    };
    let one = |which: &str| format!("{what}.{which}");
    let all = |each: &[&str]| -> Result<Vec<Parameter>, Fault> {
        let each = each.iter().map(|which| named(scene, &one(which)));
        Ok(each.collect::<Result<Vec<_>, _>>()?.concat())
    };
    match (what, which) {
        ("spots" | "view", "shift") => all(&["x", "y"]),
        ("spots", "each") => {
            let spots = 0..scene.laser.spots.len();
            let names = spots.flat_map(|l| ["x", "y"].map(|axis| format!("spots.{l}.{axis}")));
            let each = names.map(|name| named(scene, &name));
            Ok(each.collect::<Result<Vec<_>, _>>()?.concat())
        }
        ("spots" | "view", "position") => Err(unknown(name)),
        (_, "position") => all(&["x", "y", "z"]),
        _ => single(scene, what, which, name).map(|found| vec![found]),
    }
}

/// The parameter `which` of `what`.
fn single(scene: &Scene, what: &str, which: &str, name: &str) -> Result<Parameter, Fault> {
    let axis = AXES.iter().position(|(axis, _)| *axis == which);
    let direction = axis.map(|k| AXES[k].1);
    let plane = axis.filter(|k| *k < 2);
    let lasers = what == "laser" || what == "spots" || what.starts_with("spots.");
    if lasers && scene.laser.is_shining() {
        let cause = format!("there is no laser, and so no `{name}`: a hidden surface shines");
        return Err(Fault::new(keys!["surface"], cause, "leave it out"));
    }
    let missing = || unknown(name);
    let kind = match (what, which) {
        ("hinge", "angle") => {
            let hidden = of_role(Role::Hidden, &scene.surfaces).map(|(id, _)| id);
            let Some((point, axis)) = scene.hinge() else {
                let cause = "hidden surface and wall are parallel: there is no hinge";
                let cure = "use hidden.pitch and hidden.yaw";
                return Err(Fault::new(keys!["surface"], cause, cure));
            };
            Kind::Surfaces(hidden.collect(), Motion::About { point, axis })
        }
        ("spots", "angle") => Kind::SpotsAngle,
        ("spots", "scale") => Kind::SpotsScale,
        ("spots", _) => Kind::SpotsShift(plane.ok_or_else(missing)?),
        ("view", "scale") => Kind::ViewScale,
        ("view", _) => Kind::ViewShift(plane.ok_or_else(missing)?),
        ("camera", _) => Kind::Camera(direction.ok_or_else(missing)?),
        ("laser", "spot_diameter") => {
            if scene.laser.profile == Profile::Ideal {
                let cause =
                    "the spots are points, and the light changes by the square of their size alone";
                let cure = "write a laser.spot_diameter above 0 into the scene that is near theirs";
                return Err(Fault::new(keys!["laser", "spot_diameter"], cause, cure));
            }
            Kind::SpotDiameter
        }
        ("laser", _) => Kind::Laser(direction.ok_or_else(missing)?),
        (_, "roughness" | "ior" | "weight" | "albedo") => {
            reflection::named(scene, what, which, name)?
        }
        _ => match what.strip_prefix("spots.").map(str::parse::<usize>) {
            Some(Ok(l)) if l < scene.laser.spots.len() => Kind::Spot(l, plane.ok_or_else(missing)?),
            Some(_) => return Err(missing()),
            None => of_surfaces(scene, what, which, name)?,
        },
    };
    let unit = match kind {
        Kind::SpotsAngle | Kind::Surfaces(_, Motion::About { .. }) => DEGREES,
        Kind::SpotsScale
        | Kind::ViewScale
        | Kind::SpotDiameter
        | Kind::Roughness(_)
        | Kind::Contrast(_)
        | Kind::Albedo(_) => PERCENT,
        Kind::Weight(..) => Parameter::POINTS,
        _ => scene.unit.symbol(),
    };
    Ok(Parameter {
        name: name.to_owned(),
        unit: unit.to_owned(),
        kind,
    })
}

/// The surfaces of a name or role.
fn surfaces(scene: &Scene, what: &str) -> Vec<usize> {
    let role = match what {
        "hidden" => Some(Role::Hidden),
        "wall" => Some(Role::Relay),
        "occluders" => Some(Role::Occluder),
        _ => None,
    };
    // The two sides of a surface stay together.
    let back = back(what);
    let by_name = |s: &Surface| s.name == what || s.name == back;
    let is_name = scene.surfaces.iter().any(by_name);
    let concerned = |s: &Surface| {
        if is_name {
            by_name(s)
        } else {
            role == Some(s.role)
        }
    };
    let all = scene.surfaces.iter().enumerate();
    all.filter(|(_, s)| concerned(s))
        .map(|(id, _)| id)
        .collect()
}
