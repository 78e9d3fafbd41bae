//! Surfaces.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::error::{Fault, keys};
use super::material::{FallOff, Material, Shining};
use super::pieces;
use super::texture::{Texture, Wrap};
use crate::geometry::{Basis, Bvh, DVec3, Interaction, Shape, ShapeId};

/// What a surface is there for.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The wall: takes the laser spots (S1) and is what the camera sees (S3).
    Relay,
    /// The object around the corner (S2), to be recovered.
    Hidden,
    /// Anything else that reflects or blocks light.
    Occluder,
}

/// A surface: its front reflects, its back is black, both are opaque.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name, unique in the scene.
    pub name: String,
    /// What it is there for.
    pub role: Role,
    /// Its geometry.
    pub shape: Shape,
    /// How its front reflects.
    pub material: Material,
    /// Its albedo, or what the material makes of that number.
    pub albedo: Texture,
    /// Whether that is known; else a grey stands in its place, of which nothing may be told.
    pub is_known: bool,
    /// Elements along u and v into which the matrix model divides it (of triangles: all of them,
    /// and 1; of the whole 1 and 1); \[0, 0\] unless hidden.
    pub elements: [usize; 2],
    /// What the elements are.
    pub division: Division,
}

/// What a hidden surface is divided into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Division {
    /// Cells of its parameters; of a mesh: of its texture coordinates.
    Cells,
    /// The triangles of a mesh.
    Faces,
    /// All of it, whatever its shape.
    Whole,
}

impl Surface {
    /// f_r, sr⁻¹, at a point of the surface where its texture has the value `albedo` and its front
    /// the normal `normal`, between two unit vectors that point away from it; 0 unless both are on
    /// the front.
    pub fn brdf(&self, albedo: f64, normal: DVec3, wi: DVec3, wo: DVec3) -> f64 {
        let basis = Basis::around(normal);
        self.material
            .brdf(albedo, basis.to_local(wi), basis.to_local(wo))
    }

    /// Whether every point of it reflects by ρ/π, whatever the directions.
    pub fn is_lambertian(&self) -> bool {
        self.material.is_lambertian()
    }

    /// How it shines, if it does.
    pub fn shining(&self) -> Option<&Shining> {
        match &self.material {
            Material::Shining(shining) => Some(shining),
            _ => None,
        }
    }

    /// By how much its light falls off with direction; `None` if it does not shine, or evenly.
    pub fn fall_off(&self) -> Option<FallOff> {
        let shining = self.shining().filter(|s| !s.is_lambertian())?;
        let Shape::Parallelogram(plane) = &self.shape else {
            return None;
        };
        Some(FallOff {
            axes: [plane.u(), plane.v()].map(DVec3::normalize_or_zero),
            exponents: shining.falloff,
        })
    }

