//! The matrices of the model, elements and pixels by their centres.

use std::f64::consts::FRAC_1_PI;

use super::effort::Effort;
use super::error::ModelError;
use super::extent::Occlusion;
use super::factors::{ElementGrid, Factors, Shares, settled};
use super::kernel::{HiddenPoint, Kernel};
use super::obstacles::obstacles;
use super::wall_point::{self, WallPoint};
use crate::geometry::{DVec3, ShapeId};
use crate::matrix::Matrix;
use crate::num::linalg::rows_times;
use crate::scene::{Division, Scene};

/// The matrix model of a scene.
#[derive(Clone, Debug)]
pub struct MatrixModel {
    /// Kernel of both matrices.
    pub kernel: Kernel,
    /// Hidden surfaces in file order.
    pub grids: Vec<ElementGrid>,
    /// Elements × spots, length⁻². Where a surface shines the share of each element that shines in
    /// each column, a number.
    pub g12: Matrix,
    /// Pixels × elements, length⁻².
    pub g23: Matrix,
    /// Mean albedo of each element; of a surface that is not Lambertian that of the Lambertian one
    /// that reflects as much
    /// ([`Surface::lambertian_equivalent`](crate::scene::Surface::lambertian_equivalent)). Where it
    /// is unknown ([`ElementGrid::is_known`]) a grey that means nothing.
    pub albedo: Vec<f64>,
    /// Centre of each element, in the scene's unit of length; empty where it is not known.
    pub places: Vec<[f64; 3]>,
    /// C, pixels × elements: E_p·(ρ3/π)·G23/π.
    pub camera_side: Matrix,
    /// D, elements × spots, W: Φlaser·(ρ1/π)·A_j·G12, so that Φcam\[p,l\] = Σ_j
    /// C\[p,j\]·ρ2_j·D\[j,l\]. Where a surface shines M·A_j times that share, and ρ2 its picture.
    pub laser_side: Matrix,
    /// The terms of each element, where something stands in the way: C and D then hold the visible
    /// share of each entry, and their product is an approximation ([`MatrixModel::product_error`]).
    pub factors: Option<Factors>,
    /// Occluders that send on light which the model does not have
    /// ([`Scene::sent_on`]).
    pub sent_on: Option<String>,
}

/// Entries that all matrices of a model together may have: 8 GB.
const MOST_ENTRIES: f64 = 1e9;

/// Whether anything may stand in the way of the model's light.
pub fn is_obstructed(scene: &Scene) -> bool {
    !obstacles(scene).is_empty()
}

/// What may stand in the way and is considered.
fn considered(scene: &Scene, occlusion: Occlusion) -> Vec<ShapeId> {
    match occlusion {
        Occlusion::Considered => obstacles(scene),
        Occlusion::Ignored => Vec::new(),
    }
}

/// How the hidden surfaces of `scene` are divided; `elements` replaces the elements a side that it
/// gives.
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn element_grids(
    scene: &Scene,
    elements: Option<[usize; 2]>,
) -> Result<Vec<ElementGrid>, ModelError> {
    let mut grids: Vec<ElementGrid> = Vec::new();
    let mut count = 0;
    for (_, surface) in scene.hidden() {
        let grid = ElementGrid {
            surface: surface.name.clone(),
            count: match surface.division {
                Division::Cells => elements.unwrap_or(surface.elements),
                Division::Faces | Division::Whole => surface.elements,
            },
            first: count,
            is_known: surface.is_known,
        };
        count += grid.len();
        grids.push(grid);
    }
    if count == 0 {
        return Err(ModelError::NothingHidden);
    }
    Ok(grids)
}

impl MatrixModel {
    /// The model of `scene`, past what stands in the way; `elements` replaces the elements a side
    /// that the scene gives.
    ///
    /// # Errors
    /// [`ModelError`] if nothing is hidden or the matrices would have more than 1e9 entries in all.
    pub fn new(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
    ) -> Result<Self, ModelError> {
        Self::with(scene, kernel, elements, Occlusion::Considered)
    }

    /// A model of matrices that were measured or computed elsewhere, without a scene: C pixels ×
    /// elements, D elements × spots, `count` elements along u and v of one surface of unknown
    /// reflectance. Its G12 and G23 are empty: nothing is known of the light and the walls within C
    /// and D.
    ///
    /// # Errors
    /// [`ModelError::Sides`] where they do not belong together.
    pub fn of_sides(
        camera_side: Matrix,
        laser_side: Matrix,
        count: [usize; 2],
    ) -> Result<Self, ModelError> {
        let elements = camera_side.ncols();
        if laser_side.nrows() != elements || count[0].saturating_mul(count[1]) != elements {
            return Err(ModelError::Sides {
                columns: elements,
                rows: laser_side.nrows(),
                count,
            });
        }
        let grid = ElementGrid {
            surface: "surface".to_owned(),
            count,
            first: 0,
            is_known: false,
        };
        Ok(Self {
            kernel: Kernel::Physical,
            grids: vec![grid],
            g12: Matrix::zeros(0, 0),
            g23: Matrix::zeros(0, 0),
            albedo: vec![0.5; elements],
            places: Vec::new(),
            camera_side,
            laser_side,
            factors: None,
            sent_on: None,
        })
    }

    /// The same with or without what stands in the way.
    ///
    /// # Errors
    /// Those of [`MatrixModel::new`].
    pub fn with(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
        occlusion: Occlusion,
    ) -> Result<Self, ModelError> {
        let photographs = scene.camera.pixels() as f64 * scene.laser.spots.len() as f64;
        Self::beside(scene, kernel, elements, photographs)?.past(scene, occlusion)
    }

