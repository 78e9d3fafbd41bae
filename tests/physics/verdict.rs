//! What `validate` names, measures and could not have seen.

use std::sync::OnceLock;

use phicam::lab::{
    Against, Certainty, Deviation, Errors, Integration, Measured, Score, Test, Validation,
    ValidationError, validate,
};
use phicam::matrix::Matrix;
use phicam::model::{Extent, Kernel, Occlusion, converged};
use phicam::num::statistics::binomial_interval;
use phicam::num::stream::{Key, Sampling, Stream};
use phicam::scene::Scene;
use phicam::transport::Traced;

use crate::builtin;

/// 5 × 4 pixels and 8 spots of the bench.
pub(super) fn small() -> Scene {
    let pixels = ("pixels = [16, 16]", "pixels = [5, 4]");
    builtin("bench", &[pixels, ("per_side = 30", "per_side = 2")])
}

const REPLICATES: u32 = 32;
/// Error of an entry relative to it.
const NOISE: f64 = 0.002;

/// Normal replicates of Φcam, their mean and its standard error. Errors that hang together are
/// those of factors that move a row, or everything, in a smooth pattern, beside a tenth of their
/// own.
pub(super) fn traced(phi: &Matrix, errors: Errors, seed: u64) -> Traced {
    let (rows, columns) = phi.shape();
    let mut sums = [0; 2].map(|_| Matrix::zeros(rows, columns));
    for block in 0..REPLICATES {
        let normal = |pixel: usize, spot: usize| {
            let key = Key {
                seed,
                spot: spot as u32,
                pixel: pixel as u32,
                block,
            };
            let mut stream = Stream::new(Sampling::Pcg, key);
            std::array::from_fn::<f64, 2, _>(|_| stream.normal())
        };
        let all = normal(rows, columns);
        for p in 0..rows {
            let row = normal(p, columns);
            for l in 0..columns {
                let own = normal(p, l)[0];
                let wave = (l as f64 / columns as f64 + 0.1 * p as f64).sin();
                let error = match errors {
                    Errors::Independent => own,
                    Errors::WithinRows => row[0] + wave * row[1] + 0.1 * own,
                    Errors::Everywhere => all[0] + wave * all[1] + 0.1 * own,
                };
                let x = phi[(p, l)] * (1.0 + NOISE * f64::from(REPLICATES).sqrt() * error);
                sums[0][(p, l)] += x;
                sums[1][(p, l)] += x * x;
            }
        }
    }
    let n = f64::from(REPLICATES);
    let flux = &sums[0] / n;
    let stderr = sums[1].zip_map(&flux, |square, mean| {
        ((square / n - mean * mean) / (n - 1.0)).max(0.0).sqrt()
    });
    Traced {
        tails: Matrix::zeros(flux.nrows(), flux.ncols()),
        flux,
        stderr,
        bounces: Vec::new(),
    }
}

/// The verdict by quadrature on light with errors from [`REPLICATES`].
pub(super) fn judged(
    scene: &Scene,
    measured: Measured<'_>,
    errors: Errors,
    significance: f64,
) -> Result<Validation, ValidationError> {
    let against = Against {
        kernel: Kernel::Physical,
        integration: Integration::Quadrature,
        occlusion: Occlusion::Ignored,
    };
    let test = Test {
        significance,
        known: Certainty::new(errors, Some(REPLICATES)),
    };
    validate(scene, measured, against, test)
}

fn tested(scene: &Scene, traced: &Traced, errors: Errors, significance: f64) -> Validation {
    let measured = Measured::new(&traced.flux, &traced.stderr, None);
    judged(scene, measured, errors, significance).unwrap()
}

pub(super) fn truth(scene: &Scene) -> Matrix {
    converged(scene, Kernel::Physical, Extent::FULL)
        .unwrap()
        .phi
}

pub(super) fn right() -> &'static Matrix {
    static RIGHT: OnceLock<Matrix> = OnceLock::new();
    RIGHT.get_or_init(|| truth(&small()))
}

