//! A projector–camera pair, the pair exchanged, and what makes their matrices one.
//!
//! The projector lights wall point s_l with the power Φlaser, the camera's pixel p collects from
//! the wall around x_p with the étendue E_p:
//!
//! > T\[p,l\] = Φlaser · E_p · k(x_p, s_l),   k(x, s) = (ρ3/π) (ρ1/π) ∫ G(x, y) (ρ2/π) G(y, s) dy,   in length⁻² sr⁻¹
//!
//! By Helmholtz reciprocity k(x, s) = k(s, x), so the matrix T′ of the exchanged pair is, with its
//! own étendues E′,
//!
//! > T′\[l,p\] = Φlaser · E′_l · k(s_l, x_p),   T′ = diag(E′) · Tᵀ · diag(1/E)
//!
//! and c″ = diag(E′) Tᵀ diag(1/E) p″ is, in watts and without a free scale, the photograph that a
//! camera in the projector's place takes of the wall under light from the camera's place. What
//! keeps two traced matrices from this law is noise, and that a footprint has an area where a spot
//! has none: T averages k over the camera's footprints, T′ over the projector's cells.

use super::super::traced::{replicates, trace};
use crate::geometry::DVec3;
use crate::lab::LabError;
use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, Take, converged};
use crate::num::quadrature::Rule;
use crate::scene::Scene;
use crate::transport::{Control, Estimator, Traced};

/// Points of each replicate.
pub(super) const SIZE: u32 = 8;
/// Nodes a side of the quadrature of an étendue; the next rule changes it by less than 1e-12.
pub(super) const NODES: usize = 4;

/// E_p = ∫ A_lens cosθ_cam cosθ_view/d² dA over the footprint of each pixel, by `nodes` × `nodes`
/// points, length² sr.
pub(super) fn etendues(scene: &Scene, nodes: usize) -> Vec<f64> {
    let camera = &scene.camera;
    let normal = camera.view.normal();
    let rule = Rule::gauss_legendre(nodes);
    let at = |point: DVec3| {
        let line = camera.position - point;
        let cos = line.normalize().dot(normal);
        camera.aperture_area * cos * cos / line.length_squared()
    };
    let etendue = |pixel: usize| {
        let footprint = camera.footprint(pixel);
        let row = |(b, wb): (f64, f64)| {
            let nodes = rule.on(0.0, 1.0);
            wb * nodes
                .map(|(a, wa)| wa * at(footprint.at([a, b])))
                .sum::<f64>()
        };
        footprint.area * rule.on(0.0, 1.0).map(row).sum::<f64>()
    };
    (0..camera.pixels()).map(etendue).collect()
}

/// The pair with projector and camera exchanged: laser and pinhole change places, the spots are the
/// centres of the camera's pixels, and the view is moved from those to the grid of spots, whose
/// cells are as many and as large as the pixels in the scene `dual`.
pub(super) fn exchanged(scene: &Scene) -> Result<Scene, LabError> {
    let camera = &scene.camera;
    let centre = |p: usize| camera.footprint(p).at([0.5, 0.5]);
    let centres: Vec<[f64; 2]> = (0..camera.pixels())
        .map(|p| [centre(p).x, centre(p).y])
        .collect();
    let spots = &scene.laser.spots;
    let middle = spots.iter().map(|s| s.target.position).sum::<DVec3>() / spots.len() as f64;
    let way = middle - camera.view.at([0.5, 0.5]).position;
    let mut back = scene
        .with_shifted_view([way.x, way.y])
        .with_moved_camera(scene.laser.position - camera.position);
    back.laser.position = camera.position;
    Ok(back.with_spots_at(&centres)?)
}

/// One direction of the pair.
pub(super) struct Direction {
    pub(super) scene: Scene,
    pub(super) traced: Traced,
    pub(super) etendues: Vec<f64>,
}

impl Direction {
    pub(super) fn trace(
        scene: Scene,
        size: u32,
        seed: u64,
        control: Control<'_>,
    ) -> Result<Self, LabError> {
        let spots = 0..scene.laser.spots.len();
        Ok(Self {
            traced: trace(
                &scene,
                Estimator::Independent,
                replicates(size),
                seed,
                spots,
                control,
            )?,
            etendues: etendues(&scene, NODES),
            scene,
        })
    }

    /// k of a matrix of this direction: entries by Φlaser·E_p, length⁻² sr⁻¹.
    pub(super) fn transport(&self, matrix: &Matrix) -> Matrix {
        let power = self.scene.laser.power;
        Matrix::from_fn(matrix.nrows(), matrix.ncols(), |p, l| {
            matrix[(p, l)] / (power * self.etendues[p])
        })
    }

    /// k averaged over the footprints, each by its étendues, over k at their centres, less 1; and
    /// what quadrature may be off by. From the model alone, and unmoved by a scale of the étendues.
    fn spread(&self) -> Result<[Matrix; 2], LabError> {
        let centres = Extent {
            footprints: Take::Centre,
            ..Extent::FULL
        };
        let [whole, centre] =
            [Extent::FULL, centres].map(|extent| converged(&self.scene, Kernel::Physical, extent));
        let (whole, centre) = (whole?, centre?);
        let [over, at] = [NODES, 1].map(|nodes| etendues(&self.scene, nodes));
        let (pixels, spots) = whole.phi.shape();
        let effect =
            |p: usize, l: usize| whole.phi[(p, l)] / centre.phi[(p, l)] * (at[p] / over[p]) - 1.0;
        let bound = (whole.bound + centre.bound).component_div(&centre.phi);
        Ok([Matrix::from_fn(pixels, spots, effect), bound])
    }
}

/// By how much k of one direction exceeds the transposed k of the other because footprints have an
/// area and spots have none, as a part of it; pixels × spots.
pub(super) struct Footprints {
    /// By quadrature.
    pub(super) signed: Matrix,
    /// What the quadrature may be off by.
    pub(super) bound: Matrix,
}

pub(super) fn footprints(there: &Direction, back: &Direction) -> Result<Footprints, LabError> {
    let ([a, a_bound], [b, b_bound]) = (there.spread()?, back.spread()?);
    Ok(Footprints {
        signed: a - b.transpose(),
        bound: a_bound + b_bound.transpose(),
    })
}
