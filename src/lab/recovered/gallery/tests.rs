use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use super::*;
use crate::lab::{Certainty, Noise, recover_objects};
use crate::model::Kernel;
use crate::num::control::Control;
use crate::recovery::{Nuisance, Options};
use crate::scene::Scene;

/// The bench with 4 × 4 elements, 8 × 8 pixels, 40 spots, and photographs of it with a noise of a
/// thousandth.
struct Bench {
    scene: Scene,
    model: MatrixModel,
    phi: Matrix,
    stderr: Matrix,
}

fn bench() -> Bench {
    let text = include_str!("../../../../scenes/bench.toml")
        .replace("per_side = 30", "per_side = 10")
        .replace("pixels = [16, 16]", "pixels = [8, 8]")
        .replace("elements = [8, 8]", "elements = [4, 4]");
    let scene = Scene::from_toml("small", &text).unwrap();
    let model = MatrixModel::new(&scene, Kernel::Physical, None).unwrap();
    let exact = model.phi();
    let stderr = exact.map(|x| 1e-3 * x);
    let phi = &exact + normal_deviates(77, exact.nrows(), exact.ncols()).component_mul(&stderr);
    Bench {
        scene,
        model,
        phi,
        stderr,
    }
}

impl Bench {
    fn tasks<'a>(&'a self, known: &'a [RecoveredObject], plan: GalleryPlan) -> GalleryTasks<'a> {
        let photographs = (&self.phi, &self.stderr);
        GalleryTasks::new(&self.scene, &self.model, photographs, known, plan).unwrap()
    }

    fn gallery(&self, plan: GalleryPlan) -> RunGallery {
        self.tasks(&[], plan)
            .gallery(quietly(&AtomicBool::new(false)))
            .unwrap()
    }

    /// The reference: the recovery that a run makes of photographs.
    fn recovered(
        &self,
        method: Method,
        [phi, stderr]: &[Matrix; 2],
        options: &Options,
    ) -> Vec<RecoveredObject> {
        let noise = Noise::StandardError(stderr, Certainty::STATED);
        let attempts = recover_objects(
            &self.model,
            phi,
            noise,
            Nuisance::default(),
            &[method],
            options,
            Control::none(),
        );
        attempts.into_iter().next().unwrap().outcome.unwrap()
    }
}

fn quietly(stop: &AtomicBool) -> Control<'_> {
    Control {
        progress: &|_| (),
        stop,
    }
}

/// Equal but for the order of sums: within 1e-9 of the largest value.
fn same(found: &GalleryPicture, known: &RecoveredObject, what: &str) {
    let scale = known
        .reflectance
        .iter()
        .fold(1e-300f64, |m, x| m.max(x.abs()));
    for (a, b) in found.reflectance.iter().zip(&known.reflectance) {
        assert!((a - b).abs() <= 1e-9 * scale, "{what}: {a} {b}");
    }
    let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-6 * (1.0 + b.abs()),
        (a, b) => a == b,
    };
    let own = &found.measures[0];
    assert!(near(own.mtf_raw, known.mtf_raw), "{what}: {own:?}");
    assert!(
        near(own.mtf_normalized, known.mtf_normalized),
        "{what}: {own:?}"
    );
    assert!(near(own.correlation, known.correlation), "{what}: {own:?}");
    assert!(near(own.rmse, known.rmse), "{what}: {own:?}");
}

/// At every noise the automatic step is what a run would recover from those photographs, picture,
/// figures and words.
#[test]
fn automatic_pictures_are_the_recoveries_of_a_run() {
    let bench = bench();
    let plan = GalleryPlan::of_run(5);
    let tasks = bench.tasks(&[], plan.clone());
    let gallery = bench.gallery(plan);
    let deviates = normal_deviates(5, bench.phi.nrows(), bench.phi.ncols());
    assert_eq!(gallery.series.len(), Method::USUAL.len());
    for series in &gallery.series {
        for (noise, chosen) in series.automatic.iter().enumerate() {
            let what = format!("{} at noise {}", series.method, gallery.noises[noise]);
            let photographs = tasks.photographs(noise, &deviates);
            let known = bench.recovered(series.method, &photographs, &Options::default());
            let chosen = chosen.as_ref().unwrap();
            let picture = series.pictures[noise][chosen.step].as_ref().unwrap();
            same(picture, &known[0], &what);
            if series.method != Method::Pinv {
                assert_eq!(chosen.words, known[0].parameter, "{what}");
            }
        }
    }
    assert!(gallery.left_out.is_empty(), "{:?}", gallery.left_out);
}

