//! Scenes that differ from a given one in a single respect, for studies. Their hash and text remain
//! the original's, but for [`Scene::with_listed_spots`].

mod camera;

use glam::DAffine3;

use super::error::{Fault, keys};
use super::file::{Layout, RectangleTable, SceneFile, SpotsTable};
use super::hash::content_hash;
use super::laser;
use super::parse;
use super::surface::{self, Surface};
use super::{Cells, Division, Material, Role, Scene, SceneError, Texture};
use crate::geometry::{Facing, Parallelogram, Shape, Sphere};

impl Scene {
    /// The same scene with every spot moved by (dx, dy) on the wall.
    ///
    /// # Errors
    /// [`SceneError`] if a spot leaves the wall, or there is no laser.
    pub fn with_shifted_spots(&self, [dx, dy]: [f64; 2]) -> Result<Self, SceneError> {
        let shift = |s: &laser::Spot| [s.target.position.x + dx, s.target.position.y + dy];
        self.with_spots_at(&self.laser.spots.iter().map(shift).collect::<Vec<_>>())
    }

    /// The same scene with spots at the given (x, y).
    ///
    /// # Errors
    /// [`SceneError`] if a spot is not on the wall, or there is no laser.
    pub fn with_spots_at(&self, places: &[[f64; 2]]) -> Result<Self, SceneError> {
        if self.laser.is_shining() {
            let cause = "the scene has no laser: its hidden surface shines";
            let cure = "use a scene with a [laser] table where spots are to be placed";
            return Err(self.locate(Fault::new(keys!["surface"], cause, cure)));
        }
        let mut scene = self.clone();
        scene.laser.spots = laser::place(places, self.laser.position, &self.surfaces)
            .map_err(|fault| self.locate(fault))?;
        Ok(scene)
    }

    /// The same scene with its spots listed at the given (x, y), in its text and its hash too,
    /// where rectangles are also as large as they are; known answers, which name spots, are gone.
    ///
    /// # Errors
    /// [`SceneError`] if a spot is not on the wall.
    pub fn with_listed_spots(&self, places: &[[f64; 2]]) -> Result<Self, SceneError> {
        let (mut file, _): (SceneFile, _) = parse::parse(&self.name, &self.text)?;
        if let Some(laser) = &mut file.laser {
            laser.spots = SpotsTable {
                layout: Layout::List,
                points: Some(places.to_vec()),
                ..SpotsTable::default()
            };
        }
        file.known.clear();
        let back = self.to_file();
        for table in &mut file.surface {
            let own = self.surfaces.iter().find(|s| s.name == table.name);
            if let (Some(Shape::Parallelogram(p)), Some(rectangle)) =
                (own.map(|s| &s.shape), &mut table.rectangle)
            {
                let [u, v] = [p.u(), p.v()].map(|x| back.transform_vector3(x).to_array());
                let corner = back.transform_point3(p.corner()).to_array();
                *rectangle = RectangleTable { corner, u, v };
            }
        }
        let scene = self.with_spots_at(places)?;
        Ok(Self {
            text: file.toml()?,
            hash: content_hash(&file, &self.files).map_err(|fault| self.locate(fault))?,
            known: Vec::new(),
            ..scene
        })
    }

    /// The same scene with paths of up to `surfaces` surfaces.
    pub fn with_max_bounces(&self, surfaces: u32) -> Self {
        Self {
            max_bounces: surfaces,
            ..self.clone()
        }
    }

    /// The same scene with occluders that only block: their albedo is 0.
    pub fn with_black_occluders(&self) -> Self {
        self.with_each(Role::Occluder, |surface| {
            surface.material = Material::Lambertian;
            *surface = surface.painted(Texture::Constant(0.0));
        })
    }

