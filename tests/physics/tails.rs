//! Whether standard errors that are trusted can be: renders of a few samples against one of many.

use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::Estimator::{self, Shared};
use phicam::transport::Traced;

use crate::{Way, builtin, trace};

/// Student's quantiles of 31 degrees of freedom at 95 % and 99.9 %, two-sided.
const QUANTILES: [f64; 2] = [2.0395, 3.6335];

const BOARD: &str = "rectangle = { corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }";

/// The bench with few pixels and spots, another object and what stands before it.
fn scene(object: &str, before: &str) -> Scene {
    let changes = [
        ("pixels = [16, 16]", "pixels = [8, 8]"),
        ("per_side = 30", "per_side = 3"),
    ];
    let text = builtin("bench", &changes).text;
    assert!(text.contains(BOARD));
    Scene::from_toml("tails", &(text.replace(BOARD, object) + before))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Entries of renders of few samples: all, those that are flagged, those of the others that lie
/// outside 95 % and outside 99.9 %, and the same of all.
#[derive(Debug, Default)]
struct Counts {
    entries: usize,
    flagged: usize,
    outside: [usize; 2],
    outside_of_all: [usize; 2],
}

impl Counts {
    fn add(&mut self, traced: &Traced, truth: &Traced) {
        for i in 0..truth.flux.len() {
            let off = (traced.flux[i] - truth.flux[i]).abs();
            let error = libm::hypot(traced.stderr[i], truth.stderr[i]);
            let trusted = traced.tails[i] == 0.0;
            let known = traced.stderr[i] > 0.0 || truth.flux[i] == 0.0;
            assert!(known, "entry {i} is 0 ± 0 and in truth {}", truth.flux[i]);
            self.entries += 1;
            self.flagged += usize::from(!trusted);
            for (k, t) in QUANTILES.iter().enumerate() {
                let outside = off > t * error;
                self.outside_of_all[k] += usize::from(outside);
                self.outside[k] += usize::from(trusted && outside);
            }
        }
    }

    fn shares(&self) -> [f64; 5] {
        let left = (self.entries - self.flagged).max(1) as f64;
        let all = self.entries as f64;
        let [a, b] = self.outside.map(|n| n as f64 / left);
        let [c, d] = self.outside_of_all.map(|n| n as f64 / all);
        [self.flagged as f64 / all, a, b, c, d]
    }
}

/// Every estimator, eight seeds, against a render of 2¹⁷ samples with another seed: of the entries
/// that are not flagged at most 6 % outside 95 % and 0.3 % outside 99.9 %. Gives the share that is
/// flagged.
fn assert_kept(scene: &Scene, samples: u64) -> f64 {
    let truth = trace(scene, Way(Shared, Sampling::Sobol, 1000, 1 << 17));
    let mut counts = Counts::default();
    for estimator in Estimator::ALL {
        let mut own = Counts::default();
        for seed in 1..=8 {
            let traced = trace(scene, Way(estimator, Sampling::Sobol, seed, samples));
            own.add(&traced, &truth);
            counts.add(&traced, &truth);
        }
        println!("{estimator}: {own:?} {:.4?}", own.shares());
    }
    let [flagged, a, b, ..] = counts.shares();
    println!("{counts:?} {:.4?}", counts.shares());
    assert!(a <= 0.06 && b <= 0.003, "{counts:?}");
    flagged
}

/// The screen stands between camera and sphere, the plate between wall and sphere.
const PLATE: &str = r#"[[surface]]
name = "plate"
role = "occluder"
material = { lambertian = 0.0 }
mesh = { generate = "box", scale = [2.4, 1.8, 0.1], translate = [5, 6.9, 2.5], closed = true }
[[surface]]
name = "screen"
role = "occluder"
sides = "two"
material = { lambertian = 0.0 }
rectangle = { corner = [2.606, 7.84, 4.235], u = [0, 3.2, 0], v = [1.188, 0, 2.97] }
"#;

const PLANK: &str = r#"[[surface]]
name = "plank"
role = "occluder"
material = { lambertian = 0.9 }
mesh = { generate = "box", scale = [2.2, 1.1, 0.125], translate = [5.2, 6.9, 0.5], closed = true }
"#;

#[test]
#[ignore = "slow"]
fn a_sphere_behind_a_plate_is_trusted_where_it_can_be() {
    let sphere = "sphere = { centre = [5, 9.4, 5], radius = 1.0, face = \"outside\" }";
    let scene = scene(sphere, PLATE);
    assert_kept(&scene, 64);
    assert_kept(&scene, 4096);
}

#[test]
#[ignore = "slow"]
fn a_reflecting_plank_is_trusted_where_it_can_be() {
    assert_kept(&scene(BOARD, PLANK), 512);
}

/// Where nothing is heavy nearly every entry is trusted.
#[test]
#[ignore = "slow"]
fn the_plain_bench_is_trusted() {
    assert!(assert_kept(&scene(BOARD, ""), 512) < 0.01);
}
