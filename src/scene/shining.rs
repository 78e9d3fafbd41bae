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
mod tests;
