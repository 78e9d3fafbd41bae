//! The likelihood against a dense normal distribution; places against scenes that were moved.

mod background;
mod refuted;
mod told;

use nalgebra::DVector;

use super::frames::{Frames, Seen, Sides, TermsOf, covariance_root};
use super::likelihood::{Fit, Spectrum};
use super::{Located, LocatedPlan};
use crate::lab::Integration;
use crate::lab::comparison::misplaced::normal;
use crate::lab::geometry::normal::Normal;
use crate::lab::uncertainty::certainty::Certainty;
use crate::lab::uncertainty::unexplained::Unexplained;
use crate::matrix::Matrix;
use crate::model::Occlusion;
use crate::scene::{Parameter, Scene, file::SceneFile};
use crate::transport::Control;

/// Standard normal numbers.
fn noise(rows: usize, columns: usize, seed: u64) -> Matrix {
    let mut pair = normal(seed);
    Matrix::from_fn(rows, columns, |_, _| pair()[0])
}

/// 12 pixels, 4 elements of two terms each, 3 frames, two patterns.
struct Small {
    phi: Matrix,
    stderr: Matrix,
    left_out: Matrix,
    patterns: Matrix,
    camera: Matrix,
    laser: Matrix,
    element: Vec<usize>,
}

const PLACES: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];

impl Small {
    fn new() -> Self {
        let mut left_out = Matrix::zeros(12, 3);
        left_out[(3, 1)] = 1.0;
        left_out[(7, 2)] = 2.0;
        let smooth = |p: usize, k: usize| if k == 0 { 1.0 } else { p as f64 };
        Self {
            phi: noise(12, 3, 1).map(|x| 3.0 + x),
            stderr: noise(12, 3, 2).map(|x| 0.2 + 0.1 * x.abs()),
            left_out,
            patterns: Matrix::from_fn(12, 2, smooth),
            camera: noise(12, 8, 3),
            laser: noise(8, 3, 4),
            element: vec![0, 0, 1, 1, 2, 2, 3, 3],
        }
    }

    fn photographs(&self) -> Unexplained<'_> {
        Unexplained {
            phi: &self.phi,
            stderr: Some(&self.stderr),
            certainty: Certainty::STATED,
            left_out: Some(&self.left_out),
            patterns: Some(&self.patterns),
        }
    }

    fn seen(&self) -> Seen<'_> {
        Seen {
            photographs: self.photographs(),
            common: None,
        }
    }

    fn frames(&self) -> Frames {
        Frames::new(self.seen(), self.terms()).unwrap()
    }

    fn terms(&self) -> TermsOf<'_> {
        TermsOf {
            camera: &self.camera,
            laser: &self.laser,
            element: &self.element,
            elements: 4,
        }
    }

    /// The same written out: an orthonormal basis of what the patterns leave, and there the data
    /// and their dependence on ρ, entry by entry.
    fn dense(&self) -> (DVector<f64>, Matrix) {
        let (mut data, mut model): (Vec<f64>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        for l in 0..3 {
            let counted: Vec<usize> = (0..12).filter(|p| self.left_out[(*p, l)] == 0.0).collect();
            let root = |p: usize| 1.0 / self.stderr[(p, l)];
            let n = counted.len();
            let patterns = Matrix::from_fn(n, 2, |i, k| {
                root(counted[i]) * self.patterns[(counted[i], k)]
            });
            // What is orthogonal to the patterns: eigenvectors of 1 − F (FᵀF)⁻¹ Fᵀ of value 1.
            let inverse = (patterns.transpose() * &patterns).try_inverse().unwrap();
            let rest = Matrix::identity(n, n) - &patterns * inverse * patterns.transpose();
            let eigen = nalgebra::SymmetricEigen::new(rest);
            for (k, value) in eigen.eigenvalues.iter().enumerate() {
                if *value < 0.5 {
                    continue;
                }
                let basis = eigen.eigenvectors.column(k);
                let along = |of: &dyn Fn(usize) -> f64| -> f64 {
                    (0..n)
                        .map(|i| basis[i] * root(counted[i]) * of(counted[i]))
                        .sum()
                };
                data.push(along(&|p| self.phi[(p, l)]));
                let light = |j: usize| {
                    let terms = [2 * j, 2 * j + 1];
                    along(&|p| {
                        terms
                            .iter()
                            .map(|s| self.camera[(p, *s)] * self.laser[(*s, l)])
                            .sum()
                    })
                };
                model.push((0..4).map(light).collect());
            }
        }
        let rows = model.len();
        (
            DVector::from_vec(data),
            Matrix::from_fn(rows, 4, |i, j| model[i][j]),
        )
    }
}

