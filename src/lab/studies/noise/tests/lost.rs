//! From which noise on a modulation is lost.

use super::*;

/// Least squares without bounds is unbiased: its mean raw MTF does not fall, but the denominator's
/// spread grows until no mean is spoken of.
#[test]
fn a_mean_of_wild_ratios_is_not_spoken_of() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![4],
        elements: vec![4],
        methods: vec![Method::JointUnbounded],
        levels: vec![1e-7, 0.1, 1.0],
        seeds: 20,
        ..plan
    };
    let study = run(&scene, &plan);
    let curve = &study.curves[0];
    let [quiet, loud] = [0, 2].map(|i: usize| curve.points[i].denominator_spread.unwrap());
    assert!(quiet < 1e-3 && loud > 0.1, "{quiet} {loud}");
    assert_eq!(curve.lost_raw[1], Lost::Unknown, "{curve:?}");
    let lost = curve.lost_normalized[1];
    assert_eq!(lost, Lost::Between([1e-7, 0.1]), "{curve:?}");
}

/// Draws that stray widely around a true mean of 1, at a well determined denominator: that their
/// mean happens to lie at 0.2 is no loss.
#[test]
fn a_mean_that_strays_has_not_fallen() {
    let (_, plan) = small();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![4],
        methods: vec![Method::JointUnbounded],
        levels: vec![0.1, 1.0],
        seeds: 4,
        ..plan
    };
    let trial = |level, seed, mtf| Trial {
        picture: Picture::Board(2),
        elements: 4,
        method: Method::JointUnbounded,
        level,
        seed,
        outcome: Ok(Measures {
            mtf_raw: Some(mtf),
            light_plus_dark: Some(1.0),
            mtf_normalized: Some(mtf / 10.0),
            correlation: None,
            rmse: None,
        }),
    };
    let of = |quiet: f64, loud: [f64; 4], truth: &[f64]| {
        let quiet = (0..4).map(|k| trial(0.1, plan.first_seed + k, quiet));
        let loud = (0..4).map(|k| trial(1.0, plan.first_seed + k, loud[k as usize]));
        NoiseCurve::of(
            &plan,
            (Picture::Board(2), 4),
            Method::JointUnbounded,
            (&quiet.chain(loud).collect::<Vec<_>>(), &[None, None]),
            truth,
        )
    };
    let curve = |loud| of(1.0, loud, &[0.0, 1.0]);
    assert_eq!(curve([9.0, -9.0, 5.0, -4.2]).lost_raw, [Lost::Unknown; 2]);
    let fallen = curve([0.25, 0.15, 0.2, 0.2]);
    // A picture of albedo 0.25 and 0.75 has a raw MTF of ½: relative to that a loss of 0.01 grows
    // to 0.81, and is 0.1 at ln 10/ln 81 of the way.
    let grey = of(0.495, [0.1, 0.09, 0.095, 0.095], &[0.25, 0.75]);
    assert_eq!(grey.mtf_of_truth, [0.5, 1.0]);
    let Lost::At(level) = grey.lost_raw[0] else {
        panic!("{grey:?}")
    };
    assert!(
        (libm::log10(level / 0.1) - libm::log(10.0) / libm::log(81.0)).abs() < 1e-12,
        "{level}"
    );
    // A mean of 1 counts as one that lost a hundredth of 0.8: a loss of 0.1 is 12.5 times that, a
    // power of 2 over the decade.
    let Lost::At(level) = fallen.lost_raw[0] else {
        panic!("{fallen:?}")
    };
    assert!((level / 0.1 / 12.5f64.sqrt() - 1.0).abs() < 1e-12);
    assert_eq!(fallen.lost_normalized, [Lost::Before; 2]);
    // The mean 0.2 is known to √(0.005/3/4): 3.182 of that, Student's t of 3 degrees of freedom,
    // lower and higher, by hand.
    let off = 3.182_446_305 * (0.005f64 / 12.0).sqrt();
    let [from, to] = fallen.held_within.unwrap().map(Option::unwrap);
    for (held, mean) in [(from, 0.2 - off), (to, 0.2 + off)] {
        let want = 0.1 * (10.0 / (1.0 - mean)).sqrt();
        assert!((held.level / want - 1.0).abs() < 1e-4, "{held:?} {want}");
    }
    // Where the mean strays nothing is known, and of the level before it falls no lower.
    let strays = curve([9.0, -9.0, 5.0, -4.2]).held_within.unwrap();
    assert_eq!(strays.map(|held| held.unwrap().level), [0.1; 2]);
}

/// What one draw is like no method is said to hold or to lose.
#[test]
fn of_one_draw_nothing_is_said_to_be_held() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![4],
        methods: vec![Method::Pinv],
        seeds: 1,
        ..plan
    };
    let sentence = run(&scene, &plan).describe().sentence;
    let said =
        "no method is known to reach it, as one draw tells no mean (the published pinv: unknown)";
    assert!(sentence.contains(said), "{sentence}");
}

/// With photons the modulation rises: a loss of 0.4 at 1e4 is one of 0.025 at 1e5, so from their
/// geometric mean on it is 0.1 or less, whatever it is again with very few.
#[test]
fn more_photons_are_less_noise() {
    let (_, plan) = small();
    let mut plan = NoisePlan {
        axis: NoiseAxis::Photons,
        methods: vec![Method::Joint],
        levels: vec![1e5, 1.0, 1e4, 1e3, 1e8],
        seeds: 2,
        ..plan
    };
    plan.levels.sort_by(|a, b| plan.axis.quiet_first(*a, *b));
    let mtf = |level: f64| match level {
        1e5 => 0.975,
        1e4 => 0.6,
        1e3 => 0.375,
        _ => 1.0,
    };
    let draws = plan
        .levels
        .iter()
        .flat_map(|level| [(level, 0), (level, 1)]);
    let trials = draws.map(|(level, draw)| Trial {
        picture: Picture::Board(2),
        elements: 4,
        method: Method::Joint,
        level: *level,
        seed: plan.first_seed + draw,
        outcome: Ok(Measures {
            mtf_raw: Some(mtf(*level)),
            light_plus_dark: Some(1.0),
            mtf_normalized: Some(0.0),
            correlation: None,
            rmse: Some(1.0),
        }),
    });
    let trials: Vec<Trial> = trials.collect();
    let found = NoiseCurve::of(
        &plan,
        (Picture::Board(2), 4),
        Method::Joint,
        (&trials, &[None; 5]),
        &[0.0, 1.0],
    );
    let [Lost::At(high), Lost::At(low)] = found.lost_raw else {
        panic!("{found:?}")
    };
    // A loss of 0.5 lies half way from 0.4 at 1e4 to 0.625 at 1e3.
    let half = 10f64.sqrt();
    assert!((high / (1e4 * half) - 1.0).abs() < 1e-12);
    assert!((low / (1e3 * half) - 1.0).abs() < 1e-12);
    assert_eq!(found.held.unwrap().level, high);
    assert_eq!(found.lost_normalized, [Lost::Before; 2]);
}
