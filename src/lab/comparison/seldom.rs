//! Shadows that so few paths meet that the scatter of blocks does not show them.
//!
//! Something in the way takes the part f of an entry's light. Of N paths N f meet it, by chance,
//! and so the entry scatters at least by
//!
//! > Var = Φ² f/N,
//!
//! the variance of a Poisson number of paths that carry Φ/N each. Where few paths a block meet the
//! shadow, errors that are estimated from the scatter of blocks are small where few paths happened
//! to meet it, and lack it altogether where none did.

use crate::matrix::Matrix;
use crate::model::{Kernel, ModelError, shadows};
use crate::scene::Scene;

use crate::lab::uncertainty::certainty::Certainty;

/// Paths of a block that meet a shadow, fewer than which are few: of 32 blocks of 4 each, deviates
/// of more than 4.2 are twice as many as they should be, of 1 each ten times.
const FEW: f64 = 4.0;

/// What such shadows add to the variance of each entry, over the square of its light, pixels ×
/// spots.
pub(super) struct Seldom(Matrix);

impl Seldom {
    /// In a scene of which what stands in the way leaves `share` of each entry; none where the
    /// paths are not known.
    ///
    /// # Errors
    /// [`ModelError`].
    pub(super) fn new(
        scene: &Scene,
        kernel: Kernel,
        share: &Matrix,
        known: Certainty,
    ) -> Result<Option<Self>, ModelError> {
        let (Some(paths), Some(blocks)) = (known.paths, known.replicates) else {
            return Ok(None);
        };
        let (paths, blocks) = (paths as f64, f64::from(blocks));
        let mut added = Matrix::zeros(share.nrows(), share.ncols());
        for taken in shadows(scene, kernel, share)? {
            added += taken.map(|f| {
                if paths * f < FEW * blocks {
                    f / paths
                } else {
                    0.0
                }
            });
        }
        Ok(Some(Self(added)))
    }

    /// Standard errors of `phi`, W, with it, and of how many entries they are others. An error of 0
    /// is that of an entry without light.
    pub(super) fn added_to(&self, stderr: &Matrix, phi: &Matrix) -> (Matrix, usize) {
        let mut entries = 0;
        let own = Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| {
            let (own, added) = (stderr[(p, l)], phi[(p, l)] * self.0[(p, l)].sqrt());
            if own > 0.0 && added > 0.0 {
                entries += 1;
                own.hypot(added)
            } else {
                own
            }
        });
        (own, entries)
    }
}

#[cfg(test)]
pub(in crate::lab) mod tests {
    use super::*;
    use crate::lab::comparison::misplaced::normal;
    use crate::lab::{Against, Errors, Integration, Measured, Test, validate};
    use crate::model::{Extent, Occlusion, converged};
    use crate::num::statistics::sidak_threshold;
    use crate::num::stream::{Key, Sampling, Stream};
    use crate::scene::file::SceneFile;

    const BLOCKS: u32 = 32;
    pub(in crate::lab) const PATHS: u64 = 3200;

    /// The bench with small plates in the way.
    pub(in crate::lab) fn bench(plates: &[[f64; 3]]) -> Scene {
        let mut file = SceneFile::builtin("bench").unwrap();
        file.camera.pixels = [6; 2];
        file.laser.as_mut().unwrap().spots.per_side = Some(3);
        let plate = |(k, [x, y, z]): (usize, &[f64; 3])| {
            format!(
                "[[surface]]\nname = \"plate{k}\"\nrole = \"occluder\"\nsides = \"two\"\n\
                 rectangle = {{ corner = [{x}, {y}, {z}], u = [0.12, 0, 0], v = [0, 0.1, 0] }}\n\
                 material = {{ lambertian = 0.0 }}\n"
            )
        };
        let plates: Vec<String> = plates.iter().enumerate().map(plate).collect();
        let text = file.toml().unwrap() + &plates.concat();
        Scene::from_toml("plates", &text).unwrap()
    }

    pub(in crate::lab) fn certainty(paths: Option<u64>) -> Certainty {
        Certainty {
            paths,
            ..Certainty::new(Errors::Independent, Some(BLOCKS))
        }
    }

