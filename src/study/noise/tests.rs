use super::*;

fn small() -> (Scene, NoisePlan) {
    let text = Scene::load("bench").unwrap().text;
    let text = text.replace("pixels = [16, 16]", "pixels = [4, 4]");
    let scene = Scene::from_toml("small", &text.replace("per_side = 30", "per_side = 6")).unwrap();
    let plan = NoisePlan {
        boards: vec![2, 4],
        elements: vec![2, 4],
        methods: vec![Method::Pinv, Method::Tikhonov, Method::Joint],
        kernel: Kernel::Physical,
        axis: NoiseAxis::Relative,
        levels: vec![1e-6, 1e-3, 1.0],
        seeds: 5,
        first_seed: 3,
    };
    (scene, plan)
}

fn run(
    scene: &Scene,
    plan: &NoisePlan,
    known: &[Trial],
    most: usize,
) -> (Option<NoiseStudy>, Vec<Trial>) {
    let stop = AtomicBool::new(false);
    let mut kept = Vec::new();
    let mut keep = |new: &[Trial]| {
        kept.extend_from_slice(new);
        if kept.len() >= most {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let study = noise(scene, plan, known, &stop, &mut keep).unwrap();
    (study, kept)
}

/// Boards of 4 checks have no place on 2 elements: (2, 2), (2, 4), (4, 4).
#[test]
fn trials_do_not_depend_on_threads_and_going_on_gives_what_running_through_gives() {
    let (scene, plan) = small();
    assert_eq!(plan.trials(), 3 * 3 * 5 * 3);
    let pool = |n| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .unwrap()
    };
    let (through, all) = pool(1).install(|| run(&scene, &plan, &[], usize::MAX));
    assert_eq!(all.len(), plan.trials());
    let (none, part) = pool(3).install(|| run(&scene, &plan, &[], 10));
    assert!(none.is_none() && part.len() >= 10 && part.len() < all.len());
    let (resumed, rest) = pool(3).install(|| run(&scene, &plan, &part, usize::MAX));
    assert_eq!(rest.len(), all.len() - part.len());
    let text = |trials: &[Trial]| write_ledger("", trials);
    assert_eq!(text(&all), text(&[part, rest].concat()));
    let json = |study: &Option<NoiseStudy>| serde_json::to_string(study.as_ref().unwrap()).unwrap();
    assert_eq!(json(&through), json(&resumed));
}

/// A level, a seed or a method more: what is there is kept, and only the new is computed.
#[test]
fn a_larger_plan_goes_on_from_a_smaller_one() {
    let (scene, plan) = small();
    let less = NoisePlan {
        levels: vec![1e-6, 1.0],
        seeds: 3,
        methods: vec![Method::Pinv],
        ..plan.clone()
    };
    let (_, part) = run(&scene, &less, &[], usize::MAX);
    let (_, rest) = run(&scene, &plan, &part, usize::MAX);
    assert_eq!(part.len() + rest.len(), plan.trials());
    // And the smaller plan finds its own curves among the larger one's trials.
    let (straight, _) = run(&scene, &less, &[], usize::MAX);
    let (found, none) = run(&scene, &less, &[part, rest].concat(), usize::MAX);
    assert!(none.is_empty());
    let json = |study: Option<NoiseStudy>| serde_json::to_string(&study.unwrap()).unwrap();
    assert_eq!(json(found), json(straight));
}

/// The unbounded pseudo-inverse is linear and unbiased here (2 × 2 elements have full rank), so its error grows in proportion to the noise, draw by draw.
#[test]
fn the_error_of_a_linear_method_is_proportional_to_the_noise() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![2],
        methods: vec![Method::Pinv],
        levels: vec![1e-5, 1e-3],
        ..plan
    };
    let (study, _) = run(&scene, &plan, &[], usize::MAX);
    let points = &study.unwrap().curves[0].points;
    let [quiet, loud] = [0, 1].map(|i: usize| points[i].rmse.unwrap());
    assert!(
        (loud.mean / quiet.mean / 100.0 - 1.0).abs() < 1e-6,
        "{quiet:?} {loud:?}"
    );
    assert!(quiet.mean > 0.0 && quiet.draws == 5);
}

#[test]
fn a_plan_without_object_is_refused() {
    let (scene, plan) = small();
    let plan = NoisePlan {
        boards: vec![3],
        ..plan
    };
    let stop = AtomicBool::new(false);
    let refused = noise(
        &scene,
        &plan,
        &[],
        &stop,
        &mut |_| ControlFlow::Continue(()),
    );
    assert!(matches!(refused, Err(NoiseError::NoObject)));
}

/// Least squares without bounds is unbiased: its mean raw MTF does not fall, but the denominator's spread grows until no mean is spoken of.
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
    let (study, _) = run(&scene, &plan, &[], usize::MAX);
    let curve = &study.unwrap().curves[0];
    let [quiet, loud] = [0, 2].map(|i: usize| curve.points[i].denominator_spread.unwrap());
    assert!(quiet < 1e-3 && loud > 0.1, "{quiet} {loud}");
    assert_eq!(curve.lost_raw[1], Lost::Unknown, "{curve:?}");
    assert!(matches!(curve.lost_normalized[1], Lost::At(_)), "{curve:?}");
}

/// Draws that stray widely around a true mean of 1, at a well determined denominator: that their mean happens to lie at 0.2 is no loss.
#[test]
fn a_mean_that_strays_has_not_fallen() {
    let (_, plan) = small();
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![4],
        methods: vec![Method::JointUnbounded],
        levels: vec![1e-3, 1.0],
        seeds: 4,
        ..plan
    };
    let trial = |level, seed, mtf| Trial {
        board: 2,
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
    let curve = |loud: [f64; 4]| {
        let quiet = (0..4).map(|k| trial(1e-3, plan.first_seed + k, 1.0));
        let loud = (0..4).map(|k| trial(1.0, plan.first_seed + k, loud[k as usize]));
        curve(
            &plan,
            [2, 4],
            Method::JointUnbounded,
            &quiet.chain(loud).collect::<Vec<_>>(),
        )
    };
    assert_eq!(curve([9.0, -9.0, 5.0, -4.2]).lost_raw, [Lost::Unknown; 2]);
    let fallen = curve([0.25, 0.15, 0.2, 0.2]);
    // From 1 to 0.2 over three decades: 0.9 lies an eighth of the way.
    let Lost::At(level) = fallen.lost_raw[0] else {
        panic!("{fallen:?}")
    };
    assert!((level / 1e-3 / libm::exp10(3.0 / 8.0) - 1.0).abs() < 1e-12);
    assert_eq!(fallen.lost_normalized, [Lost::Before; 2]);
}
