//! The terms of the chain, from what was integrated and traced.

use super::results::Term;
use super::sizes::Sizes;
use crate::lab::ensemble::Ensemble;
use crate::matrix::Matrix;
use crate::model::Occlusion;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::scene::Scene;

/// Bounce counts that have a row of their own; more share one.
pub(super) const OWN_ROW: usize = 7;
/// Light that met three surfaces.
const THREE: usize = 3;

/// What the tasks of each kind have found, pixels × spots, W.
pub(super) struct Found {
    /// M₀, M₁ and M₂, each with what the quadrature may be off by.
    pub(super) integrals: Vec<Vec<Matrix>>,
    /// Φ of the mean albedo.
    pub(super) grey: Vec<Vec<Matrix>>,
    /// The whole light, then that of 1, 2, … bounces.
    pub(super) long: Vec<Vec<Matrix>>,
    /// Light of three bounces with black occluders.
    pub(super) black: Vec<Vec<Matrix>>,
    /// The same with the Lambertian hidden surface of equal albedo.
    pub(super) matt: Vec<Vec<Matrix>>,
    /// The run and its standard error.
    pub(super) run: [Matrix; 2],
}

impl Found {
    /// The run as its frames store it.
    pub(super) fn stored(&self) -> Matrix {
        self.run[0].map(|x| f64::from(x as f32))
    }

    /// The terms in the order of the chain; `m3` is Φ and its bound.
    pub(super) fn terms(
        &self,
        scene: &Scene,
        sizes: &Sizes<'_>,
        m3: &[Matrix],
    ) -> Result<Vec<Term>, ModelError> {
        let [m0, m1, m2] = [0, 1, 2].map(|i| &self.integrals[i][..]);
        let first =
            |all: &'_ [Vec<Matrix>]| -> Vec<Matrix> { all.iter().map(|m| m[0].clone()).collect() };
        // Light of three bounces by all surfaces, by wall and hidden surfaces alone, and with these
        // Lambertian.
        let all: Vec<Matrix> = self.long.iter().map(|m| m[THREE].clone()).collect();
        let [alone, matt] = [&self.black, &self.matt].map(|all| first(all));
        let own = if alone.is_empty() { &all } else { &alone };
        let modelled = if matt.is_empty() { own } else { &matt };
        let less = modelled.iter().map(|m| m - &m3[0]).collect();
        let mut terms = vec![
            sizes.exact("element area", m1, m0),
            sizes.exact("pixel footprint", m2, m1),
            sizes.exact("spot size and profile", m3, m2),
            sizes.traced("occlusion", &Ensemble::new(less)),
        ];
        let step = |to: &[Matrix], from: &[Matrix]| {
            Ensemble::new(to.iter().zip(from).map(|(t, f)| t - f).collect())
        };
        if !matt.is_empty() {
            terms.push(sizes.traced("S2 not Lambertian", &step(own, &matt)));
        }
        if !alone.is_empty() {
            terms.push(sizes.traced("3 bounces by other surfaces", &step(&all, &alone)));
        }
        terms.extend(self.by_bounces(sizes));
        let zero = Matrix::zeros(m3[0].nrows(), m3[0].ncols());
        let [flux, stderr] = &self.run;
        terms.push(sizes.exact(
            "storage in f32 frames",
            &[self.stored(), zero.clone()],
            &[flux.clone(), zero.clone()],
        ));
        terms.push(sizes.noise("Monte Carlo itself", stderr));
        terms.push(Term {
            in_sum: false,
            ..sizes.exact(
                "étendue, if taken constant",
                &[constant_etendue(scene)?, zero.clone()],
                &[m0[0].clone(), zero],
            )
        });
        Ok(terms)
    }

    /// Light that met another number of surfaces than three.
    fn by_bounces(&self, sizes: &Sizes<'_>) -> Vec<Term> {
        let each =
            |f: &dyn Fn(&Vec<Matrix>) -> Matrix| Ensemble::new(self.long.iter().map(f).collect());
        let mut terms = Vec::new();
        for n in [1, 2, 4, 5, 6, OWN_ROW] {
            let dark = self.long.iter().all(|m| m[n].amax() <= 0.0);
            if n >= THREE || !dark {
                let name = if n == 1 {
                    "1 bounce".to_owned()
                } else {
                    format!("{n} bounces")
                };
                terms.push(sizes.traced(&name, &each(&|m| m[n].clone())));
            }
        }
        let beyond = each(&|m| {
            let zero = Matrix::zeros(m[0].nrows(), m[0].ncols());
            m[OWN_ROW + 1..].iter().fold(zero, |a, b| a + b)
        });
        terms.push(sizes.traced(&format!("{} and more bounces", OWN_ROW + 1), &beyond));
        terms
    }
}

/// The matrix model if every pixel had the mean étendue.
fn constant_etendue(scene: &Scene) -> Result<Matrix, ModelError> {
    let model = MatrixModel::with(scene, Kernel::Physical, None, Occlusion::Ignored)?;
    let camera = scene.camera.position;
    let etendue = |p: usize| {
        let to = scene.camera.footprint(p).at([0.5, 0.5]) - camera;
        let cos = scene.camera.view.normal().dot(to.normalize());
        cos * cos / to.length_squared()
    };
    let each: Vec<f64> = (0..scene.camera.pixels()).map(etendue).collect();
    let mean = each.iter().sum::<f64>() / each.len() as f64;
    let mut phi = model.phi();
    for (mut row, e) in phi.row_iter_mut().zip(&each) {
        row *= mean / e;
    }
    Ok(phi)
}