pub(super) fn score(found: &Validation) -> &Score {
    found.agreement.score.as_ref().unwrap()
}

/// The scene with one parameter off, by what the light shows in turn: the name of the parameter, a
/// scene, and the change.
pub(super) fn deviant(name: &str, size: f64) -> Option<Scene> {
    use glam::{DAffine3, DQuat, DVec3};
    let scene = small();
    let h = 0.5f64.sqrt();
    let [normal, u, v] = [DVec3::new(0.0, -h, -h), DVec3::X, DVec3::new(0.0, -h, h)];
    let about = |point: DVec3, axis: DVec3| {
        DAffine3::from_translation(point)
            * DAffine3::from_quat(DQuat::from_axis_angle(axis, size.to_radians()))
            * DAffine3::from_translation(-point)
    };
    let moved = |motion: DAffine3| scene.with_moved_hidden(&motion).ok();
    let middle = DVec3::new(5.0, 15.5 - 7.86764 * h, 7.86764 * h);
    let spot = |by: [f64; 2]| {
        let places: Vec<[f64; 2]> = scene
            .laser
            .spots
            .iter()
            .enumerate()
            .map(|(l, s)| {
                let at = s.target.position;
                if l == 3 {
                    [at.x + by[0], at.y + by[1]]
                } else {
                    [at.x, at.y]
                }
            })
            .collect();
        scene.with_spots_at(&places).ok()
    };
    match name {
        "overall scale" => {
            let mut brighter = scene;
            brighter.laser.power *= 1.0 + 0.01 * size;
            Some(brighter)
        }
        // Towards the wall's y axis from its x axis, so around the hinge from the board's normal to
        // the wall's.
        "hinge angle" => moved(about(
            DVec3::new(0.0, 15.5, 0.0),
            normal.cross(DVec3::Z).normalize(),
        )),
        "yaw of S2" => moved(about(middle, v)),
        "S2 along its normal" => moved(DAffine3::from_translation(normal * size)),
        "S2 along u" => moved(DAffine3::from_translation(u * size)),
        "S2 along v" => moved(DAffine3::from_translation(v * size)),
        "all spots, x" => scene.with_shifted_spots([size, 0.0]).ok(),
        "all spots, y" => scene.with_shifted_spots([0.0, size]).ok(),
        "view, x" => Some(scene.with_shifted_view([size, 0.0])),
        "view, y" => Some(scene.with_shifted_view([0.0, size])),
        "scale of the view" => Some(scene.with_scaled_view(1.0 + 0.01 * size)),
        "camera and laser, off the wall" => Some(scene.with_moved_camera(DVec3::Z * size)),
        "camera, along its sight" => {
            let sight = (DVec3::new(4.875, 4.375, 0.0) - scene.camera.position).normalize();
            Some(scene.with_moved_camera(sight * size))
        }
        "camera, across its sight" => {
            let sight = (DVec3::new(4.875, 4.375, 0.0) - scene.camera.position).normalize();
            Some(scene.with_moved_camera(sight.cross(DVec3::Z).normalize() * size))
        }
        "wall bent (sagitta)" => scene.with_bent_relay(size).ok(),
        "one spot alone, x" => spot([size, 0.0]),
        "one spot alone, y" => spot([0.0, size]),
        _ => panic!("{name} is not injected"),
    }
}

/// The light of the scene with one parameter off, and with light beside the model's.
fn light_with(name: &str, size: f64) -> Option<Matrix> {
    match name {
        "offset of all entries" => Some(right().add_scalar(0.01 * size * right().mean())),
        "slope of all entries, x" => Some(over_view(|x, _| size * x, |_| right().mean())),
        "slope of all entries, y" => Some(over_view(|_, y| size * y, |_| right().mean())),
        "falloff over the view, x" => Some(over_view(|x, _| size * x, |light| light)),
        "falloff over the view, y" => Some(over_view(|_, y| size * y, |light| light)),
        "falloff to the corners of the view" => Some(over_view(
            |x, y| -0.5 * size * (x * x + y * y),
            |light| light,
        )),
        "one photograph alone, scale" => Some(spot_3(right() * (0.01 * size))),
        "one photograph alone, offset" => {
            let dark = 0.01 * size * right().mean();
            Some(spot_3(right().map(|_| dark)))
        }
        _ => deviant(name, size).as_ref().map(truth),
    }
}

