//! The matrices of the model, elements and pixels by their centres.

use std::f64::consts::FRAC_1_PI;

use super::kernel::{HiddenPoint, Kernel};
use super::wall_point::{self, WallPoint};
use crate::geometry::{DVec3, Ray, ShapeId};
use crate::matrix::Matrix;
use crate::scene::{Division, Scene};

/// Why a scene has no matrix model.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ModelError {
    /// Nothing is hidden.
    #[error(
        "the scene has no hidden surface, so there is no matrix model (give one surface role = \"hidden\")"
    )]
    NothingHidden,
    /// The matrices would be absurdly large.
    #[error(
        "{elements} elements make matrices of {entries:e} entries (use fewer elements, pixels or spots)"
    )]
    TooLarge {
        /// Elements asked for.
        elements: usize,
        /// Entries of all matrices.
        entries: f64,
    },
}

/// How one hidden surface is divided.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementGrid {
    /// Name of the surface.
    pub surface: String,
    /// Elements along u and v.
    pub count: [usize; 2],
    /// Index of its first element; element iu + iv·nu follows by that much.
    pub first: usize,
}

impl ElementGrid {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Whether it has none (it never has).
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The matrix model of a scene.
#[derive(Clone, Debug)]
pub struct MatrixModel {
    /// Kernel of both matrices.
    pub kernel: Kernel,
    /// Hidden surfaces in file order.
    pub grids: Vec<ElementGrid>,
    /// Elements × spots, length⁻².
    pub g12: Matrix,
    /// Pixels × elements, length⁻².
    pub g23: Matrix,
    /// Mean albedo of each element; of a surface that is not Lambertian that of the Lambertian one
    /// that reflects as much
    /// ([`Surface::lambertian_equivalent`](crate::scene::Surface::lambertian_equivalent)).
    pub albedo: Vec<f64>,
    /// C, pixels × elements: E_p·(ρ3/π)·G23/π.
    pub camera_side: Matrix,
    /// D, elements × spots, W: Φlaser·(ρ1/π)·A_j·G12, so that Φcam\[p,l\] = Σ_j
    /// C\[p,j\]·ρ2_j·D\[j,l\].
    pub laser_side: Matrix,
}

/// Entries that all matrices of a model together may have: 8 GB.
const MOST_ENTRIES: f64 = 1e9;

impl MatrixModel {
    /// The model of `scene`; `elements` replaces the elements a side that the scene gives.
    ///
    /// # Errors
    /// [`ModelError`] if nothing is hidden or the matrices would have more than 1e9 entries in all.
    pub fn new(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
    ) -> Result<Self, ModelError> {
        let photographs = scene.camera.pixels() as f64 * scene.laser.spots.len() as f64;
        Self::beside(scene, kernel, elements, photographs)
    }

    /// The same for photographs that are never held at once, and so do not count.
    ///
    /// # Errors
    /// Those of [`MatrixModel::new`].
    pub fn without_photographs(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
    ) -> Result<Self, ModelError> {
        Self::beside(scene, kernel, elements, 0.0)
    }

