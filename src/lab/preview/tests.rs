use std::sync::atomic::AtomicBool;

use super::light::Light;
use super::model::{Model, is_outer_wall};
use super::overlay::{self, Mark, Overlay};
use super::viewpoint::Lens;
use super::*;
use crate::geometry::{DVec3, Ray};
use crate::num::stream::{Key, Sampling, Stream};
use crate::scene::{Role, Scene};
use crate::transport::{Control, Stopped};

fn viewpoint(from: DVec3, to: DVec3) -> Viewpoint {
    Viewpoint {
        from,
        to,
        up: DVec3::Y,
        field: 90.0,
    }
}

fn made(scene: &Scene, plan: &PreviewPlan) -> Preview {
    let control = Control::none();
    preview(scene, plan, control).unwrap()
}

/// With 90° across 200 px a point as far to the side as ahead lies on the edge; 100 px are a
/// tangent of 1.
#[test]
fn points_lie_where_perspective_puts_them() {
    let eye = DVec3::new(1.0, 2.0, 10.0);
    let lens = Lens::new(&viewpoint(eye, eye - 4.0 * DVec3::Z), [200, 100]).unwrap();
    for (offset, place) in [
        ([0.0, 0.0, -4.0], [100.0, 50.0]),
        ([4.0, 0.0, -4.0], [200.0, 50.0]),
        ([0.0, 1.0, -4.0], [100.0, 25.0]),
        ([-2.0, -2.0, -8.0], [75.0, 75.0]),
    ] {
        let point = eye + DVec3::from_array(offset);
        let got = lens.place(point);
        assert!(
            (got[0] - place[0]).abs() < 1e-9 && (got[1] - place[1]).abs() < 1e-9,
            "{got:?} {place:?}"
        );
        // The ray through that place meets the point.
        let ray = lens.ray(place);
        let along = (point - eye).dot(ray.direction);
        assert!((eye + ray.direction * along - point).length() < 1e-9);
        assert!((lens.depth(point) + offset[2]).abs() < 1e-12);
    }
}

#[test]
fn what_is_looked_at_is_in_the_middle() {
    for (from, to) in [
        ([1.0, 7.0, 3.0], [0.0, 0.5, -2.0]),
        ([-3.0, 0.1, 0.0], [4.0, 4.0, 4.0]),
    ] {
        let lens = Lens::new(&viewpoint(from.into(), to.into()), [321, 77]).unwrap();
        let [x, y] = lens.place(to.into());
        assert!(
            (x - 160.5).abs() < 1e-9 && (y - 38.5).abs() < 1e-9,
            "{x} {y}"
        );
    }
}

#[test]
fn places_that_nothing_can_be_seen_from_are_refused() {
    let good = viewpoint(DVec3::ZERO, DVec3::X);
    let refused = |v: Viewpoint, size| Lens::new(&v, size).unwrap_err();
    let at_itself = Viewpoint {
        to: DVec3::ZERO,
        ..good
    };
    assert!(matches!(
        refused(at_itself, [4, 4]),
        PreviewError::NoDirection(..)
    ));
    let up = Viewpoint {
        up: -2.0 * DVec3::X,
        ..good
    };
    assert!(matches!(refused(up, [4, 4]), PreviewError::NoUp(..)));
    for field in [0.0, -1.0, 180.0, f64::NAN] {
        assert!(matches!(
            refused(Viewpoint { field, ..good }, [4, 4]),
            PreviewError::Field(_)
        ));
    }
    for size in [[0, 4], [4, 0], [1 << 13, 1 << 13], [usize::MAX, 2]] {
        assert!(matches!(refused(good, size), PreviewError::Size(..)));
    }
}

/// White plates: towards the viewer under the open sky all three lights reach them, and no more
/// than those.
#[test]
fn light_is_that_of_sky_and_lamps() {
    let lens = Lens::new(&viewpoint(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO), [10, 10]).unwrap();
    let light = Light::beside(&lens);
    let brdf = |_| std::f64::consts::FRAC_1_PI;
    let mean = |lit: &dyn Fn(DVec3) -> bool| {
        let key = Key {
            seed: 3,
            spot: 0,
            pixel: 0,
            block: 0,
        };
        let mut stream = Stream::new(Sampling::Sobol, key);
        let value = |i| {
            stream.start(i);
            light.reflected(DVec3::Z, DVec3::Z, brdf, lit, stream.next_four())
        };
        (0..4096).map(value).sum::<f64>() / 4096.0
    };
    // A plate across the sky's axis sees as much of the bright half as of the dark one: their mean,
    // 0.33. The lamp stands at the cosine 0.75/|place|, and its disc is small. The eye sees the
    // plate straight on.
    let cosine = 0.75 / (0.55f64 * 0.55 + 0.85 * 0.85 + 0.75 * 0.75).sqrt();
    let all = 0.33 + 0.50 * cosine + 0.14;
    assert!(
        (mean(&|_| true) - all).abs() < 0.005,
        "{} {all}",
        mean(&|_| true)
    );
    assert!((mean(&|_| false) - 0.14).abs() < 1e-12);
}

