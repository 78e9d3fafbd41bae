//! Which estimator makes the best use of time? Varied: estimator, sampler, samples; Φcam of the
//! published scene with 100 spots.
//!
//! Printed is ε²T: ε the relative Frobenius error against converged quadrature (root mean square
//! over the seeds), T the seconds on one thread (the least over the seeds, for whatever else runs
//! on the machine only adds to it). Where ε² falls like 1/T, ε²T does not depend on the samples;
//! where it falls faster, it falls with them. With `--test` each line runs once, at the fewest
//! samples.

use std::time::Instant;

use phicam::matrix::Matrix;
use phicam::model::{Extent, Kernel, converged};
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::{Budget, Control, Estimator, Plan, render};

/// Seeds of each line.
const SEEDS: u64 = 5;

/// One estimator, sampler and number of samples, and what was seen of it.
struct Line {
    estimator: Estimator,
    sampling: Sampling,
    samples: u64,
    errors: Vec<f64>,
    seconds: Vec<f64>,
}

impl Line {
    /// ε and T of the matrix, traced with `seed`.
    fn measure(&mut self, scene: &Scene, truth: &Matrix, seed: u64) {
        let plan = Plan {
            estimator: self.estimator,
            sampling: self.sampling,
            seed,
            budget: Budget::new(self.samples, self.sampling).expect("a number that can be traced"),
        };
        let control = Control::none();
        let start = Instant::now();
        let traced = render(scene, &plan, 0..truth.ncols(), control).expect("nothing stops it");
        self.seconds.push(start.elapsed().as_secs_f64());
        self.errors
            .push((traced.flux - truth).norm() / truth.norm());
    }

    /// The row of the table.
    fn row(&self) -> String {
        let square = self.errors.iter().map(|e| e * e).sum::<f64>() / self.errors.len() as f64;
        let seconds = self.seconds.iter().copied().fold(f64::INFINITY, f64::min);
        format!(
            "{:<12} {:<6} {:>9}  {:>8.1e}  {seconds:>8.3}  {:>8.1e}",
            self.estimator.name(),
            self.sampling.name(),
            self.samples,
            square.sqrt(),
            square * seconds
        )
    }
}

/// The numbers of samples at which an estimator is measured: the last takes about a second.
fn samples(estimator: Estimator) -> [u64; 3] {
    match estimator {
        Estimator::Independent => [1 << 5, 1 << 6, 1 << 8],
        Estimator::Shared => [1 << 7, 1 << 10, 1 << 13],
        Estimator::Factored => [1 << 13, 1 << 16, 1 << 19],
    }
}

fn main() {
    let test = std::env::args().any(|a| a == "--test");
    let text = Scene::load("thesis").expect("it is built in").text;
    let text = text.replace("per_side = 30", "per_side = 25");
    let scene = Scene::from_toml("thesis, 100 spots", &text).expect("fewer spots on the same wall");
    let truth = converged(&scene, Kernel::Physical, Extent::FULL)
        .expect("a board to integrate over")
        .phi;
    let (seeds, rungs) = if test { (1, 1) } else { (SEEDS, 3) };
    let mut lines = Vec::new();
    for estimator in Estimator::ALL {
        for sampling in [Sampling::Pcg, Sampling::Sobol] {
            for samples in samples(estimator).into_iter().take(rungs) {
                lines.push(Line {
                    estimator,
                    sampling,
                    samples,
                    errors: Vec::new(),
                    seconds: Vec::new(),
                });
            }
        }
    }
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    one.expect("a thread can be started").install(|| {
        for seed in 1..=seeds {
            for line in &mut lines {
                line.measure(&scene, &truth, seed);
            }
        }
    });
    println!("estimator    sampler  samples         ε     T (s)       ε²T");
    for line in &lines {
        println!("{}", line.row());
    }
}