/// Every step of a regularisation is the recovery with that parameter, from the photographs as they
/// are.
#[test]
fn every_step_is_a_recovery() {
    let bench = bench();
    let gallery = bench.gallery(GalleryPlan::of_run(5));
    let photographs = [bench.phi.clone(), bench.stderr.clone()];
    for series in gallery.series.iter().filter(|s| s.steps.len() > 1) {
        for (step, picture) in series.steps.iter().zip(&series.pictures[0]) {
            let mut options = Options::default();
            match *step {
                Parameter::Rank(rank) => options.rank = Some(rank),
                Parameter::Damping(damping) => options.damping = Some(damping),
                _ => panic!("{step:?}"),
            }
            let known = bench.recovered(series.method, &photographs, &options);
            same(picture.as_ref().unwrap(), &known[0], &format!("{step:?}"));
        }
    }
}

/// What is added has the standard deviation that the level says, its recovery is told so, and
/// louder noise is the same draw, larger.
#[test]
fn noise_has_its_level() {
    let bench = bench();
    let plan = GalleryPlan::of_run(5);
    let noises = plan.noises.clone();
    let tasks = bench.tasks(&[], plan);
    let deviates = normal_deviates(5, bench.phi.nrows(), bench.phi.ncols());
    let n = bench.phi.len() as f64;
    let mean = bench.phi.iter().sum::<f64>() / n;
    let [phi, stderr] = tasks.photographs(0, &deviates);
    assert_eq!((phi, stderr), (bench.phi.clone(), bench.stderr.clone()));
    let mut drawn: Option<Matrix> = None;
    for (noise, level) in noises.iter().enumerate().skip(1) {
        let [phi, stderr] = tasks.photographs(noise, &deviates);
        let added = (&phi - &bench.phi) / (level * mean);
        let rms = (added.norm_squared() / n).sqrt();
        // The root mean square of n standard normal numbers scatters by 1/√(2 n): five of them.
        assert!((rms - 1.0).abs() < 5.0 / (2.0 * n).sqrt(), "{level}: {rms}");
        let told = stderr.zip_map(&bench.stderr, |a, b| (a * a - b * b).sqrt()) / (level * mean);
        // Differences of squares are rounded as the larger square is.
        let larger = bench.stderr.amax() / (level * mean);
        let rounding = 8.0 * f64::EPSILON * (1.0 + larger * larger);
        assert!((told.map(|x| x - 1.0)).amax() < rounding, "{level}");
        if let Some(drawn) = &drawn {
            // The sum of photographs and 1e-6 of noise is rounded at 1e-16: 1e-10 of the noise.
            assert!((&added - drawn).amax() < 1e-8, "{level}");
        }
        drawn = Some(added);
    }
}

/// From the strongest regularisation on, each step lets more through.
#[test]
fn steps_go_from_strong_to_weak() {
    let gallery = bench().gallery(GalleryPlan::of_run(5));
    for series in &gallery.series {
        let through = |p: &Parameter| match *p {
            Parameter::Rank(rank) => rank as f64,
            Parameter::Damping(damping) => -damping,
            _ => 0.0,
        };
        let ordered = series
            .steps
            .windows(2)
            .all(|w| through(&w[0]) < through(&w[1]));
        assert!(ordered, "{}: {:?}", series.method, series.steps);
        let pictures = series
            .pictures
            .iter()
            .all(|of| of.len() == series.steps.len());
        assert!(pictures && series.pictures.len() == gallery.noises.len());
    }
}

/// Recoveries that are there are not made again, and the gallery does not depend on the number of
/// threads.
#[test]
fn threads_do_not_show_and_known_recoveries_are_kept() {
    let bench = bench();
    let photographs = [bench.phi.clone(), bench.stderr.clone()];
    let known = bench.recovered(Method::Joint, &photographs, &Options::default());
    let plan = GalleryPlan::of_run(5);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let tasks = bench.tasks(&known, plan.clone());
        pool.install(|| tasks.gallery(quietly(&AtomicBool::new(false))))
            .unwrap()
    };
    let one = with(1);
    assert_eq!(one, with(2));
    let joint = one
        .series
        .iter()
        .find(|s| s.method == Method::Joint)
        .unwrap();
    let first = joint.pictures[0][0].as_ref().unwrap();
    assert_eq!(first.reflectance, known[0].reflectance);
    assert_eq!(
        joint.automatic[0].as_ref().unwrap().words,
        known[0].parameter
    );
}

