//! How does the rank of \[Φcam\] grow with the number of laser spots?
//!
//! Φcam = C·diag(ρ)·D has p rows (pixels), one column for each of the l spots, and between them r
//! elements of the hidden surface, of which r₊ reflect. So rank Φcam ≤ min(p, r₊, l): the number of
//! independent things that the photographs say of the object. What of them is above noise is the
//! numerical rank: the singular values σ_k(l) of l columns above τ·σ₁(L), with L all spots of the
//! scene and τ the norm of the noise over that of Φcam. The l spots are spread over all of them:
//! each is as far from those before it as any. The floor is the same for every l, so that a further
//! spot never lowers the rank: σ_k(l) ≤ σ_k(l + 1) (Cauchy's interlacing). Past what stands in the
//! way an element is a sum of several products, and r₊ counts those.

mod describe;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::registered::{Registered, prepared};
use crate::geometry::DVec3;
use crate::lab::error::LabError;
use crate::lab::options::{Opt, OptionError};
use crate::lab::study::Study;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::linalg::svd;
use crate::scene::Scene;
use crate::transport::Control;

/// `phicam study spots`.
pub(super) const STUDY: Registered = Registered {
    name: "spots",
    about: "How the rank of Φcam grows with the number of laser spots: table, JSON, CSV, figure",
    scene: Some("bench"),
    files: "spots.csv, spots.svg",
    options: &[
        Opt::whole(
            "spots",
            "Numbers of spots, separated by commas, each so many of the scene's, spread over them; unless given 1, 2, 4, … and all",
        )
        .list()
        .within(1, 1_000_000),
        Opt::number(
            "tolerance",
            "Singular values up to this times the largest one with all spots count as zero, separated by commas",
        )
        .list()
        .or("1e-2,1e-4,1e-6,1e-8")
        .rule(
            |x| (1e-12..1.0).contains(&x),
            "is not a tolerance",
            "use a number from 1e-12 to 1; below 1e-12 rounding dominates",
        ),
        Opt::whole("elements", "Elements a side, in place of the scene's").within(1, 1024),
    ],
    prepare: |scene, values| {
        let all = scene.laser.spots.len();
        let mut spots: Vec<usize> = values.list("spots")?;
        if let Some(n) = spots.iter().find(|n| **n > all) {
            let cause = format!("--spots {n} is more than {} has", scene.name);
            return Err(OptionError::new(cause, format!("use at most {all}")).into());
        }
        if spots.is_empty() {
            spots = std::iter::successors(Some(1), |n| Some(2 * n))
                .take_while(|n| *n < all)
                .collect();
            spots.push(all);
        }
        spots.sort_unstable();
        spots.dedup();
        let elements = values.maybe("elements")?.map(|n| [n; 2]);
        Ok(prepared(SpotsStudy {
            model: MatrixModel::new(scene, Kernel::Physical, elements)?,
            scene: scene.clone(),
            spots,
            tolerances: values.list("tolerance")?,
        }))
    },
};

/// The study of a scene. A task is one number of spots.
#[derive(Debug)]
pub(super) struct SpotsStudy {
    scene: Scene,
    model: MatrixModel,
    spots: Vec<usize>,
    tolerances: Vec<f64>,
}

/// Φcam of all spots, pixels × spots, W, and its largest singular value.
#[derive(Debug)]
pub(super) struct Photographs {
    phi: Matrix,
    largest: f64,
}

/// The rank with some of the spots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RankOfSpots {
    /// How many spots, spread over those of the scene.
    pub spots: usize,
    /// min(p, r₊, l), which the rank cannot exceed.
    pub bound: usize,
    /// Rank at each tolerance.
    pub ranks: Vec<usize>,
    /// The singular value of that number over the largest one with all spots: the tolerance below
    /// which the rank is the bound, if rounding allows.
    pub last: f64,
}

