use super::*;
use crate::num::named::Named;
use std::f64::consts::PI;

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn drawn(target: Target) -> Picture {
    target.picture(target.usual_size()).unwrap()
}

#[test]
fn every_target_is_found_by_its_name_and_has_reflectances_only() {
    for target in Target::ALL {
        assert_eq!(Target::by_name(target.name()), Some(target));
        for size in [target.usual_size(), [47, 31], [31, 47], [1, 1], [3, 200]] {
            let picture = target.picture(size).unwrap();
            assert_eq!(picture.size, size);
            assert_eq!(picture.values.len(), size[0] * size[1]);
            assert!(
                picture.values.iter().all(|v| (0.0..=1.0).contains(v)),
                "{target:?}"
            );
        }
        for size in [[0, 5], [5, 0], [4097, 1]] {
            assert!(target.picture(size).is_none());
        }
    }
    assert_eq!(Target::by_name("mona-lisa"), None);
}

#[test]
fn a_disc_covers_its_area_wherever_it_lies() {
    for (centre, radius) in [
        ([20.0, 20.0], 7.3),
        ([19.37, 21.81], 7.3),
        ([20.5, 20.1], 0.3),
        ([12.0, 30.0], 9.99),
    ] {
        let mut figure = Figure::new([40, 41]);
        figure.add(&figure::disc(centre, radius, 360));
        let covered: f64 = figure.coverage().iter().sum();
        assert!((covered - PI * radius * radius).abs() < 1e-9, "{covered}");
    }
}

/// A disc cut in half by the picture's left side, and one beyond its right side.
#[test]
fn what_lies_outside_is_cut_off() {
    let mut figure = Figure::new([20, 40]);
    figure.add(&figure::disc([0.0, 20.0], 5.0, 360));
    figure.add(&figure::disc([30.0, 20.0], 5.0, 360));
    figure.add(&figure::disc([10.0, -6.0], 5.0, 360));
    let covered: f64 = figure.coverage().iter().sum();
    assert!((covered - 12.5 * PI).abs() < 1e-9, "{covered}");
}

#[test]
fn triangles_and_holes_are_covered_exactly() {
    let mut figure = Figure::new([4, 3]);
    // Under the line y = 3 − ¾x, corner at the lower left.
    figure.add(&[[0.0, 0.0], [4.0, 3.0], [0.0, 3.0]]);
    let brute = |i: usize, j: usize| {
        let n = 400;
        let inside = |k: usize| {
            let x = i as f64 + ((k % n) as f64 + 0.5) / n as f64;
            let y = j as f64 + ((k / n) as f64 + 0.5) / n as f64;
            y > 0.75 * x
        };
        (0..n * n).filter(|k| inside(*k)).count() as f64 / (n * n) as f64
    };
    for (k, covered) in figure.coverage().into_iter().enumerate() {
        assert!(
            (covered - brute(k % 4, k / 4)).abs() < 2e-3,
            "pixel {k}: {covered}"
        );
    }
    assert!((figure.coverage().iter().sum::<f64>() - 6.0).abs() < 1e-12);
    // A square hole, given in the other sense.
    figure.cut(&[[0.25, 2.0], [0.25, 2.5], [0.75, 2.5], [0.75, 2.0]]);
    assert!((figure.coverage()[8] - 0.75).abs() < 1e-12);
}

/// The mean over pixel (i, j) of the step at x(y) = w/2 + tan(5°)(h/2 − y) is 1 where the edge
/// passes on its left, and one minus the trapezium's area x(j + ½) − i where it passes through.
#[test]
fn the_edge_is_covered_by_its_closed_form() {
    let [w, h] = [128, 128];
    let picture = drawn(Target::Edge);
    let slope = (5.0_f64).to_radians().tan();
    let at = |y: f64| 64.0 + slope * (64.0 - y);
    let mut through = 0;
    for j in 0..h {
        let [upper, lower] = [at(j as f64), at(j as f64 + 1.0)];
        for i in 0..w {
            let (value, x) = (picture.values[i + j * w], i as f64);
            if lower >= x + 1.0 {
                assert!(value.abs() < 1e-12);
            } else if upper <= x {
                assert!((value - 1.0).abs() < 1e-12);
            } else if lower >= x && upper <= x + 1.0 {
                through += 1;
                assert!((value - (1.0 - (at(j as f64 + 0.5) - x))).abs() < 1e-12);
            }
        }
    }
    assert!(through > 100, "{through}");
    assert!((mean(&picture.values) - 0.5).abs() < 1e-12);
}