#[test]
fn it_says_how_far_it_is_and_stops_when_told() {
    let bench = bench();
    let tasks = bench.tasks(&[], GalleryPlan::of_run(5));
    let done = Mutex::new(0);
    let stop = AtomicBool::new(false);
    let control = Control {
        progress: &|steps| *done.lock().unwrap() += steps,
        stop: &stop,
    };
    assert!(tasks.gallery(control).is_some());
    assert_eq!(*done.lock().unwrap(), tasks.count());
    stop.store(true, Ordering::Relaxed);
    assert!(tasks.gallery(control).is_none());
}

#[test]
fn darkness_has_no_gallery_and_what_is_not_to_be_recovered_says_why() {
    let mut bench = bench();
    let dark = bench.phi.map(|_| 0.0);
    let plan = GalleryPlan::of_run(1);
    let none = GalleryTasks::new(
        &bench.scene,
        &bench.model,
        (&dark, &dark),
        &[],
        plan.clone(),
    );
    assert!(none.is_none());
    // Without a noise model nothing chooses a parameter: the steps are there, but none is
    // automatic.
    bench.stderr.fill(0.0);
    let gallery = bench.gallery(plan.clone());
    let tsvd = gallery
        .series
        .iter()
        .find(|s| s.method == Method::Tsvd)
        .unwrap();
    assert!(
        tsvd.automatic[0]
            .as_ref()
            .is_err_and(|why| why.contains("zero")),
        "{:?}",
        tsvd.automatic[0]
    );
    assert!(tsvd.automatic[6].is_ok() && tsvd.pictures[0].iter().all(Option::is_some));
    // What a pixel does not see cannot be divided by.
    bench.model.camera_side[(3, 1)] = 0.0;
    let gallery = bench.gallery(plan);
    let of = |method| gallery.series.iter().find(|s| s.method == method).unwrap();
    assert!(
        of(Method::Pinv)
            .automatic
            .iter()
            .all(|a| a.as_ref().is_err_and(|why| why.contains("pixel 3")))
    );
    assert!(
        of(Method::Tsvd)
            .pictures
            .iter()
            .flatten()
            .all(Option::is_none)
    );
    assert!(
        of(Method::Joint)
            .pictures
            .iter()
            .flatten()
            .all(Option::is_some)
    );
}

/// What is too much is left out by count: noises first, then steps, then everything; and it is
/// said.
#[test]
fn limits_leave_out_what_is_too_much() {
    let bench = bench();
    let with = |work: f64, values: usize| {
        bench.gallery(GalleryPlan {
            work,
            values,
            ..GalleryPlan::of_run(5)
        })
    };
    let steps = |g: &RunGallery| g.series.iter().map(|s| s.steps.len()).max().unwrap_or(0);
    let pictures = |g: &RunGallery| {
        g.series
            .iter()
            .map(|s| s.pictures.iter().flatten().flatten().count())
            .sum::<usize>()
    };
    let whole = with(1e12, 1_000_000);
    assert_eq!((whole.noises.len(), whole.left_out.len()), (7, 0));
    // 64 pixels, 40 spots, 16 elements: 221 184 multiplications a noise by directions.
    let fewer = with(4.5 * 221_184.0, 1_000_000);
    assert_eq!(fewer.noises, [0.0, 1e-5, 1e-3, 1e-1]);
    // `joint` is 3 × 3e5 of its own, the covariance of `joint-unbounded` 3 × 8e5.
    let of = |method| fewer.series.iter().find(|s| s.method == method).unwrap();
    let [joint, free] = [Method::Joint, Method::JointUnbounded].map(of);
    assert!(joint.pictures[1][0].is_some() && free.pictures[0][0].is_some());
    assert!(free.pictures[1][0].is_none() && free.automatic[1].is_err());
    assert!(fewer.left_out[0].contains("4 of 7") && fewer.left_out[1].contains("joint-unbounded"));
    // 16 values a picture, whatever the limit.
    for values in [16 * 7 * 30, 16 * 7 * 24, 16 * 4 * 12] {
        let small = with(1e12, values);
        assert!(
            pictures(&small) * 16 <= values,
            "{} of {values}",
            pictures(&small) * 16
        );
        assert!(steps(&small) >= 4 && !small.left_out.is_empty());
    }
    let nothing = with(1e3, 1_000_000);
    assert!(nothing.series.is_empty() && nothing.left_out[0].contains("no gallery"));
}