    /// The Lambertian surface in its place that reflects as much of light that comes evenly from
    /// everywhere: its albedo is the material's white-sky albedo at each value of the texture
    /// (between the texels of a bilinear picture, and along a ramp, interpolated). What the matrix
    /// model takes for the hidden surface. One that shines is its own.
    pub fn lambertian_equivalent(&self) -> Cow<'_, Self> {
        if self.is_lambertian() || self.shining().is_some() {
            return Cow::Borrowed(self);
        }
        // A quadrature each, so every value once.
        let mut known: BTreeMap<u64, f64> = BTreeMap::new();
        let reflectance = |rho: f64| {
            let found = known.entry(rho.to_bits());
            *found.or_insert_with(|| self.material.white_sky_albedo(rho))
        };
        Cow::Owned(Self {
            material: Material::Lambertian,
            albedo: self.albedo.map(reflectance),
            ..self.clone()
        })
    }

    /// Whether none of it reflects anything.
    pub fn is_black(&self) -> bool {
        self.material.is_black(self.albedo.largest())
    }

    /// Cells along u and v within which the albedo is smooth: those of the texture; of a mesh that
    /// is no patch those that its facets lie in, one after the other along u, or one where it is
    /// not cut.
    pub fn smooth_cells(&self) -> [usize; 2] {
        match &self.shape {
            Shape::Instance(body) if !body.is_patch() => {
                [body.facets().map_or(1, |f| f.cells().len()), 1]
            }
            _ => self.albedo.smooth_cells(),
        }
    }

    /// Where the albedo of a flat rectangle or parallelogram jumps or bends, lines from end to end;
    /// none of other shapes, whose texture bends there too.
    pub fn seams(&self) -> Option<Vec<[DVec3; 2]>> {
        match (&self.shape, self.albedo.smooth_cells()) {
            (_, [1, 1]) => Some(Vec::new()),
            (Shape::Parallelogram(p), count) => Some(p.lines(count).collect()),
            _ => None,
        }
    }

    /// The same surface, its mesh cut into facets along the edges of its texture, if it has any.
    pub(super) fn in_facets(mut self) -> Self {
        if let Shape::Instance(body) = self.shape {
            let facets = pieces::facets(&body, &self.albedo);
            self.shape = Shape::Instance(body.in_facets(facets));
        }
        self
    }

    /// The same surface with another albedo. A mesh takes cells in the way in which it takes its
    /// own albedo outside \[0, 1\].
    pub(super) fn painted(&self, albedo: Texture) -> Self {
        let albedo = match (albedo, &self.shape, self.albedo.wrap()) {
            (Texture::Cells(cells), Shape::Instance(_), Wrap::Repeat) => Texture::Tiles(cells),
            (albedo, ..) => albedo,
        };
        let own = Self {
            albedo,
            ..self.clone()
        };
        own.in_facets()
    }

    /// Whether no element has to do with two cells of its texture.
    pub(super) fn is_aligned(&self) -> bool {
        if matches!(self.albedo, Texture::Constant(_)) {
            return true;
        }
        if let (Shape::Instance(body), Division::Faces) = (&self.shape, self.division) {
            return pieces::are_whole(body, &self.albedo);
        }
        let ([cu, cv], [nu, nv]) = (self.albedo.smooth_cells(), self.elements);
        nu % cu == 0 && nv % cv == 0
    }

    /// The mean albedo over its area.
    pub(super) fn mean_albedo(&self) -> f64 {
        match &self.shape {
            Shape::Instance(body) => pieces::mean_albedo(body, &self.albedo),
            _ => {
                let cells: usize = self.albedo.smooth_cells().iter().product();
                let sum: f64 = (0..cells).map(|c| self.albedo.cell_mean(c)).sum();
                sum / cells as f64
            }
        }
    }

    /// About how much of the light cell iu + iv·nu of [`Surface::smooth_cells`] reflects, or how
    /// brightly it shines: 0 where, and only where, it is black.
    pub fn cell_weight(&self, cell: usize) -> f64 {
        /// What is sampled of a surface that reflects though its texture is black there.
        const LEAST: f64 = 0.05;
        let mean = match &self.shape {
            Shape::Instance(body) if !body.is_patch() => match body.facets() {
                Some(facets) => self.albedo.cell_mean(facets.cells()[cell] as usize),
                None => self.albedo.largest(),
            },
            _ => self.albedo.cell_mean(cell),
        };
        if self.is_lambertian() || self.shining().is_some() {
            return mean;
        }
        if self.material.is_black(mean) {
            0.0
        } else {
            mean.max(LEAST)
        }
    }
}

/// The surfaces of a role with their shape ids.
pub(super) fn of_role(role: Role, surfaces: &[Surface]) -> impl Iterator<Item = (usize, &Surface)> {
    let all = surfaces.iter().enumerate();
    all.filter(move |(_, s)| s.role == role)
}

/// Whether no relay surface lies straight above or below (x, y).
pub(super) fn is_off_the_wall(surfaces: &[Surface], [x, y]: [f64; 2]) -> bool {
    of_role(Role::Relay, surfaces).all(|(_, s)| s.shape.at_xy(x, y).is_empty())
}

/// The point of a relay surface above or below (x, y) that shows its front to `device`, and the
/// surface's shape id: of several surfaces the nearest, of a sphere's two points the lower one.
pub(super) fn facing_at_xy(
    surfaces: &[Surface],
    [x, y]: [f64; 2],
    device: DVec3,
) -> Option<(ShapeId, Interaction)> {
    let faces = |p: &Interaction| (device - p.position).dot(p.normal) > 0.0;
    let facing = of_role(Role::Relay, surfaces).filter_map(|(id, s)| {
        let point = s.shape.at_xy(x, y).into_iter().find(faces)?;
        Some((id as ShapeId, point))
    });
    let distance = |p: &Interaction| (p.position - device).length_squared();
    facing.min_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)))
}

/// The shapes of all surfaces, ready for ray queries.
pub(super) fn bvh(surfaces: &[Surface]) -> Result<Bvh, Fault> {
    let shapes = surfaces.iter().map(|s| s.shape.clone()).collect();
    Bvh::new(shapes)
        .map_err(|e| Fault::new(keys!["surface"], e.to_string(), "check the coordinates"))
}
