//! Tracer and model against an independent quadrature, closed forms and the laws of light
//! transport.

mod accuracy;
mod bayes;
mod brdf;
mod calibrated_past;
mod closed_forms;
mod counts;
mod divided;
mod edges;
mod indicator;
mod known;
mod laboratory;
mod laws;
mod meshes;
mod model;
mod noise;
mod obstacles;
mod occluders;
mod random_scenes;
mod reference;
mod sensor;
mod shining;
mod studies;
mod tails;
mod verdict;
mod verdict_past;

use std::ops::Range;

use phicam::lab::{Agreement, Certainty, Errors, Evidence, Test, agree};
use phicam::matrix::Matrix;
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::{Budget, Control, Estimator, Plan, Traced, render};

/// How to trace: estimator, sampling, seed, samples.
#[derive(Clone, Copy, Debug)]
struct Way(Estimator, Sampling, u64, u64);

impl Way {
    fn plan(self) -> Plan {
        let Self(estimator, sampling, seed, samples) = self;
        Plan {
            estimator,
            sampling,
            seed,
            budget: Budget::new(samples, sampling).unwrap(),
        }
    }
}

fn trace_spots(scene: &Scene, way: Way, spots: Range<usize>) -> Traced {
    let control = Control::none();
    render(scene, &way.plan(), spots, control).unwrap()
}

fn trace(scene: &Scene, way: Way) -> Traced {
    trace_spots(scene, way, 0..scene.laser.spots.len())
}

fn builtin(name: &str, changes: &[(&str, &str)]) -> Scene {
    let mut text = Scene::load(name).unwrap().text;
    for (old, new) in changes {
        assert!(text.contains(old), "{name} has no `{old}`");
        text = text.replacen(old, new, 1);
    }
    Scene::from_toml(name, &text).unwrap_or_else(|e| panic!("{e}"))
}

/// Traced against truth at a significance of 1e-4.
fn compare(traced: &Traced, truth: &Matrix, way: Way) -> Agreement {
    let test = Test {
        significance: 1e-4,
        known: Certainty::of(&way.plan()),
    };
    let evidence = Evidence {
        traced: &traced.flux,
        stderr: &traced.stderr,
        model: truth,
        bound: None,
        left_out: None,
        eliminated: None,
    };
    agree(evidence, test, None).0
}

/// Two independent renders of the same truth: the differences against their joint standard error.
fn assert_same(a: &Traced, b: &Traced, what: &str) {
    assert_same_under(Errors::WithinRows, a, b, what);
}

/// The same where errors may hang together in another way.
fn assert_same_under(errors: Errors, a: &Traced, b: &Traced, what: &str) {
    let stderr = a.stderr.zip_map(&b.stderr, |x, y| (x * x + y * y).sqrt());
    let evidence = Evidence {
        traced: &a.flux,
        stderr: &stderr,
        model: &b.flux,
        bound: None,
        left_out: None,
        eliminated: None,
    };
    // Two sets of 32 replicates: at least 31 degrees of freedom (Welch); rows may be correlated.
    let test = Test {
        significance: 1e-4,
        known: Certainty::new(errors, Some(32)),
    };
    let verdict = agree(evidence, test, None).0;
    assert!(verdict.agrees, "{what}: {verdict:?}");
    assert!(a.flux.sum() > 0.0, "{what}: no light at all");
}

fn matrix(rows: &[Vec<f64>]) -> Matrix {
    Matrix::from_fn(rows.len(), rows[0].len(), |p, l| rows[p][l])
}

/// ‖a − b‖/‖b‖.
fn relative(a: &Matrix, b: &Matrix) -> f64 {
    (a - b).norm() / b.norm()
}