    /// Block means of light of which each path meets a shadow by chance, and their error; other
    /// noise is a millionth.
    pub(in crate::lab) fn blocks(free: &Matrix, taken: &Matrix, seed: u64) -> [Matrix; 2] {
        let key = Key {
            seed,
            spot: 0,
            pixel: 0,
            block: 0,
        };
        let random = &mut Stream::new(Sampling::Pcg, key);
        let mut pair = normal(seed);
        let each = PATHS / u64::from(BLOCKS);
        let (mut phi, mut stderr) = (free.clone(), free.clone());
        for at in 0..free.len() {
            let n = f64::from(BLOCKS);
            let block = |_| {
                let met = (0..each).filter(|_| random.uniform() < taken[at]).count();
                1.0 - met as f64 / each as f64 + 1e-6 * n.sqrt() * pair()[0]
            };
            let all: Vec<f64> = (0..BLOCKS).map(block).collect();
            let mean = all.iter().sum::<f64>() / n;
            let squares = all.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            phi[at] *= mean;
            stderr[at] *= (squares / (n * (n - 1.0))).sqrt();
        }
        [phi, stderr]
    }

    /// Photographs of a right model past small plates, each path of which meets them by chance: by
    /// the scatter of blocks it is refused, of 20 draws 15 times or more; with what seldom shadows
    /// add, at a significance of 1 %, once at most (twice in 1.7 % of such tests).
    #[test]
    fn shadows_that_few_paths_meet_refute_no_model() {
        let scene = bench(&[[3.6, 4.0, 2.0], [5.2, 6.1, 2.5]]);
        let full = |occlusion| Extent {
            occlusion,
            ..Extent::FULL
        };
        let kernel = Kernel::Physical;
        let free = converged(&scene, kernel, full(Occlusion::Ignored)).unwrap();
        let past = converged(&scene, kernel, full(Occlusion::Considered)).unwrap();
        let share = past.visible.unwrap().share;
        let taken = share.map(|left| 1.0 - left);
        let few = |f: &&f64| **f > 0.0 && **f * (PATHS as f64) < FEW * f64::from(BLOCKS);
        assert!(taken.iter().filter(few).count() > 20);
        let refused = |known: Certainty| {
            let seldom = Seldom::new(&scene, kernel, &share, known).unwrap();
            let draw = |seed: &u64| {
                let [phi, stderr] = blocks(&free.phi, &taken, *seed);
                let own = seldom
                    .as_ref()
                    .map(|own| own.added_to(&stderr, &past.phi).0);
                let stderr = own.unwrap_or(stderr);
                let z = (&phi - &past.phi)
                    .component_div(&stderr)
                    .map(|t| known.normal(t));
                let limit = sidak_threshold(0.01, z.len() as u64);
                z.amax() > limit
            };
            (0..20).filter(draw).count()
        };
        assert!(refused(certainty(None)) >= 15);
        let wrongly = refused(certainty(Some(PATHS)));
        assert!(wrongly <= 1, "{wrongly} of 20");
        // Where many paths would have met a shadow that is not there the model is refused.
        let against = Against {
            kernel,
            integration: Integration::Quadrature,
            occlusion: Occlusion::Considered,
        };
        let verdict = |[phi, stderr]: &[Matrix; 2], paths: u64| {
            let test = Test {
                significance: 1e-3,
                known: certainty(Some(paths)),
            };
            let measured = Measured::new(phi, stderr, None);
            validate(&scene, measured, against, test).unwrap().agreement
        };
        let drawn = verdict(&blocks(&free.phi, &taken, 1), PATHS);
        assert!(drawn.agrees && drawn.seldom > 20, "{}", drawn.verdict());
        let without = [free.phi.clone(), &free.phi * 1e-5];
        let refused = verdict(&without, 10_000_000);
        assert!(!refused.agrees, "{}", refused.verdict());
    }

    /// What one plate takes of the light past the other, against the light without it.
    #[test]
    fn each_shadow_is_that_of_one_thing() {
        let places = [[3.6, 4.0, 2.0], [5.2, 6.1, 2.5]];
        let phi = |plates: &[[f64; 3]]| {
            let scene = bench(plates);
            converged(&scene, Kernel::Physical, Extent::FULL).unwrap()
        };
        let both = phi(&places);
        let share = both.visible.unwrap().share;
        let mut found = shadows(&bench(&places), Kernel::Physical, &share).unwrap();
        // Board and wall take nothing.
        found.retain(|own| own.amax() > 1e-9);
        assert_eq!(found.len(), 2);
        for (k, own) in found.iter().enumerate() {
            let without = phi(&places[1 - k..2 - k]).phi;
            let taken = both.phi.zip_map(&without, |left, all| 1.0 - left / all);
            assert!(taken.amax() > 1e-3);
            let off = (own - &taken).amax();
            // To what the shares are refined to.
            assert!(off < 3e-4, "{k}: {off} of {}", taken.amax());
        }
    }
}
