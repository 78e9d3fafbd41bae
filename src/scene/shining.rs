//! A hidden surface that shines in place of a laser's spots.

use super::error::{Fault, Step, keys};
use super::file::SceneFile;
use super::laser::{Laser, Profile, Spot};
use super::material::Shown;
use super::surface::{Role, Surface};
use super::{Cells, Scene, Texture};
use crate::geometry::{Shape, ShapeId};

/// Wavelength of a surface that shines and does not state it, m: about where the eye sees best.
const WAVELENGTH: f64 = 550e-9;
/// Least and largest total power, W: fluxes stay in the range of f64.
const POWERS: [f64; 2] = [1e-60, 1e60];

impl Scene {
    /// The surface that shines, with its shape id; `None` where a laser lights the scene.
    pub fn shining(&self) -> Option<(ShapeId, &Surface)> {
        match self.laser.profile {
            Profile::Shining { .. } => {
                let all = self.hidden().find(|(_, s)| s.shining().is_some());
                all.map(|(id, surface)| (id as ShapeId, surface))
            }
            _ => None,
        }
    }
}

impl Laser {
    /// Whether a surface shines in place of a laser.
    pub fn is_shining(&self) -> bool {
        matches!(self.profile, Profile::Shining { .. })
    }

    /// The spots that a laser lights; none where a surface shines.
    pub fn beams(&self) -> &[Spot] {
        if self.is_shining() { &[] } else { &self.spots }
    }

    /// Corner and width, in the parameters of the surface that shines, of what shines in column
    /// `spot`; `None` of a laser.
    pub fn part(&self, spot: usize) -> Option<[[f64; 2]; 2]> {
        let Profile::Shining { columns } = self.profile else {
            return None;
        };
        let width = columns.map(|n| 1.0 / n as f64);
        let middle = self.spots[spot].target.uv;
        let corner = [0, 1].map(|d| middle[d] - 0.5 * width[d]);
        Some([corner, width])
    }

    /// M at the point `uv` of the surface that shines if it shines there in column `spot`, else 0.
    pub fn exitance(&self, surface: &Surface, spot: usize, uv: [f64; 2]) -> f64 {
        match (surface.shining(), self.part(spot)) {
            (Some(shining), Some([corner, width])) => {
                let inside = |d: usize| {
                    let at = (uv[d] - corner[d]) / width[d];
                    // Rounding may put a point of the rim outside.
                    (at >= 0.0 || corner[d] <= 1e-9)
                        && (at < 1.0 || corner[d] + width[d] >= 1.0 - 1e-9)
                };
                if inside(0) && inside(1) {
                    shining.exitance
                } else {
                    0.0
                }
            }
            _ => 0.0,
        }
    }

    /// The share of element `index` of a grid of `count` elements along u and v that shines in
    /// column `spot`; 0 of a laser.
    pub fn share(&self, spot: usize, (index, count): (usize, [usize; 2])) -> f64 {
        let Some([corner, width]) = self.part(spot) else {
            return 0.0;
        };
        let place = [index % count[0], index / count[0]];
        let overlap = |d: usize| {
            let n = count[d] as f64;
            let [from, to] = [corner[d] * n, (corner[d] + width[d]) * n];
            let at = place[d] as f64;
            let share = to.min(at + 1.0) - from.max(at);
            // Where the edges of both grids are the same, but for rounding.
            if share < 1e-9 {
                0.0
            } else if share > 1.0 - 1e-9 {
                1.0
            } else {
                share
            }
        };
        overlap(0) * overlap(1)
    }