    /// The same scene with these shapes in it, black on both sides.
    ///
    /// # Errors
    /// [`SceneError`] where one has no proper shape.
    pub fn with_black(&self, shapes: &[Option<Shape>]) -> Result<Self, SceneError> {
        let mut scene = self.clone();
        for (k, shape) in shapes.iter().enumerate() {
            scene.surfaces.push(Surface {
                name: format!("occluder {}", k + 1),
                role: Role::Occluder,
                shape: shape.clone().ok_or_else(|| self.locate(no_shape()))?,
                material: Material::Lambertian,
                albedo: Texture::Constant(0.0),
                is_known: true,
                elements: [0; 2],
                division: Division::Cells,
            });
        }
        scene.rebuilt()
    }

    /// The same scene with each side of each occluder a hidden surface of one element: what the
    /// matrix model needs to estimate the light that they reflect.
    ///
    /// # Errors
    /// [`SceneError`] where nothing is an occluder, or the hidden surface shines: what occluders
    /// reflect of its picture is no term of the model.
    pub fn with_occluders_as_elements(&self) -> Result<Self, SceneError> {
        if self.laser.is_shining() {
            let cause = "the hidden surface shines, and the model has no light of occluders then";
            let cure = "trace it: render with `light = \"elements\"`, and give its phi.npy as --camera-side";
            return Err(self.locate(Fault::new(keys!["surface"], cause, cure)));
        }
        if !self.surfaces.iter().any(|s| s.role == Role::Occluder) {
            let cause = "no surface has the role `occluder`, whose light could be estimated";
            let cure = "leave --occluder-light out, or say in the scene what stands there";
            return Err(self.locate(Fault::new(keys!["surface"], cause, cure)));
        }
        Ok(self.with_each(Role::Occluder, |surface| {
            surface.role = Role::Hidden;
            surface.elements = [1, 1];
            surface.division = Division::Whole;
        }))
    }

    /// The same scene with each hidden surface's albedo replaced by its mean over the area.
    pub fn with_mean_albedo(&self) -> Self {
        self.with_each(Role::Hidden, |s| {
            *s = s.painted(Texture::Constant(s.mean_albedo()));
        })
    }

    /// The same scene with each hidden surface a checkerboard of `checks` × `checks` checks of
    /// albedo 0 and 1, the one at its corner dark.
    pub fn with_checkerboard(&self, checks: usize) -> Self {
        let check = |i: usize| f64::from(u8::from((i % checks + i / checks) % 2 == 1));
        self.with_cells(&Cells {
            count: [checks; 2],
            albedo: (0..checks * checks).map(check).collect(),
        })
    }

    /// The same scene with each hidden surface painted like this.
    pub fn with_cells(&self, cells: &Cells) -> Self {
        self.with_each(Role::Hidden, |surface| {
            *surface = surface.painted(Texture::Cells(cells.clone()));
            surface.is_known = true;
        })
    }

    /// The scene, if every albedo is known.
    ///
    /// # Errors
    /// [`SceneError`], at the first hidden surface whose albedo is `"unknown"`.
    pub fn known(self) -> Result<Self, SceneError> {
        match self.surfaces.iter().position(|s| !s.is_known) {
            None => Ok(self),
            Some(i) => {
                let name = &self.surfaces[i].name;
                let cause = format!("the albedo of `{name}` is unknown, so its light is too");
                let key = match self.surfaces[i].shining() {
                    Some(_) => "shining",
                    None => "lambertian",
                };
                let cure = format!(
                    "give it a number or a picture: -D surface.{name}.material.{key}=0.5, of photographs in a scene for `validate \
                     --against`; `model` and `recover` do without"
                );
                let at = keys!["surface", i, "material", key];
                Err(self.locate(Fault::new(at, cause, cure)))
            }
        }
    }