    /// The same for photographs that are never held at once, and so do not count.
    ///
    /// # Errors
    /// Those of [`MatrixModel::new`].
    pub fn without_photographs(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
        occlusion: Occlusion,
    ) -> Result<Self, ModelError> {
        Self::beside(scene, kernel, elements, 0.0)?.past(scene, occlusion)
    }

    /// The same with the light of each element integrated over its area, over footprints and spots,
    /// also where nothing stands in the way, with this effort; [`Factors::steps`] says how far it
    /// may be off. C and D stay those of the centres, times the visible share.
    ///
    /// # Errors
    /// Those of [`MatrixModel::new`], and [`ModelError::Linalg`].
    pub fn over_areas(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
        occlusion: Occlusion,
        effort: Effort,
    ) -> Result<Self, ModelError> {
        let photographs = scene.camera.pixels() as f64 * scene.laser.spots.len() as f64;
        let model = Self::beside(scene, kernel, elements, photographs)?;
        let obstacles = considered(scene, occlusion);
        let settled = settled(scene, kernel, &obstacles, &model.grids, effort, false)?;
        let (mut factors, shares) = settled.joined();
        factors.steps = settled.steps();
        Ok(model.with_factors((factors, shares)))
    }

    fn beside(
        scene: &Scene,
        kernel: Kernel,
        elements: Option<[usize; 2]>,
        photographs: f64,
    ) -> Result<Self, ModelError> {
        let grids = element_grids(scene, elements)?;
        let count = grids.iter().map(ElementGrid::len).sum();
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
                points.push(HiddenPoint::new(surface, &element));
                areas.push(element.area);
                albedo.push(element.albedo);
            }
        }
        let seen: Vec<WallPoint> = (0..pixels)
            .map(|p| wall_point::seen(scene, p, [0.5, 0.5], 1.0))
            .collect();
        let g = |wall: &WallPoint, j: usize| kernel.between(wall.position, wall.normal, &points[j]);
        let g23 = Matrix::from_fn(pixels, count, |p, j| g(&seen[p], j));
        let camera_side = Matrix::from_fn(pixels, count, |p, j| {
            seen[p].reflected(scene, points[j].position) * g23[(p, j)] * FRAC_1_PI
        });
        let (g12, laser_side) = match (scene.shining(), &grids[..]) {
            (Some((_, surface)), [grid]) => {
                let exitance = surface.shining().map_or(0.0, |s| s.exitance);
                let g12 =
                    Matrix::from_fn(count, spots, |j, l| scene.laser.share(l, (j, grid.count)));
                let laser_side =
                    Matrix::from_fn(count, spots, |j, l| exitance * areas[j] * g12[(j, l)]);
                (g12, laser_side)
            }
            _ => {
                let lit: Vec<WallPoint> = (0..spots)
                    .map(|l| wall_point::lit(scene, l, DVec3::ZERO, 1.0))
                    .collect();
                let g12 = Matrix::from_fn(count, spots, |j, l| g(&lit[l], j));
                let laser_side = Matrix::from_fn(count, spots, |j, l| {
                    lit[l].reflected(scene, points[j].position) * areas[j] * g12[(j, l)]
                });
                (g12, laser_side)
            }
        };
        Ok(Self {
            kernel,
            grids,
            g12,
            g23,
            albedo,
            places: points.iter().map(|p| p.position.to_array()).collect(),
            camera_side,
            laser_side,
            factors: None,
            sent_on: scene.sent_on(),
        })
    }

    /// The same past what stands in the way: C and D times the visible share of each entry, and the
    /// terms of each element.
    fn past(self, scene: &Scene, occlusion: Occlusion) -> Result<Self, ModelError> {
        let obstacles = considered(scene, occlusion);
        if obstacles.is_empty() {
            return Ok(self);
        }
        let settled = settled(
            scene,
            self.kernel,
            &obstacles,
            &self.grids,
            Effort::USUAL,
            false,
        )?;
        Ok(self.with_factors(settled.joined()))
    }

    /// The factors of the elements; C and D times the visible share of each entry.
    fn with_factors(mut self, (factors, [seen, lit]): (Factors, Shares)) -> Self {
        for side in [&mut self.g23, &mut self.camera_side] {
            side.component_mul_assign(&seen);
        }
        for side in [&mut self.g12, &mut self.laser_side] {
            side.component_mul_assign(&lit);
        }
        self.factors = Some(factors);
        self
    }

    /// C·diag(ρ)·D, pixels × spots, W: with one term an element.
    pub fn product(&self) -> Matrix {
        self.product_of(&self.albedo)
    }

    fn product_of(&self, albedo: &[f64]) -> Matrix {
        &self.camera_side * rows_times(self.laser_side.clone(), albedo)
    }

    /// What that differs from [`MatrixModel::phi`] by, relative Frobenius norm; none where nothing
    /// stands in the way.
    pub fn product_error(&self) -> Option<f64> {
        let factors = self.factors.as_ref()?;
        let phi = factors.terms.phi(&self.albedo);
        let norm = phi.norm();
        (norm > 0.0).then(|| (self.product() - phi).norm() / norm)
    }

    /// Φcam, pixels × spots, W.
    pub fn phi(&self) -> Matrix {
        self.phi_of(&self.albedo)
    }

    /// Φcam of elements with these albedos in place of the scene's.
    pub fn phi_of(&self, albedo: &[f64]) -> Matrix {
        match &self.factors {
            Some(factors) => factors.terms.phi(albedo),
            None => self.product_of(albedo),
        }
    }

    /// Multiplies the camera's side, and so Φcam, by `factor`.
    pub fn scale(&mut self, factor: f64) {
        self.camera_side *= factor;
        if let Some(factors) = &mut self.factors {
            factors.scale(factor);
        }
    }
}