/// H, h, s and n of all frames are those of the problem written out.
#[test]
fn frames_are_the_normal_equations() {
    let small = Small::new();
    let all = small.frames().all();
    let (data, model) = small.dense();
    let near = |a: &Matrix, b: &Matrix| assert!((a - b).amax() < 1e-10 * b.amax(), "{a}{b}");
    near(&all.h, &(model.transpose() * &model));
    let side = model.transpose() * &data;
    near(
        &Matrix::from_columns(&[all.side]),
        &Matrix::from_columns(&[side]),
    );
    assert!((all.square / data.norm_squared() - 1.0).abs() < 1e-12);
    assert_eq!(all.count, data.len() as f64);
    // A frame lit as another spot would.
    let sides = Sides::new(small.seen(), &small.camera).unwrap();
    let swapped = sides.lit(&[(0, 2)], small.terms());
    let other = Small {
        laser: Matrix::from_fn(8, 3, |s, _| small.laser[(s, 2)]),
        ..Small::new()
    };
    let due = &other.frames().each[0];
    near(&swapped.h, &due.h);
}

/// −½ n ln(yᵀV⁻¹y) − ½ ln det V with V = 1 + A K Aᵀ/λ written out, the largest over λ.
#[test]
fn the_likelihood_is_that_of_the_normal_distribution() {
    let small = Small::new();
    let all = small.frames().all();
    let root = covariance_root(&PLACES, 1.5).unwrap();
    let found = Fit::new(&all, &root).unwrap().unwrap();
    let (y, a) = small.dense();
    let distance = |i: usize, j: usize| {
        let d = DVector::from_column_slice(&PLACES[i]) - DVector::from_column_slice(&PLACES[j]);
        d.norm()
    };
    let k = Matrix::from_fn(4, 4, |i, j| libm::exp(-distance(i, j) / 1.5));
    let n = y.len() as f64;
    let dense = |log_lambda: f64| {
        let v =
            Matrix::identity(y.len(), y.len()) + &a * &k * a.transpose() / libm::exp(log_lambda);
        let square = y.dot(&(v.clone().try_inverse().unwrap() * &y));
        -0.5 * (n * libm::log(square) + libm::log(v.determinant()))
    };
    let best = (-2000..3000)
        .map(|i| f64::from(i) * 0.005)
        .max_by(|a, b| dense(*a).total_cmp(&dense(*b)))
        .unwrap();
    assert!((found.log_likelihood - dense(best)).abs() < 1e-4);
    // The posterior mean and what it leaves, at that λ: (AᵀA + λK⁻¹)⁻¹ Aᵀy.
    let inverse = k.try_inverse().unwrap() * libm::exp(best);
    let rho = (a.transpose() * &a + inverse).try_inverse().unwrap() * (a.transpose() * &y);
    let own = Spectrum::new(&all, &root)
        .unwrap()
        .unwrap()
        .rho(libm::exp(best));
    assert!((&own - &rho).amax() < 0.01 * rho.amax(), "{own}{rho}");
    let misfit = (&y - &a * rho).norm() / y.norm();
    assert!((found.misfit / misfit - 1.0).abs() < 1e-3);
}

/// The bench with 12 spots, 8 × 8 pixels and 4 × 4 elements, on which two patches are bright.
fn bench() -> Scene {
    let mut file = SceneFile::default();
    file.laser.as_mut().unwrap().spots.per_side = Some(3);
    file.camera.pixels = [8, 8];
    Scene::new(&file, None).unwrap()
}

const BRIGHT: [usize; 3] = [5, 6, 9];

/// Photographs of `scene` with so much noise, relative to their root mean square.
fn photographed(scene: &Scene, relative: f64, seed: u64) -> (Matrix, Matrix) {
    photographed_as(&plan([0.0; 2], 0), scene, relative, seed)
}

/// The same, integrated as this plan does.
fn photographed_as(
    plan: &LocatedPlan,
    scene: &Scene,
    relative: f64,
    seed: u64,
) -> (Matrix, Matrix) {
    let model = plan.model(scene).unwrap();
    let albedo: Vec<f64> = (0..16)
        .map(|j| if BRIGHT.contains(&j) { 0.8 } else { 0.1 })
        .collect();
    let clean = model.phi_of(&albedo);
    let (rows, columns) = clean.shape();
    let sigma = relative * clean.norm() / ((rows * columns) as f64).sqrt();
    let phi = clean + noise(rows, columns, seed) * sigma;
    (phi, Matrix::from_element(rows, columns, sigma))
}

