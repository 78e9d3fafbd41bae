use super::*;
use crate::lab::study::tests::{divides, small};
use crate::scene::Profile;

#[test]
#[ignore = "slow"]
fn it_divides() {
    let scene = small("bench");
    let found = divides(&ToleranceTasks::new(&scene, 0.01, 0.9));
    let there = ALL.iter().filter(|what| what.is_in(&scene)).count();
    assert_eq!(found.parameters.len(), there);
}

/// On the bench the planes meet at y = 15.5, z = 0, along x.
#[test]
fn the_hinge_of_the_bench_is_where_it_is() {
    let (point, axis) = Scene::load("bench").unwrap().hinge().unwrap();
    assert!((point.y - 15.5).abs() < 1e-12 && point.z.abs() < 1e-12);
    assert!((axis.x.abs() - 1.0).abs() < 1e-12);
}

/// Every misplacement changes Φcam in proportion to its size where it is small, and so do numbers
/// of the spots and of the wall's material.
#[test]
fn small_misplacements_act_in_proportion() {
    let bench = Scene::load("bench").unwrap();
    act_in_proportion(&bench, |what| what.is_in(&bench), 1e-3, 0.01);
    let mut wide = small("satin");
    wide.laser.profile = Profile::Disc { radius: 0.5 };
    let numbers = |what: &Misplaced| what.is_in(&wide) && !what.is_in(&bench);
    assert_eq!(ALL.iter().filter(|what| numbers(what)).count(), 3);
    act_in_proportion(&wide, numbers, 0.3, 0.02);
}

/// To so much, of misplacements by `size` and twice that.
fn act_in_proportion(scene: &Scene, of: impl Fn(&Misplaced) -> bool, size: f64, limit: f64) {
    let truth = converged(scene, Kernel::Physical, Extent::FULL)
        .unwrap()
        .phi;
    for what in ALL.iter().filter(|what| of(what)) {
        let change = |size: f64| {
            let wrong = what.apply(scene, size).unwrap();
            let phi = converged(&wrong, Kernel::Physical, Extent::FULL)
                .unwrap()
                .phi;
            (phi - &truth).norm() / truth.norm()
        };
        let (small, twice) = (change(size), change(2.0 * size));
        assert!(small > 1e-7, "{}: {small:e}", what.name);
        assert!(
            (twice / small - 2.0).abs() < limit,
            "{}: {small:e}, {twice:e}",
            what.name
        );
    }
}

/// An error that takes 2 times its size of an MTF that noise has left at 0.8 takes half of that at
/// a size of 0.25, and a tenth at 0.05; the smallest size that loses a limit is counted from none.
#[test]
fn a_loss_in_proportion_is_met_whatever_sizes_are_tried() {
    let row = |size| Misplacement {
        size,
        change: 0.0,
        after_scale: 0.0,
        mtf: Some(0.8 * (1.0 - 2.0 * size)),
    };
    let rows = [0.03, 0.1, 0.4].map(row);
    for (rows, limit, at) in [
        (&rows[..], 0.4, 0.25),
        (&rows[..], 0.72, 0.05),
        (&rows[1..], 0.72, 0.05),
    ] {
        let found = falls_through(0.8, rows, limit).unwrap();
        assert!((found / at - 1.0).abs() < 1e-12, "{limit} {found}");
    }
    assert_eq!(falls_through(0.8, &rows[..2], 0.4), None);
    assert_eq!(falls_through(0.3, &rows, 0.4), None);
}

/// With hardly any noise the right geometry recovers the board: by its elements' centres, too
/// coarse for what they send, 3 % of its modulation were lost.
#[test]
fn the_right_geometry_recovers_the_board() {
    let tasks = ToleranceTasks::new(&small("bench"), 1e-6, 0.9);
    let bench = tasks.context(Control::none()).unwrap();
    let Placed::Right(Some(mtf)) = tasks.task(&bench, 0, Control::none()).unwrap() else {
        panic!("nothing was recovered");
    };
    assert!((mtf - 1.0).abs() < 1e-3, "{mtf}");
}

/// Nothing says to which side a thing is misplaced: what it does is the worse of both, which
/// differ. A sagitta and what is by chance have no sides.
#[test]
fn the_worse_side_counts() {
    let tasks = ToleranceTasks::new(&small("bench"), 0.01, 0.9);
    let bench = tasks.context(Control::none()).unwrap();
    let at = |name: &str| ALL.iter().position(|what| what.name == name).unwrap();
    for (name, differ) in [
        ("S2 along its normal", true),
        ("wall bent (sagitta)", false),
    ] {
        let what = &ALL[at(name)];
        // The last but one size of each.
        let task = 1 + at(name) * SIZES.len() + SIZES.len() - 2;
        let Placed::Wrong(Some(found)) = tasks.task(&bench, task, Control::none()).unwrap() else {
            panic!("{name} is not misplaced");
        };
        let sides = [found.size, -found.size];
        let both = sides.map(|size| tasks.wrong(&bench, what, size).unwrap());
        let [more, less] = both.map(|side| side.map(|s| (s.change, s.mtf.unwrap())));
        let more = more.unwrap();
        let worse = match less.filter(|_| differ) {
            Some(less) => (more.0.max(less.0), more.1.min(less.1)),
            None => more,
        };
        assert_eq!((found.change, found.mtf.unwrap()), worse, "{name}");
        assert!(!differ || (less.unwrap().1 - more.1).abs() > 1e-3, "{name}");
    }
}