    /// The light of the surface that shines, if one does: a column for all of it, or one for each
    /// of its elements. Position and targets are the middles of the surface and of what shines.
    pub(super) fn of_shining(
        file: &SceneFile,
        surfaces: &mut [Surface],
    ) -> Result<Option<Self>, Fault> {
        let mut all = surfaces
            .iter()
            .enumerate()
            .filter(|(_, s)| s.shining().is_some());
        let misplaced = all.clone().find(|(_, s)| s.role != Role::Hidden);
        let Some((id, _)) = misplaced.or_else(|| all.next()) else {
            return Ok(None);
        };
        refuse_other_light(file, surfaces, id)?;
        let at = |key| keys!["surface", id, "material", key];
        let wavelength = wavelength(file);
        if !(wavelength > 0.0 && wavelength.is_finite()) {
            let cause = format!("wavelength {wavelength} m");
            return Err(Fault::new(
                at("wavelength"),
                cause,
                "give it in metres, e.g. 550e-9",
            ));
        }
        let surface = &mut surfaces[id];
        let columns = match file.surface[id].material.light.unwrap_or_default() {
            Shown::Picture => [1, 1],
            Shown::Elements => {
                if surface.albedo != Texture::Constant(1.0) || !surface.is_known {
                    let cause =
                        "light = \"elements\" with a picture: each element shines alone, at 1";
                    return Err(Fault::new(at("shining"), cause, "write `shining = 1.0`"));
                }
                surface.albedo = Texture::Cells(Cells {
                    count: surface.elements,
                    albedo: vec![1.0; surface.elements.iter().product()],
                });
                surface.elements
            }
        };
        let each: usize = columns.iter().product();
        let exitance = surface.shining().map_or(0.0, |s| s.exitance);
        let power = exitance * surface.shape.area() / each as f64;
        if !(POWERS[0]..=POWERS[1]).contains(&power) {
            let cause = format!("a surface that shines with {power} W");
            return Err(Fault::new(at("exitance"), cause, "use 1e-60 to 1e60 W"));
        }
        let middle = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let spot = |l: usize| Spot {
            target: surface.shape.at([
                middle(l % columns[0], columns[0]),
                middle(l / columns[0], columns[1]),
            ]),
            surface: id as ShapeId,
        };
        Ok(Some(Self {
            power,
            wavelength,
            position: surface.shape.at([0.5; 2]).position,
            profile: Profile::Shining { columns },
            spots: (0..each).map(spot).collect(),
        }))
    }

    /// The same where surfaces have moved: what shines in each column stays in its place on its
    /// surface.
    pub(super) fn follow(&mut self, surfaces: &[Surface]) {
        if !self.is_shining() {
            return;
        }
        for spot in &mut self.spots {
            let shape = &surfaces[spot.surface as usize].shape;
            spot.target = shape.at(spot.target.uv);
            self.position = shape.at([0.5; 2]).position;
        }
    }
}

/// The wavelength of the scene's light, m.
pub(super) fn wavelength(file: &SceneFile) -> f64 {
    match &file.laser {
        Some(laser) => laser.wavelength,
        None => {
            let stated = file.surface.iter().find_map(|s| s.material.wavelength);
            stated.unwrap_or(WAVELENGTH)
        }
    }
}

