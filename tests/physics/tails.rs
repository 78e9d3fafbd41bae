//! Whether standard errors that are trusted can be: renders of a few samples against one of many.

use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::Estimator::{self, Factored, Independent, Shared};

use crate::{Way, builtin, trace};

/// Student's quantiles of 31 degrees of freedom at 95 % and 99.9 %, two-sided.
const QUANTILES: [f64; 2] = [2.0395, 3.6335];

const BOARD: &str = "rectangle = { corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }";

/// The bench with few pixels and spots, another object and what stands before it.
fn scene(object: &str, before: &str) -> Scene {
    let bench = builtin(
        "bench",
        &[
            ("pixels = [16, 16]", "pixels = [8, 8]"),
            ("per_side = 30", "per_side = 3"),
            (BOARD, object),
        ],
    );
    Scene::from_toml("tails", &(bench.text + before)).unwrap()
}

/// Of `seeds` renders of `samples` samples, the share of entries that are flagged, and of the others
/// the share outside 95 % and outside 99.9 % of a render of 2¹⁷ samples with another seed.
fn shares(scene: &Scene, estimator: Estimator, samples: u64, seeds: u64) -> (f64, [f64; 2]) {
    let truth = trace(scene, Way(estimator, Sampling::Sobol, 1000, 1 << 17));
    let (mut entries, mut left, mut outside) = (0, 0, [0; 2]);
    let (mut all, mut unlit) = ([0; 2], 0);
    for seed in 0..seeds {
        let traced = trace(scene, Way(estimator, Sampling::Sobol, seed, samples));
        for i in 0..truth.flux.len() {
            let off = (traced.flux[i] - truth.flux[i]).abs();
            let error = libm::hypot(traced.stderr[i], truth.stderr[i]);
            let trusted = traced.tails[i] == 0.0;
            assert!(
                traced.stderr[i] > 0.0 || truth.flux[i] == 0.0,
                "entry {i} is 0 ± 0, and in truth {}",
                truth.flux[i]
            );
            entries += 1;
            left += usize::from(trusted);
            unlit += usize::from(traced.flux[i] == 0.0);
            for (k, t) in QUANTILES.iter().enumerate() {
                all[k] += usize::from(off > t * error);
                outside[k] += usize::from(trusted && off > t * error);
            }
        }
    }
    let share = |n: usize, of: usize| n as f64 / of.max(1) as f64;
    let found = (1.0 - share(left, entries), outside.map(|n| share(n, left)));
    println!(
        "{estimator}, {samples} samples, {entries} entries: flagged {:.4}, outside {:?}; of all {:?}, without light {:.4}",
        found.0,
        found.1,
        all.map(|n| share(n, entries)),
        share(unlit, entries)
    );
    found
}

/// At most 6 % and 0.3 %, of entries that are not all flagged; `flagged` is the most that may be.
fn assert_kept(scene: &Scene, samples: u64, seeds: u64, most: f64) {
    for estimator in [Independent, Shared, Factored] {
        let (flagged, outside) = shares(scene, estimator, samples, seeds);
        assert!(
            outside[0] <= 0.06 && outside[1] <= 0.003,
            "{estimator}: {outside:?}"
        );
        assert!(flagged <= most, "{estimator}: {flagged}");
    }
}

#[test]
#[ignore = "slow"]
fn a_sphere_behind_a_plate_is_trusted_where_it_can_be() {
    let sphere = "sphere = { centre = [5, 9.4, 5], radius = 1.0, face = \"outside\" }";
    let plate = "[[surface]]\nname = \"plate\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.0 }\n\
         mesh = { generate = \"box\", scale = [2.4, 1.8, 0.1], translate = [5, 7.2, 2.5], closed = true }\n";
    assert_kept(&scene(sphere, plate), 64, 8, 1.0);
}

#[test]
#[ignore = "slow"]
fn a_reflecting_plank_is_trusted_where_it_can_be() {
    let plank = "[[surface]]\nname = \"plank\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.9 }\n\
         mesh = { generate = \"box\", scale = [2.2, 1.1, 0.125], translate = [5.2, 6.9, 0.5], closed = true }\n";
    assert_kept(&scene(BOARD, plank), 512, 8, 1.0);
}

#[test]
#[ignore = "slow"]
fn the_plain_bench_is_trusted() {
    assert_kept(&scene(BOARD, ""), 512, 8, 0.05);
}