    /// The same scene with each flat relay surface reaching further by `margin` on all four sides.
    /// An albedo that varies over it becomes its mean, for the cells would be elsewhere.
    ///
    /// # Errors
    /// [`SceneError`] if that leaves no proper shape.
    pub fn with_extended_relay(&self, margin: f64) -> Result<Self, SceneError> {
        self.with_flat_relays(|p| {
            let [du, dv] = [p.u(), p.v()].map(|edge| edge.normalize_or_zero() * margin);
            let wide = Parallelogram::new(p.corner() - du - dv, p.u() + du * 2.0, p.v() + dv * 2.0);
            let turned = p.u().cross(p.v()).dot(p.normal()) < 0.0;
            wide.map(|wide| if turned { wide.turned() } else { wide })
                .map(Shape::Parallelogram)
        })
    }

    /// The same scene with the hidden surfaces moved by a rigid motion.
    ///
    /// # Errors
    /// [`SceneError`] if that leaves no proper shape.
    pub fn with_moved_hidden(&self, motion: &DAffine3) -> Result<Self, SceneError> {
        let mut scene = self.clone();
        for surface in scene.surfaces.iter_mut().filter(|s| s.role == Role::Hidden) {
            let moved = surface.shape.moved(motion);
            surface.shape = moved.ok_or_else(|| self.locate(no_shape()))?;
        }
        scene.rebuilt()
    }

    /// The same scene with the albedo of surface `index` (in file order) multiplied by `factor`,
    /// beyond 1 where it comes to that.
    pub fn with_scaled_albedo(&self, index: usize, factor: f64) -> Self {
        let mut scene = self.clone();
        if let Some(surface) = scene.surfaces.get_mut(index) {
            surface.albedo = surface.albedo.map(|rho| rho * factor);
        }
        scene
    }

    /// The same scene with each flat relay bent to a sphere that touches it at its centre and
    /// stands off by `sagitta` (towards the front) at half its longer edge: R = D²/(8·sagitta).
    /// Spots stay at their (x, y).
    ///
    /// # Errors
    /// [`SceneError`] if a spot is not on the bent wall.
    pub fn with_bent_relay(&self, sagitta: f64) -> Result<Self, SceneError> {
        let bent = self.with_flat_relays(|p| {
            let edge = p.u().length().max(p.v().length());
            let radius = edge * edge / (8.0 * sagitta);
            let centre = p.at([0.5, 0.5]).position + p.normal() * radius;
            Sphere::new(centre, radius, Facing::Inside).map(Shape::Sphere)
        })?;
        if bent.laser.is_shining() {
            return Ok(bent);
        }
        bent.with_shifted_spots([0.0, 0.0])
    }

    /// The same scene with each surface of a role changed in what is not its shape.
    pub(super) fn with_each(&self, role: Role, change: impl FnMut(&mut Surface)) -> Self {
        let mut scene = self.clone();
        let all = scene.surfaces.iter_mut();
        all.filter(|s| s.role == role).for_each(change);
        scene
    }

    /// The same scene with each flat relay surface in another shape. The parameters of that are
    /// others, so that an albedo that varies becomes its mean.
    fn with_flat_relays(
        &self,
        reshaped: impl Fn(&Parallelogram) -> Option<Shape>,
    ) -> Result<Self, SceneError> {
        let mut scene = self.clone();
        for surface in &mut scene.surfaces {
            if let (Role::Relay, Shape::Parallelogram(p)) = (surface.role, &surface.shape) {
                surface.shape = reshaped(p).ok_or_else(|| self.locate(no_shape()))?;
                surface.albedo = Texture::Constant(surface.mean_albedo());
            }
        }
        scene.rebuilt()
    }

    fn rebuilt(mut self) -> Result<Self, SceneError> {
        self.bvh = surface::bvh(&self.surfaces).map_err(|fault| self.locate(fault))?;
        self.laser.follow(&self.surfaces);
        Ok(self)
    }

    fn locate(&self, fault: Fault) -> SceneError {
        parse::locate(&self.name, &self.text, fault)
    }
}

fn no_shape() -> Fault {
    Fault::new(
        keys!["surface"],
        "the surface has no proper shape there",
        "move it by less",
    )
}

#[cfg(test)]
mod tests;