/// What can shine: one hidden rectangle or disc, alone.
fn refuse_other_light(file: &SceneFile, surfaces: &[Surface], id: usize) -> Result<(), Fault> {
    let surface = &surfaces[id];
    let (name, at) = (&surface.name, |key| keys!["surface", id, key]);
    fn refuse<const N: usize>(at: [Step; N], cause: String, cure: &str) -> Result<(), Fault> {
        Err(Fault::new(at, cause, cure))
    }
    if surface.role != Role::Hidden {
        let cause = format!("`{name}` shines, and is not the hidden surface");
        let cure =
            "set role = \"hidden\" and give it `elements`, or let it reflect: `lambertian = …`";
        return refuse(at("role"), cause, cure);
    }
    if !matches!(surface.shape, Shape::Parallelogram(_) | Shape::Disc(_)) {
        let cause = format!("`{name}` shines, and is neither a rectangle nor a disc");
        return refuse(at("material"), cause, "let a rectangle or a disc shine");
    }
    let even = surface.shining().is_some_and(|s| s.is_lambertian());
    if !even && !matches!(surface.shape, Shape::Parallelogram(_)) {
        let cause =
            format!("the light of the disc `{name}` falls off along u and v, which a disc has not");
        let cure = "remove `falloff`, or let a rectangle shine";
        return refuse(keys!["surface", id, "material", "falloff"], cause, cure);
    }
    if file.laser.is_some() {
        let cause = format!("a laser, and a surface that shines: `{name}`");
        let cure = "remove the [laser] table, or let the surface reflect: `lambertian = …`";
        return refuse(keys!["laser"], cause, cure);
    }
    let others = |(other, s): &(usize, &Surface)| *other != id && s.role == Role::Hidden;
    if let Some((other, s)) = surfaces.iter().enumerate().find(others) {
        let keys = keys!["surface", other, "material"];
        return if s.shining().is_some() {
            let cause = format!("two surfaces that shine: `{name}` and `{}`", s.name);
            refuse(
                keys,
                cause,
                "keep one, and paint what both show as its picture",
            )
        } else {
            let cause = format!(
                "`{}` is hidden and reflects, beside `{name}`, which shines",
                s.name
            );
            let cure = "recover one at a time: make it an occluder, or remove one of them";
            refuse(keys, cause, cure)
        };
    }
    if file.max_bounces < 2 {
        let cause =
            "max_bounces is 1: light from a surface that shines meets that surface and a wall";
        return refuse(keys!["max_bounces"], cause.to_owned(), "use 2 or more");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneError;

    fn text() -> String {
        Scene::load("screen").unwrap().text
    }

    /// The built-in scene with one part of its text replaced.
    fn with(old: &str, new: &str) -> Result<Scene, SceneError> {
        let text = text();
        assert_eq!(text.matches(old).count(), 1, "`{old}`");
        Scene::from_toml("own", &text.replace(old, new))
    }

    /// The picture's lines, from the key on.
    fn picture() -> String {
        let text = text();
        let start = text.find("shining = {").unwrap();
        let end = start + text[start..].find("] }").unwrap() + 3;
        text[start..end].to_owned()
    }

    #[test]
    fn what_cannot_shine_is_refused() {
        let laser = "[laser]\npower = 1.0\nwavelength = 5e-7\nposition = [0.5, 0.5, 1.0]\n\
                     spots = { layout = \"list\", points = [[0.3, 0.3]] }\n[camera]";
        let second = "[[surface]]\nname = \"second\"\nrole = \"hidden\"\nelements = [1, 1]\n\
                      rectangle = { corner = [0.0, 0.6, 0.9], u = [-0.1, 0, 0], v = [0, 0.1, 0] }\n";
        let shines =
            format!("{second}material = {{ shining = 0.5 }}\n[[surface]]\nname = \"plate\"");
        let reflects = shines.replace("shining", "lambertian");
        let rectangle =
            "rectangle = { corner = [0.4, 0.1, 1.0], u = [-0.4, 0.0, 0.0], v = [0.0, 0.4, 0.0] }";
        let disc = "disc = { centre = [0.2, 0.3, 1.0], normal = [0, 0, -1], radius = 0.2 }";
        let sphere = "sphere = { centre = [0.2, 0.3, 1.2], radius = 0.1, face = \"outside\" }";
        let plate = "material = { lambertian = 0.05 }";
        let picture = picture();
        let elements = format!("light = \"elements\"\n{picture}");
        let cases: [(&str, &str, [&str; 2]); 17] = [
            (
                "[camera]",
                laser,
                [
                    "a laser, and a surface that shines",
                    "remove the [laser] table",
                ],
            ),
            (
                plate,
                "material = { shining = 1.0 }",
                ["not the hidden surface", "role = \"hidden\""],
            ),
            (
                "name = \"plate\"",
                &shines[12..],
                ["two surfaces that shine", "keep one"],
            ),
            (
                "name = \"plate\"",
                &reflects[12..],
                ["is hidden and reflects", "one at a time"],
            ),
            (
                rectangle,
                disc,
                ["which a disc has not", "remove `falloff`"],
            ),
            (
                rectangle,
                sphere,
                ["neither a rectangle nor a disc", "let a rectangle"],
            ),
            (
                "max_bounces = 2",
                "max_bounces = 1",
                ["max_bounces is 1", "use 2 or more"],
            ),
            (
                "exitance = 100.0",
                "exitance = 0.0",
                ["an exitance of 0", "positive"],
            ),
            (
                "exitance = 100.0",
                "exitance = inf",
                ["an exitance of inf", "positive"],
            ),
            (
                "exitance = 100.0",
                "exitance = 1e80",
                ["shines with", "1e60"],
            ),
            (
                "falloff = [1.0, 2.0]",
                "falloff = [1.0, -2.0]",
                ["to the power of -2", "from 0"],
            ),
            (
                "falloff = [1.0, 2.0]",
                "falloff = [1e9, 2.0]",
                ["to the power of 1000000000", "to 1000"],
            ),
            (
                "exitance = 100.0",
                "wavelength = 0.0",
                ["wavelength 0 m", "in metres"],
            ),
            (&picture, "shining = 1.5", ["1.5", "[0, 1]"]),
            (
                &picture,
                &elements,
                ["each element shines alone", "shining = 1.0"],
            ),
            (
                &picture,
                "lambertian = 0.5",
                ["does not belong to `lambertian`", "remove"],
            ),
            (
                plate,
                "material = { mixture = [{ weight = 1.0, material = { shining = 1.0 } }] }",
                ["a part of a mixture that shines", "whole surface"],
            ),
        ];
        for (old, new, words) in cases {
            let error = with(old, new).expect_err(new).to_string();
            assert!(words.iter().all(|w| error.contains(w)), "{new}: {error}");
        }
        let dark = text().replace(
            "[surface.material]",
            "material = { lambertian = 0.5 }\n[rest]",
        );
        let error = Scene::from_toml("own", &dark[..dark.find("[rest]").unwrap()]).unwrap_err();
        assert!(error.to_string().contains("nothing gives light"), "{error}");
    }

    /// The columns are the picture, or each element alone; both stay on the surface when it moves.
    #[test]
    fn columns_lie_on_the_surface() {
        let whole = Scene::load("screen").unwrap();
        assert_eq!((whole.laser.spots.len(), whole.laser.beams().len()), (1, 0));
        // 100 W/m² on 0.4 × 0.4 m.
        assert!((whole.laser.power - 16.0).abs() < 1e-12);
        let each = with(&picture(), "light = \"elements\"\nshining = 1.0").unwrap();
        assert_eq!(each.laser.spots.len(), 64);
        assert!((each.laser.power - 0.25).abs() < 1e-12);
        let [corner, width] = each.laser.part(10).unwrap();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(near(corner[0], 0.25) && near(corner[1], 0.125) && width == [0.125; 2]);
        for (j, share) in [(9, 0.0), (10, 1.0), (18, 0.0)] {
            assert_eq!(each.laser.share(10, (j, [8, 8])), share);
        }
        // A fourth of a larger element, and all of four smaller ones.
        assert_eq!(each.laser.share(10, (1, [4, 4])), 0.25);
        assert_eq!(each.laser.share(10, (2 + 4 + 16 * 2 + 2, [16, 16])), 0.0);
        assert_eq!(each.laser.share(10, (4 + 16 * 2, [16, 16])), 1.0);
        let by = crate::geometry::DVec3::new(0.1, 0.0, 0.05);
        let moved = each
            .with_moved_hidden(&glam::DAffine3::from_translation(by))
            .unwrap();
        let shift = moved.laser.spots[10].target.position - each.laser.spots[10].target.position;
        assert!((shift - by).length() < 1e-15);
        assert!(each.with_spots_at(&[[0.3, 0.3]]).is_err());
    }

    #[test]
    fn an_unknown_picture_is_known_to_be_so() {
        let unknown = with(&picture(), "shining = \"unknown\"").unwrap();
        assert_eq!(unknown.unknown().as_deref(), Some("`monitor`"));
        let error = unknown.known().unwrap_err().to_string();
        assert!(
            error.contains("screen:32:") && error.contains("`monitor`"),
            "{error}"
        );
    }
}