    fn beside(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
        photographs: f64,
    ) -> Result<Self, ModelError> {
        let mut grids: Vec<ElementGrid> = Vec::new();
        let mut count = 0;
        for (_, surface) in scene.hidden() {
            let grid = ElementGrid {
                surface: surface.name.clone(),
                count: match surface.division {
                    Division::Cells => elements.unwrap_or(surface.elements),
                    Division::Faces => surface.elements,
                },
                first: count,
            };
            count += grid.len();
            grids.push(grid);
        }
        if count == 0 {
            return Err(ModelError::NothingHidden);
        }
        let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
        let entries = 2.0 * count as f64 * (pixels + spots) as f64 + photographs;
        if entries > MOST_ENTRIES {
            return Err(ModelError::TooLarge {
                elements: count,
                entries,
            });
        }
        let mut points = Vec::with_capacity(count);
        let mut areas = Vec::with_capacity(count);
        let mut albedo = Vec::with_capacity(count);
        for ((_, surface), grid) in scene.hidden().zip(&grids) {
            for element in surface.divided(grid.count) {
                points.push(HiddenPoint::from(&element));
                areas.push(element.area);
                albedo.push(element.albedo);
            }
        }
        let seen: Vec<WallPoint> = (0..pixels)
            .map(|p| wall_point::seen(scene, p, [0.5, 0.5], 1.0))
            .collect();
        let lit: Vec<WallPoint> = (0..spots)
            .map(|l| wall_point::lit(scene, l, DVec3::ZERO, 1.0))
            .collect();
        let g = |wall: &WallPoint, j: usize| kernel.between(wall.position, wall.normal, &points[j]);
        let g23 = Matrix::from_fn(pixels, count, |p, j| g(&seen[p], j));
        let g12 = Matrix::from_fn(count, spots, |j, l| g(&lit[l], j));
        let camera_side = Matrix::from_fn(pixels, count, |p, j| {
            seen[p].reflected(scene, points[j].position) * g23[(p, j)] * FRAC_1_PI
        });
        let laser_side = Matrix::from_fn(count, spots, |j, l| {
            lit[l].reflected(scene, points[j].position) * areas[j] * g12[(j, l)]
        });
        Ok(Self {
            kernel,
            grids,
            g12,
            g23,
            albedo,
            camera_side,
            laser_side,
        })
    }

    /// The same model with occlusion: every entry of G12, G23, C and D between whose wall point and
    /// element (by their middles) something stands is 0, and so are the rows of pixels and the
    /// columns of spots whose wall point camera or laser cannot see. The published model has none;
    /// where a scene's obstacles are known, this is what takes them in.
    pub fn with_occlusion(mut self, scene: &Scene) -> Self {
        let hidden = scene.hidden().zip(&self.grids);
        let elements: Vec<(ShapeId, DVec3)> = hidden
            .flat_map(|((id, surface), grid)| {
                let elements = surface.divided(grid.count);
                elements
                    .into_iter()
                    .map(move |e| (id as ShapeId, e.position))
            })
            .collect();
        let blocked = |wall: &WallPoint, (id, element): (ShapeId, DVec3)| {
            Ray::between(wall.position, element)
                .is_none_or(|ray| scene.bvh().blocked(&ray, [wall.surface, Some(id)]))
        };
        // The elements to which a wall point that `device` looks at or lights has no free way.
        let hidden = |device: DVec3, wall: &WallPoint, g: &[f64]| -> Vec<usize> {
            let dark = Ray::between(device, wall.position)
                .is_none_or(|ray| scene.bvh().blocked(&ray, [None, wall.surface]));
            let is_hidden = |j: &usize| dark || g[*j] != 0.0 && blocked(wall, elements[*j]);
            (0..elements.len()).filter(is_hidden).collect()
        };
        for p in 0..self.g23.nrows() {
            let wall = wall_point::seen(scene, p, [0.5, 0.5], 1.0);
            let g: Vec<f64> = self.g23.row(p).iter().copied().collect();
            for j in hidden(scene.camera.position, &wall, &g) {
                self.g23[(p, j)] = 0.0;
                self.camera_side[(p, j)] = 0.0;
            }
        }
        for l in 0..self.g12.ncols() {
            let wall = wall_point::lit(scene, l, DVec3::ZERO, 1.0);
            for j in hidden(scene.laser.position, &wall, self.g12.column(l).as_slice()) {
                self.g12[(j, l)] = 0.0;
                self.laser_side[(j, l)] = 0.0;
            }
        }
        self
    }

    /// Φcam, pixels × spots, W.
    pub fn phi(&self) -> Matrix {
        let mut lit = self.laser_side.clone();
        for (mut row, rho) in lit.row_iter_mut().zip(&self.albedo) {
            row *= *rho;
        }
        &self.camera_side * lit
    }
}