#[test]
fn outer_walls_are_those_with_nothing_behind() {
    let outer = |name: &str| {
        let scene = Scene::load(name).unwrap();
        let names = scene.surfaces.iter().enumerate();
        let outer = names.filter(|(id, _)| is_outer_wall(&scene, *id));
        outer.map(|(_, s)| s.name.clone()).collect::<Vec<_>>()
    };
    assert_eq!(outer("bench"), ["wall"]);
    assert_eq!(outer("shelf"), ["wall"]);
    // The wall in between has things on both sides, and two faces.
    assert_eq!(outer("corner"), ["relay", "floor"]);
    assert_eq!(outer("card"), ["table"]);
}

/// From behind, the bench's wall is glass where the object stands behind it, and a hatched back
/// where nothing does.
#[test]
fn one_looks_through_an_outer_wall_at_what_is_behind_it() {
    let scene = Scene::load("bench").unwrap();
    let model = Model::new(&scene);
    let seen = |x: f64, y: f64| {
        let ray = Ray::new(DVec3::new(x, y, -5.0), DVec3::Z);
        model
            .look(&ray)
            .map(|s| (model.surface(s.shape).name.clone(), s.is_front, s.panes))
    };
    // The object covers x from 3 to 7, y from 8.5 to 11.35.
    assert_eq!(seen(5.0, 10.0), Some(("object".to_owned(), true, 1)));
    assert_eq!(seen(1.0, 1.0), Some(("wall".to_owned(), false, 0)));
    assert_eq!(seen(-1.0, 1.0), None);
}

#[test]
fn the_default_place_shows_object_and_wall_from_the_front() {
    // No place shows two fronts as close as those of card and table.
    for name in ["bench", "shelf", "corner"] {
        let scene = Scene::load(name).unwrap();
        let size = [96, 64];
        let viewpoint = auto_viewpoint(&scene, size, &ViewOptions::default()).unwrap();
        let (model, lens) = (Model::new(&scene), Lens::new(&viewpoint, size).unwrap());
        let mut found = [0; 2];
        for (x, y) in (0..96).flat_map(|x| (0..64).map(move |y| (x, y))) {
            let seen = model.look(&lens.ray([f64::from(x) + 0.5, f64::from(y) + 0.5]));
            match seen
                .filter(|s| s.is_front)
                .map(|s| model.surface(s.shape).role)
            {
                Some(Role::Hidden) => found[0] += 1,
                Some(Role::Relay) => found[1] += 1,
                _ => {}
            }
        }
        // A hundredth of the picture each.
        assert!(found.iter().all(|n| *n >= 61), "{name}: {found:?}");
        for corner in scene.hidden().flat_map(|(_, s)| s.shape.box_corners()) {
            let [x, y] = lens.place(corner);
            assert!(
                (0.0..=96.0).contains(&x) && (0.0..=64.0).contains(&y),
                "{name}: {x} {y}"
            );
        }
    }
}

/// A red spot is where perspective puts it, and not where something stands before it.
#[test]
fn marks_are_hidden_by_what_stands_before_them() {
    let scene = Scene::load("bench").unwrap();
    let lens = Lens::new(
        &viewpoint([5.0, 4.0, 12.0].into(), [5.0, 4.0, 0.0].into()),
        [400, 400],
    )
    .unwrap();
    let marks = Overlay::of(&scene, &lens);
    let spot = scene.laser.spots[40].target.position;
    let at = lens.place(spot);
    let grey = [0.2; 3];
    let near = marks.of_row(at[1] as usize);
    let free = over_test(&near, at, lens.depth(spot));
    assert!(free[0] > 3.0 * free[2] && free != grey, "{free:?}");
    assert_eq!(over_test(&near, at, 0.9 * lens.depth(spot)), grey);
}

fn over_test(marks: &[&Mark], at: [f64; 2], depth: f64) -> Colour {
    overlay::over(marks, at, depth, [0.2; 3])
}

#[test]
fn threads_do_not_change_a_bit() {
    let scene = Scene::load("shelf").unwrap();
    let size = [24, 16];
    let plan = PreviewPlan {
        viewpoint: auto_viewpoint(&scene, size, &ViewOptions::default()).unwrap(),
        size,
        samples: 8,
        overlay: true,
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| made(&scene, &plan))
    };
    let one = on(1);
    assert_eq!(one, on(3));
    assert!(
        one.colours
            .iter()
            .flatten()
            .all(|c| c.is_finite() && *c >= 0.0)
    );
}

#[test]
fn a_stop_is_heeded() {
    let scene = Scene::load("bench").unwrap();
    let plan = PreviewPlan {
        viewpoint: viewpoint([5.0, 4.0, 12.0].into(), [5.0, 4.0, 0.0].into()),
        size: [4, 4],
        samples: 1,
        overlay: false,
    };
    let stop = AtomicBool::new(true);
    let control = Control {
        progress: &|_| (),
        stop: &stop,
    };
    assert_eq!(preview(&scene, &plan, control), Err(Stopped.into()));
}
