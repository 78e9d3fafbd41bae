use super::*;
use crate::lab::comparison::validation::Integration;
use crate::model::Kernel;

/// The curve of draws that all have these raw and normalized MTF, at two levels.
fn alike(seeds: u64, [raw, normalized]: [f64; 2]) -> NoiseCurve {
    let plan = NoisePlan {
        boards: vec![2],
        elements: vec![4],
        methods: vec![Method::Pinv],
        kernel: Kernel::Physical,
        integration: Integration::Centres,
        axis: NoiseAxis::Relative,
        levels: vec![0.1, 1.0],
        seeds,
        first_seed: 0,
    };
    let trial = |k: u64| Trial {
        picture: Picture::Board(2),
        elements: 4,
        method: Method::Pinv,
        level: plan.levels[(k / seeds) as usize],
        seed: k % seeds,
        outcome: Ok(Measures {
            mtf_raw: Some(raw),
            light_plus_dark: Some(1.0),
            mtf_normalized: Some(normalized),
            correlation: None,
            rmse: None,
        }),
    };
    let trials: Vec<Trial> = (0..2 * seeds).map(trial).collect();
    let found = (&trials[..], &[None, None][..]);
    let object = (Picture::Board(2), 4);
    NoiseCurve::of(&plan, object, Method::Pinv, found, &[0.0, 1.0])
}

/// One draw tells no mean, and a mean that is more than a tenth above that of the picture is that
/// of negative values: neither keeps a modulation, though none is below a limit.
#[test]
fn one_draw_and_a_mean_above_the_pictures_own_keep_nothing() {
    let kept = alike(2, [1.05, 0.95]);
    assert_eq!(kept.lost_raw, [Lost::Never; 2]);
    let wild = alike(2, [1.2, 0.95]);
    assert_eq!(wild.lost_raw, [Lost::Unknown; 2]);
    assert_eq!(wild.lost_normalized, [Lost::Never; 2]);
    assert_eq!(wild.held, None);
    let one = alike(1, [1.0, 0.95]);
    let lost = [one.lost_raw, one.lost_normalized];
    assert_eq!(lost, [[Lost::Unknown; 2]; 2]);
    assert_eq!(one.held, None);
}

#[test]
fn the_level_is_interpolated_in_its_logarithm() {
    let curve = [(1e-4, Some(0.975)), (1e-3, Some(0.6)), (1e-2, Some(0.375))];
    let lost = |curve: &[_], limit| lost(curve, limit, &NoiseAxis::Relative);
    let at = |limit| match lost(&curve, limit) {
        Lost::At(level) => level,
        other => panic!("{other:?}"),
    };
    // From a loss of 0.025 to one of 0.4, fourfold twice, 0.1 is half way: the geometric mean of
    // 1e-4 and 1e-3. From 0.4 to 0.625 half way is 0.5.
    let half = 10f64.sqrt();
    assert!((at(0.9) / (1e-4 * half) - 1.0).abs() < 1e-12);
    assert!((at(0.5) / (1e-3 * half) - 1.0).abs() < 1e-12);
    assert_eq!(lost(&curve, 0.3), Lost::Never);
    assert_eq!(lost(&curve[1..], 0.9), Lost::Before);
    assert_eq!(lost(&curve[..1], 0.9), Lost::Never);
    assert_eq!(lost(&[], 0.9), Lost::Unknown);
    // An axis on which quiet is a large number.
    let photons = [(1e6, Some(0.75)), (1e5, Some(0.0))];
    let Lost::At(level) = lost(&photons, 0.5) else {
        panic!("{:?}", lost(&photons, 0.5))
    };
    assert!((level / (1e5 * half) - 1.0).abs() < 1e-12);
    let gap = [(1e-4, Some(1.0)), (1e-3, None), (1e-2, Some(0.1))];
    assert_eq!(lost(&gap, 0.5), Lost::Unknown);
}

/// Over four decades nothing says where between them the mean falls.
#[test]
fn levels_far_apart_are_not_interpolated() {
    let axis = &NoiseAxis::Relative;
    let far = [(1e-6, Some(1.0)), (1e-2, Some(0.2))];
    assert_eq!(lost(&far, 0.9, axis), Lost::Between([1e-6, 1e-2]));
    let quiet = held(&far, 0.9, axis).unwrap();
    assert_eq!((quiet.level, quiet.reach), (1e-6, Reach::AtLeast));
    let bits = [(12.0, Some(1.0)), (8.0, Some(0.6))];
    let between = lost(&bits, 0.8, &NoiseAxis::Bits);
    assert_eq!(between, Lost::Between([12.0, 8.0]));
}

/// Bits run from many to few and by differences: half way from 11 to 9 the loss has grown half way
/// in its logarithm, from 0.1 to 0.4.
#[test]
fn bits_are_interpolated_in_their_number() {
    let bits = [
        (16.0, Some(1.0)),
        (11.0, Some(0.9)),
        (9.0, Some(0.6)),
        (4.0, Some(0.95)),
    ];
    let (limit, axis) = (0.8, &NoiseAxis::Bits);
    let Lost::At(level) = lost(&bits, limit, axis) else {
        panic!("{:?}", lost(&bits, limit, axis))
    };
    // That the mean is above the limit again at 4 bits is no matter: from 10 on it stays there.
    assert!((level - 10.0).abs() < 1e-12, "{level}");
    assert_eq!(held(&bits, limit, axis).unwrap().reach, Reach::Falls);
}

#[test]
fn a_limit_is_held_up_to_what_is_known() {
    let held = |curve: &[_]| held(curve, 0.9, &NoiseAxis::Relative);
    let at_least = |level| {
        let reach = Reach::AtLeast;
        Some(Held { level, reach })
    };
    let high = (1e-4, Some(1.0));
    assert_eq!(held(&[high, (1e-2, Some(0.9))]), at_least(1e-2));
    assert_eq!(held(&[high, (1e-2, None)]), at_least(1e-4));
    assert_eq!(held(&[(1e-4, Some(0.8)), (1e-2, Some(1.0))]), None);
    assert_eq!(held(&[(1e-4, None)]), None);
}