fn plan(range: [f64; 2], orders: u64) -> LocatedPlan {
    LocatedPlan {
        what: "normal",
        range,
        steps: 9,
        elements: Some([4, 4]),
        occlusion: Occlusion::Considered,
        integration: Integration::Quadrature,
        background: false,
        orders,
        seed: 1,
    }
}

/// By centres, where many photographs are located.
fn by_centres(range: [f64; 2], orders: u64) -> LocatedPlan {
    LocatedPlan {
        integration: Integration::Centres,
        ..plan(range, orders)
    }
}

fn located(scene: &Scene, phi: &Matrix, stderr: &Matrix, plan: LocatedPlan) -> Located {
    let photographs = Unexplained {
        phi,
        stderr: Some(stderr),
        certainty: Certainty::STATED,
        left_out: None,
        patterns: None,
    };
    plan.locate(scene, &photographs, Control::none()).unwrap()
}

/// The scene, its hidden surface moved along its normal.
fn moved(scene: &Scene, by: f64) -> Scene {
    let normal = scene.hidden().next().unwrap().1.shape.at([0.5; 2]).normal * by;
    let motion = glam::DAffine3::from_translation(normal);
    scene.with_moved_hidden(&motion).unwrap()
}

/// A surface that stands 0.4 in. further along its normal is found there, within three standard
/// errors that are small enough to tell; its order of spots too; and where neither is in the data,
/// that is said.
#[test]
fn a_moved_surface_is_found() {
    let scene = bench();
    let truth = moved(&scene, 0.4);
    let (phi, stderr) = photographed(&truth, 1e-3, 5);
    let found = located(&scene, &phi, &stderr, plan([-1.0, 1.0], 999));
    let (size, error) = (found.size.unwrap(), found.stderr().unwrap());
    assert!(
        (size - 0.4).abs() < 3.0 * error && error < 0.1,
        "{size} ± {error}"
    );
    assert!(found.noise > 0.8 && found.noise < 1.2, "{}", found.noise);
    let order = found.order.unwrap();
    assert_eq!((order.as_likely, order.is_by_chance()), (0, Some(false)));
    assert!(found.is_found());
    // Spots that were interchanged.
    let count = phi.ncols();
    let mixed = Matrix::from_fn(phi.nrows(), count, |p, l| phi[(p, (7 * l + 3) % count)]);
    let wrong = located(&scene, &mixed, &stderr, plan([-1.0, 1.0], 999));
    assert_eq!(wrong.order.unwrap().is_by_chance(), Some(true));
    assert!(!wrong.is_found());
    // A range that does not hold the place.
    let beside = located(&scene, &phi, &stderr, plan([-1.0, 0.1], 0));
    assert!(beside.size.is_none() && !beside.is_found());
    // So few orders say nothing.
    let few = located(&scene, &phi, &stderr, plan([-1.0, 1.0], 50));
    assert_eq!(few.order.unwrap().is_by_chance(), None);
}

/// Frames that are off by one, backwards, or mirrored are not random: the right order is named, at
/// a noise of 1 and of 20 %, and where it is the stated one none is.
#[test]
fn an_order_that_is_easily_mistaken_is_told() {
    let scene = bench();
    let truth = moved(&scene, 0.3);
    let what = |phi: &Matrix, stderr: &Matrix| {
        let plan = LocatedPlan {
            steps: 5,
            ..by_centres([-1.0, 1.0], 1)
        };
        let found = located(&scene, phi, stderr, plan);
        assert!(found.mistaken.is_none() || !found.is_found());
        found.mistaken.map(|other| other.what)
    };
    let at = |u: usize, v: usize| u + 8 * v;
    for (noise, seed) in [(1e-2, 3), (0.2, 5)] {
        let (phi, stderr) = photographed_as(&by_centres([0.0; 2], 0), &truth, noise, seed);
        assert_eq!(what(&phi, &stderr), None);
        let (pixels, n) = phi.shape();
        let frames = |of: &dyn Fn(usize) -> usize| {
            let own = Matrix::from_fn(pixels, n, |p, l| phi[(p, of(l))]);
            what(&own, &stderr)
        };
        let own = |of: &dyn Fn(usize, usize) -> usize| {
            let own = Matrix::from_fn(pixels, n, |p, l| phi[(of(p % 8, p / 8), l)]);
            what(&own, &stderr)
        };
        for (found, words) in [
            (frames(&|l| (l + 1) % n), "each frame stands 1 too early"),
            (frames(&|l| (l + n - 2) % n), "each frame stands 2 too late"),
            (frames(&|l| n - 1 - l), "the frames stand backwards"),
            (own(&|u, v| at(7 - u, v)), "mirrored left to right"),
            (own(&|u, v| at(u, 7 - v)), "upside down, mirrored"),
            (own(&|u, v| at(7 - u, 7 - v)), "upside down"),
            (own(&|u, v| at(v, u)), "columns and rows of the photographs"),
        ] {
            let found = found.unwrap();
            assert!(found.contains(words), "{noise}: {found} for {words}");
        }
    }
    // Single photographs, at the place where the surface is: 1 % of noise tells of them.
    let (phi, stderr) = photographed_as(&by_centres([0.0; 2], 0), &scene, 1e-2, 3);
    let (pixels, n) = phi.shape();
    let frames = |of: &dyn Fn(usize) -> usize| {
        let own = Matrix::from_fn(pixels, n, |p, l| phi[(p, of(l))]);
        what(&own, &stderr).unwrap_or_default()
    };
    let exchanged = frames(&|l| match l {
        2 => 7,
        7 => 2,
        l => l,
    });
    assert_eq!(exchanged, "photographs 2 and 7 are exchanged");
    // One missed, and what stands last taken twice or dark; one taken twice, and the last missed.
    for missed in [2, 5, 9] {
        let early = frames(&|l| if l < missed { l } else { (l + 1).min(n - 1) });
        assert!(
            early.contains(&format!("photograph {missed} on each stands 1 too early")),
            "{early}"
        );
        let late = frames(&|l| if l <= missed { l } else { l - 1 });
        let words =
            [missed, missed + 1].map(|k| format!("photograph {k} on each stands 1 too late"));
        assert!(words.iter().any(|words| late.contains(words)), "{late}");
    }
}