#[test]
fn the_star_is_half_black() {
    for size in [[256, 256], [47, 31], [101, 77]] {
        let picture = Target::Siemens.picture(size).unwrap();
        assert!((mean(&picture.values) - 0.5).abs() < 1e-12, "{size:?}");
    }
    // Around the circle of 0.45 of the side, 36 black and 36 white sectors: 72 changes.
    let picture = drawn(Target::Siemens);
    let dark = |k: usize| {
        let a = (k as f64 + 0.5) * 2.0 * PI / 7200.0;
        let [x, y] = [128.0 + 115.0 * a.cos(), 128.0 + 115.0 * a.sin()];
        picture.values[x as usize + y as usize * 256] < 0.5
    };
    assert!(picture.values[3] == 0.5);
    let centres = (0..72).map(|k| dark(k * 100 + 50));
    assert!(centres.enumerate().all(|(k, black)| black == (k % 2 == 0)));
}

/// Sums of the areas: 24 elements of six bars of 5·w², w² = 2^(−k/3), in pixels of the usual size
/// where the first bar is 8 pixels wide.
#[test]
fn bars_cover_their_area_and_the_first_group_lies_on_pixels() {
    let picture = drawn(Target::Usaf);
    let ink: f64 = picture.values.iter().map(|v| 1.0 - v).sum();
    let bars: f64 = (0..24)
        .map(|k| 30.0 * 64.0 * (-(k as f64) / 3.0).exp2())
        .sum();
    assert!((ink - bars).abs() < 1e-8, "{ink} {bars}");
    let row = &picture.values[(16 + 20) * 208..][16..56];
    let bar = |i: usize| if (i / 8).is_multiple_of(2) { 0.0 } else { 1.0 };
    assert!(
        row.iter()
            .enumerate()
            .all(|(i, v)| (v - bar(i)).abs() < 1e-12)
    );
}

#[test]
fn the_ramp_is_linear() {
    let picture = Target::Ramp.picture([4, 2]).unwrap();
    assert_eq!(
        picture.values,
        [0.125, 0.375, 0.625, 0.875, 0.125, 0.375, 0.625, 0.875]
    );
}

/// Turned by half a turn the card is itself but for the middle row, whose two pips stand upright;
/// the lying card is the upright one turned by a quarter.
#[test]
fn the_card_is_symmetric() {
    let [w, h] = [63, 95];
    let card = drawn(Target::Card);
    for (k, value) in card.values.iter().enumerate() {
        let y = k / w;
        if !(38..57).contains(&y) {
            let other = card.values[w * h - 1 - k];
            assert!(
                (value - other).abs() < 1e-9,
                "{} {y}: {value} {other}",
                k % w
            );
        }
    }
    let lying = Target::Card.picture([h, w]).unwrap();
    for (k, value) in card.values.iter().enumerate() {
        let [x, y] = [k % w, k / w];
        assert!((lying.values[y + (w - 1 - x) * h] - value).abs() < 1e-9);
    }
}

/// H and O have known areas on their grid of 5 × 5 strokes: 13 and 4π squares.
#[test]
fn letters_cover_their_area() {
    let of = |k: usize, row: usize| {
        // 40 pixels a letter in the first row of a chart of 400 × 320.
        let picture = Target::Letters.picture([400, 320]).unwrap();
        let [side, top] = [
            40.0 * 10_f64.powf(-0.1 * row as f64),
            20.0 + 40.0 * (1.0 + 0.794_328_234_7) * row as f64,
        ];
        let x = 200.0 - 4.5 * side + 2.0 * k as f64 * side;
        let inside = |i: &usize| {
            let [px, py] = [(i % 400) as f64 + 0.5, (i / 400) as f64 + 0.5];
            (x - 2.0..x + side + 2.0).contains(&px) && (top - 2.0..top + side + 2.0).contains(&py)
        };
        let ink: f64 = (0..400 * 320)
            .filter(inside)
            .map(|i| 1.0 - picture.values[i])
            .sum();
        ink / (side / 5.0).powi(2)
    };
    assert!((of(4, 0) - 4.0 * PI).abs() < 1e-6, "{}", of(4, 0));
    assert!((of(1, 1) - 13.0).abs() < 1e-6, "{}", of(1, 1));
}