/// Light with so many percent more, of x and y from −1 to 1 over the 5 × 4 pixels, of what is taken
/// of it.
fn over_view(percent: impl Fn(f64, f64) -> f64, of: impl Fn(f64) -> f64) -> Matrix {
    let right = right();
    Matrix::from_fn(right.nrows(), right.ncols(), |p, l| {
        let [x, y] = [(p % 5, 2.5), (p / 5, 2.0)].map(|(k, half)| (k as f64 + 0.5) / half - 1.0);
        right[(p, l)] + 0.01 * percent(x, y) * of(right[(p, l)])
    })
}

/// Light with so much more under spot 3.
fn spot_3(more: Matrix) -> Matrix {
    let mut light = right().clone();
    light.set_column(3, &(right().column(3) + more.column(3)));
    light
}

pub(super) const ALL: [Errors; 3] = [Errors::Independent, Errors::WithinRows, Errors::Everywhere];
const SEEDS: u64 = 20;

/// Every deviation, injected alone at twice the size that the verdict says it detects, is rejected,
/// and named first or among those that are not told from it, in 19 of 20 seeds; the fitted value is
/// within 3 standard errors of the injected one, also where the light bends by 40 %, as twice what
/// `factored` detects of the camera across its sight, 6.2 in., to whose end its slope does not lead.
#[test]
#[ignore = "slow"]
fn every_deviation_is_found_by_name() {
    let scene = small();
    let mut failed = Vec::new();
    for errors in ALL {
        let first = tested(&scene, &traced(right(), errors, 0), errors, 1e-3);
        let score_of = score(&first);
        let sizes = "whether the spots, taken for points, have a size";
        assert_eq!(
            score_of.untested,
            ["the reflectance of single elements", sizes]
        );
        let third = score_of.spots.iter().filter(|d| d.spot == Some(3));
        for stated in score_of.deviations.iter().chain(third) {
            let injected = 2.0 * stated.detectable;
            let Some(light) = light_with(&stated.name, injected) else {
                failed.push(format!(
                    "{errors:?} {}: {injected} cannot be injected",
                    stated.name
                ));
                continue;
            };
            let half = light_with(&stated.name, 0.5 * injected).unwrap();
            let bend = (&light - (half * 2.0 - right())).norm() / (&light - right()).norm();
            let same = |d: &Deviation| d.name == stated.name && d.spot == stated.spot;
            let (mut named, mut within, mut firsts) = (0, 0, 0);
            for seed in 1..=SEEDS {
                let found = tested(&scene, &traced(&light, errors, seed), errors, 1e-3);
                let own = score(&found);
                firsts += u64::from(own.likely.first().is_some_and(same));
                named += u64::from(!found.agreement.agrees && own.likely.iter().any(same));
                // As it is told: of what is named the value that it was followed to.
                let all = own.likely.iter().chain(&own.deviations).chain(&own.spots);
                let fit = { all }.find(|d| same(d)).unwrap();
                within += u64::from((fit.value - injected).abs() <= 3.0 * fit.stderr);
            }
            println!(
                "{errors:?} {}: {injected:.3e} {}, bend {bend:.3}, first {firsts}, named {named}, within {within}",
                stated.name, stated.unit
            );
            // 3 σ leave out 0.3 % of a normal distribution, 1 of 20 in one of 19.
            if named < 19 || within < 19 {
                failed.push(format!(
                    "{errors:?} {}: named {named}, within {within}",
                    stated.name
                ));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

/// A deviation by which the model bends is followed to its size, within 3.5 standard errors (one of
/// ten exceeds that in 0.5 %); its first step alone is off by up to hundreds.
#[test]
fn a_large_deviation_is_followed_to_its_size() {
    let scene = small();
    let errors = Errors::Independent;
    for (name, size) in [
        ("hinge angle", 5.0),
        ("yaw of S2", -4.0),
        ("S2 along its normal", 0.5),
        ("S2 along u", 0.5),
        ("S2 along v", -0.4),
        ("all spots, x", -0.5),
        ("view, y", 0.3),
        ("scale of the view", 20.0),
        ("camera and laser, off the wall", 3.0),
        ("one spot alone, x", 0.4),
        ("slope of all entries, x", 3.0),
        ("falloff over the view, y", 5.0),
        ("falloff to the corners of the view", 5.0),
        ("one photograph alone, scale", 100.0),
        ("one photograph alone, offset", 5.0),
    ] {
        let light = light_with(name, size).unwrap();
        let found = tested(&scene, &traced(&light, errors, 1), errors, 1e-3);
        let own = score(&found);
        // Of one spot alone a shift in x is hardly told from a scale.
        let of_one = name.starts_with("one ");
        let first = own.likely.iter().find(|d| d.name == name);
        let first = first.unwrap_or_else(|| panic!("{name}: {:?}", own.likely));
        assert!(of_one || own.likely[0].name == name, "{:?}", own.likely);
        let off = (first.value - size) / first.stderr;
        println!("{name}: {} ± {} for {size}", first.value, first.stderr);
        assert!(first.is_followed && off.abs() <= 3.5, "{name}: {off}");
    }
}

/// Light of another picture, of measured photographs: a board of 4 × 4 fields in place of 2 × 2,
/// and one whose levels are 0.1 and 0.9. All 64 reflectances leave what noise leaves, the likeliest
/// single parameter more, in all of 10 draws. Of a geometry that is off the picture never explains
/// what the parameter does not, whatever the draw.
#[test]
fn another_picture_is_told_from_a_geometry() {
    let scene = small();
    let errors = Errors::Independent;
    let fitted = |light: &Matrix, seed: u64| {
        let found = tested(&scene, &traced(light, errors, seed), errors, 1e-3);
        let own = score(&found);
        assert!(!found.agreement.agrees);
        // Of photographs the size of spots that are taken for points stays open, and nothing else.
        let [open] = own.untested.as_slice() else {
            panic!("{:?}", own.untested);
        };
        assert!(open.contains("taken for points"), "{open}");
        let picture = own.picture.unwrap();
        assert!(picture.elements == 64 && picture.free <= 64);
        (picture, picture.is_missed && picture.misses.abs() < 3.9)
    };
    let board = |light: f64, dark: f64| {
        let own = format!("dark = {dark:?}, light = {light:?}");
        let changes = [
            ("pixels = [16, 16]", "pixels = [5, 4]"),
            ("per_side = 30", "per_side = 2"),
            ("dark = 0.0, light = 1.0", own.as_str()),
        ];
        truth(&builtin("bench", &changes))
    };
    for light in [truth(&scene.with_checkerboard(4)), board(0.9, 0.1)] {
        for seed in 0..10 {
            let (picture, is_named) = fitted(&light, seed);
            println!("{picture:?}");
            // χ² of 96 to 160 degrees of freedom is below 1.6 in all but 1e-4.
            assert!(is_named && picture.chi2_per_dof < 1.6, "{picture:?}");
        }
    }
    for (name, size) in [("hinge angle", 2.0), ("S2 along u", 0.3), ("view, y", 0.3)] {
        let light = light_with(name, size).unwrap();
        for seed in 0..10 {
            let (picture, is_named) = fitted(&light, seed);
            println!("{name}: {picture:?}");
            assert!(!is_named, "{name}: {picture:?}");
        }
    }
}

/// The right model: at 5 % no more verdicts reject it, and no more name a parameter, than 99 % of
/// the binomial distribution allow.
#[test]
#[ignore = "slow"]
fn a_right_model_is_rejected_as_often_as_stated() {
    let scene = small();
    for errors in ALL {
        let (mut rejected, mut named) = (0, 0);
        for seed in 0..100 {
            let found = tested(&scene, &traced(right(), errors, 1000 + seed), errors, 0.05);
            rejected += u64::from(!found.agreement.agrees);
            named += u64::from(score(&found).rejects());
        }
        println!("{errors:?}: {rejected} rejected, {named} named");
        let [least, most] = binomial_interval(100, 0.05, 0.99);
        assert!(
            (least..=most).contains(&rejected),
            "{errors:?}: {rejected} of 100"
        );
        let [_, most] = binomial_interval(100, 0.05 / 3.0, 0.99);
        assert!(named <= most, "{errors:?}: {named} named of 100");
    }
}

/// The rest of what a verdict says: χ² by pixel and spot, entries left out, no evidence.
#[test]
fn flagged_entries_do_not_count() {
    let scene = small();
    let mut light = traced(right(), Errors::Independent, 7);
    // A single entry that is wrong by half, flagged.
    light.flux[(3, 5)] *= 1.5;
    let mut flags = Matrix::zeros(20, 8);
    let verdict = |left_out: Option<&Matrix>, light: &Traced| {
        let measured = Measured::new(&light.flux, &light.stderr, left_out);
        let found = judged(&scene, measured, Errors::Independent, 1e-3);
        found.unwrap().agreement
    };
    let all = verdict(Some(&flags), &light);
    assert!(!all.agrees && all.left_out == 0);
    assert_eq!((all.worst[0].pixel, all.worst[0].spot), (3, 5));
    let most =
        |x: &[Option<f64>]| (0..x.len()).max_by(|a, b| x[*a].unwrap().total_cmp(&x[*b].unwrap()));
    assert_eq!((most(&all.pixels), most(&all.spots)), (Some(3), Some(5)));
    flags[(3, 5)] = 1.0;
    let rest = verdict(Some(&flags), &light);
    assert!(rest.agrees, "{}", rest.verdict());
    assert_eq!((rest.left_out, rest.entries), (1, 159));
    assert!(rest.verdict().contains("1 of 160 entries left out"));
    flags.fill(1.0);
    let none = verdict(Some(&flags), &light);
    assert!(!none.agrees && !none.evidence && none.verdict().starts_with("no evidence"));
}

/// The figures measured outside: a board 0.2 % brighter is a scale of that, with an error that
/// covers it, and the wall's albedo counts twice.
#[test]
fn a_scale_is_measured_with_its_error() {
    let scene = small();
    let light = traced(&(right() * 1.002), Errors::Independent, 3);
    let found = tested(&scene, &light, Errors::Independent, 1e-3).agreement;
    // Σ φ r/Σ φ² with errors of 0.2 % of each φ; 160 standard errors of 31 degrees each: 1 %.
    let expected = NOISE * right().map(|x| x.powi(4)).sum().sqrt() / right().norm_squared();
    assert!(
        (found.best_scale_stderr / expected - 1.0).abs() < 0.05,
        "{}",
        found.best_scale_stderr
    );
    assert!((found.best_scale - 1.002).abs() < 4.0 * found.best_scale_stderr);
    let likely = &found.score.as_ref().unwrap().likely;
    let scale = likely.iter().find(|d| d.name == "overall scale").unwrap();
    assert!((scale.value - 0.2).abs() < 4.0 * scale.stderr);
    let same = |name: &str| scale.same.iter().find(|(n, _)| n.contains(name)).unwrap().1;
    assert!((same("wall") - 0.5).abs() < 1e-3 && (same("object") - 1.0).abs() < 1e-3);
}