/// Of photographs that tell the place to a hundredth of a step it is found there: of 8 draws none
/// lies beyond four stated errors, and their mean within four of its own.
#[test]
fn little_noise_is_searched_as_finely() {
    let scene = bench();
    let truth = moved(&scene, 0.173);
    let plan = by_centres([-1.5, 1.5], 0);
    let mut sum = 0.0;
    for seed in 0..8 {
        let (phi, stderr) = photographed_as(&plan, &truth, 1e-4, 20 + seed);
        let found = located(&scene, &phi, &stderr, plan);
        let (size, error) = (found.size.unwrap(), found.stderr().unwrap());
        let z = (size - 0.173) / error;
        assert!(z.abs() < 4.0 && error < 0.01, "{size} ± {error}");
        sum += z;
    }
    assert!((sum / 8.0).abs() < 4.0 / 8f64.sqrt(), "{sum}");
}

/// A turn is found with the sign that the scene's parameter of that name has.
#[test]
fn yaw_turns_as_the_parameter_does() {
    let scene = bench();
    let parameters = Parameter::named(&scene, "hidden.yaw").unwrap();
    let truth = scene.displaced(&parameters, &[2.0]).unwrap();
    let (phi, stderr) = photographed(&truth, 1e-3, 3);
    let yaw = LocatedPlan {
        what: "yaw",
        ..plan([-5.0, 5.0], 0)
    };
    let found = located(&scene, &phi, &stderr, yaw);
    let (size, error) = (found.size.unwrap(), found.stderr().unwrap());
    assert!(
        (size - 2.0).abs() < 4.0 * error && error < 0.5,
        "{size} ± {error}"
    );
}

/// Over 60 draws the errors are as large as stated: of true 95 % intervals 52 or fewer of 60 would
/// hold the truth once in 100 times. Being the larger of two errors, they may hold it more often.
#[test]
#[ignore = "slow"]
fn errors_are_as_large_as_stated() {
    let scene = bench();
    let truth = moved(&scene, 0.2);
    let plan = by_centres([-1.5, 1.5], 0);
    let holds = |seed: &u64| {
        let (phi, stderr) = photographed_as(&plan, &truth, 1e-2, 100 + seed);
        let found = located(&scene, &phi, &stderr, plan);
        let z = (found.size.unwrap() - 0.2) / found.stderr().unwrap();
        z.abs() < 1.96
    };
    let held = (0..60).filter(holds).count();
    assert!(held > 52, "{held} of 60");
}

/// Random orders of 3 spots: each of the six about as often.
#[test]
fn every_order_is_equally_likely() {
    let mut seen = std::collections::BTreeMap::<Vec<usize>, u32>::new();
    for k in 0..6000 {
        *seen
            .entry(super::order::shuffled(&[0, 1, 2], 9, k))
            .or_default() += 1;
    }
    // χ² of 5 degrees of freedom: 20.5 at 0.1 %.
    let chi2: f64 = seen
        .values()
        .map(|n| (f64::from(*n) - 1000.0).powi(2) / 1000.0)
        .sum();
    assert!(seen.len() == 6 && chi2 < 20.5, "{seen:?}");
}