/// How the rank grows.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SpotRanks {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Pixels, p.
    pub pixels: usize,
    /// Elements of the hidden surfaces, r.
    pub elements: usize,
    /// Those that reflect, r₊; past what stands in the way their terms.
    pub reflecting: usize,
    /// Whether something stands in the way.
    pub obstructed: bool,
    /// Spots of the scene, L.
    pub all_spots: usize,
    /// Singular values up to this times σ₁(L) count as zero.
    pub tolerances: Vec<f64>,
    /// By growing number of spots.
    pub steps: Vec<RankOfSpots>,
}

impl SpotsStudy {
    fn reflecting(&self) -> usize {
        let reflects = |element: usize| self.model.albedo[element] > 0.0;
        match &self.model.factors {
            Some(factors) => factors
                .terms
                .element
                .iter()
                .filter(|j| reflects(**j))
                .count(),
            None => (0..self.model.albedo.len())
                .filter(|j| reflects(*j))
                .count(),
        }
    }

    fn bound(&self, spots: usize) -> usize {
        self.model.g23.nrows().min(self.reflecting()).min(spots)
    }
}

/// The numbers of `places`, each as far from those before it as any, the first the one nearest to
/// their mean; of equals the first.
fn spread(places: &[DVec3]) -> Vec<usize> {
    let mean = places.iter().sum::<DVec3>() / places.len().max(1) as f64;
    let mut apart: Vec<f64> = places
        .iter()
        .map(|p| 1.0 / p.distance_squared(mean))
        .collect();
    let mut order = Vec::with_capacity(places.len());
    for _ in places {
        let farther = |far: usize, i: usize| if apart[i] > apart[far] { i } else { far };
        let Some(next) = (0..places.len()).reduce(farther) else {
            break;
        };
        if order.is_empty() {
            apart.fill(f64::INFINITY);
        }
        for (apart, place) in apart.iter_mut().zip(places) {
            *apart = apart.min(place.distance_squared(places[next]));
        }
        apart[next] = -1.0;
        order.push(next);
    }
    order
}

/// The rank of the first columns of Φcam; `bound` is what it cannot exceed.
fn rank(
    Photographs { phi, largest }: &Photographs,
    columns: Range<usize>,
    bound: usize,
    tolerances: &[f64],
) -> Result<RankOfSpots, LabError> {
    let sigma = svd(&phi.columns_range(columns.clone()).into_owned())?.sigma;
    let above = |tolerance: &f64| sigma.iter().filter(|s| **s > tolerance * largest).count();
    Ok(RankOfSpots {
        spots: columns.len(),
        bound,
        ranks: tolerances.iter().map(above).collect(),
        last: sigma.get(bound.max(1) - 1).map_or(0.0, |s| s / largest),
    })
}

impl Study for SpotsStudy {
    type Context = Photographs;
    type Output = RankOfSpots;
    type Result = SpotRanks;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.spots.len()
    }

    fn context(&self, _: Control<'_>) -> Result<Photographs, LabError> {
        let spots = self.scene.laser.spots.iter();
        let places: Vec<DVec3> = spots.map(|s| s.target.position).collect();
        let phi = self.model.phi().select_columns(&spread(&places));
        let largest = svd(&phi)?.sigma.max();
        if largest > 0.0 {
            Ok(Photographs { phi, largest })
        } else {
            Err(LabError::DARK)
        }
    }

    fn task(
        &self,
        photographs: &Photographs,
        index: usize,
        _: Control<'_>,
    ) -> Result<RankOfSpots, LabError> {
        let spots = self.spots[index];
        rank(photographs, 0..spots, self.bound(spots), &self.tolerances)
    }

    fn fits(&self, _: &Photographs, index: usize, part: &RankOfSpots) -> bool {
        part.spots == self.spots[index] && part.ranks.len() == self.tolerances.len()
    }

    fn finish(&self, _: &Photographs, steps: Vec<RankOfSpots>) -> Result<SpotRanks, LabError> {
        Ok(SpotRanks {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            pixels: self.model.g23.nrows(),
            elements: self.model.albedo.len(),
            reflecting: self.reflecting(),
            obstructed: self.model.factors.is_some(),
            all_spots: self.scene.laser.spots.len(),
            tolerances: self.tolerances.clone(),
            steps,
        })
    }
}

#[cfg(test)]
mod tests;
