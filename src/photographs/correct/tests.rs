use super::*;
use crate::photographs::highest::Highest;
use crate::photographs::plane::Plane;

fn shot(light: &[f64]) -> Averaged {
    Averaged::of(Plane {
        size: [light.len(), 1],
        light: light.to_vec(),
        rounding: vec![1.0 / 12.0; light.len()],
        saturated: light.iter().map(|x| *x >= 1000.0).collect(),
        share: 1.0,
        zeros: 0,
        highest: Highest::default(),
    })
}

/// (s − d)/(F·t) and its variance by hand: gain 0.5, read noise 3 counts.
#[test]
fn flux_and_variance_are_those_of_the_law() {
    let noise = Some(CameraNoise::new(0.5, 3.0).unwrap());
    let (dark, flat_dark) = (shot(&[10.0, 20.0, 10.0]), shot(&[5.0; 3]));
    let flat = Flat::new(&shot(&[105.0, 305.0, 5.0]), Some(&flat_dark), noise, None).unwrap();
    assert_eq!(flat.unusable, [false, false, true]);
    // 100, 300 and 0: the mean is 400/3.
    assert!((flat.level[0] - 0.75).abs() < 1e-12 && (flat.level[1] - 2.25).abs() < 1e-12);
    let correction = Correction {
        dark: Some(&dark),
        shortest: Some(&dark),
        flat: Some(&flat),
        noise,
        exposure: 2.0,
    };
    let found = correction.apply("a", &shot(&[70.0, 110.0, 90.0])).unwrap();
    for (found, due) in found.flux.iter().zip([60.0 / 1.5, 90.0 / 4.5, 0.0]) {
        assert!((found - due).abs() < 1e-12, "{found} {due}");
    }
    let lsb = 1.0 / 12.0;
    let own = 0.5 * 60.0 + 9.0 + lsb;
    let of_flat = (0.5 * 100.0 + 9.0 + lsb + 9.0 + lsb) / 1e4;
    let due = (own + 9.0 + lsb) / 2.25 + of_flat * 1600.0;
    assert!((found.variance.unwrap()[0] / due - 1.0).abs() < 1e-9);
    // The part of the dark frame, mean over the two pixels that the flat field serves.
    let of_other_flat = (0.5 * 300.0 + 9.0 + lsb + 9.0 + lsb) / 9e4;
    let other = (0.5 * 90.0 + 9.0 + lsb + 9.0 + lsb) / 20.25 + of_other_flat * 400.0;
    let of_flats = 0.5 * (of_flat * 1600.0 / due + of_other_flat * 400.0 / other);
    assert!(
        (found.of_flat / of_flats - 1.0).abs() < 1e-9,
        "{}",
        found.of_flat
    );
    let common = 0.5 * (9.0 + lsb) * (1.0 / 2.25 / due + 1.0 / 20.25 / other);
    assert!(
        (found.common / common - 1.0).abs() < 1e-9,
        "{}",
        found.common
    );
}

/// A flat field by its definition, cos⁴θ of the direction of each pixel, dimmed by 30 % beyond
/// a third of the diagonal (vignetting): with the camera matrix it is 1 on the axis, which lies
/// far off the middle; where the axis is outside it is what the matrix says.
#[test]
fn a_flat_field_is_1_on_the_axis() {
    let size = [60usize, 40];
    let of = |[cx, cy]: [f64; 2], dimmed: f64| {
        let [fx, fy] = [55.0, 50.0];
        let lens = Lens {
            fx,
            fy,
            cx,
            cy,
            k1: 0.0,
            k2: 0.0,
            p1: 0.0,
            p2: 0.0,
            k3: 0.0,
        };
        let light = |k: usize| {
            let off = [(k % size[0]) as f64 - cx, (k / size[0]) as f64 - cy];
            let tan2 = (off[0] / fx).powi(2) + (off[1] / fy).powi(2);
            let far = libm::hypot(off[0], off[1]) > libm::hypot(60.0, 40.0) / 3.0;
            700.0 * (1.0 + tan2).powi(-2) * if far { dimmed } else { 1.0 }
        };
        let mut field = shot(&(0..2400).map(light).collect::<Vec<_>>());
        field.size = size;
        let found = Flat::new(&field, None, None, Some(&lens)).unwrap();
        (0..2400).for_each(|k| {
            let due = light(k) / 700.0;
            assert!(
                (found.level[k] / due - 1.0).abs() < 1e-12,
                "{k}: {}",
                found.level[k]
            );
        });
    };
    of([14.0, 30.0], 0.7);
    of([-30.0, 70.0], 1.0);
}

/// Dark frames of 0.13 counts of noise, whose mean over offsets from 0 to 1 is off by rounding:
/// the root mean square of E\[round(o + 0.13 N)\] − o by the normal distribution. Offsets that
/// differ from pixel to pixel are rounded by chance, and so is what noise moves.
#[test]
fn rounding_that_all_pixels_share_is_told() {
    let steps = 1000;
    let off = |k: usize| {
        let o = (k as f64 + 0.5) / f64::from(steps) - 0.5;
        // Of o + 0.13 N above ½ and below −½, the next ones being 8 σ away.
        let above = |z: f64| 0.5 * libm::erfc(z / std::f64::consts::SQRT_2);
        above((0.5 - o) / 0.13) - above((0.5 + o) / 0.13) - o
    };
    let due = (0..steps as usize).map(|k| off(k) * off(k)).sum::<f64>() / f64::from(steps);
    let of = |dark: &[f64], read: f64| {
        let dark = shot(dark);
        let correction = Correction {
            dark: Some(&dark),
            shortest: Some(&dark),
            flat: None,
            noise: Some(CameraNoise::new(0.5, read).unwrap()),
            exposure: 2.0,
        };
        let light = shot(&vec![70.0; dark.light.len()]);
        correction.apply("a", &light).unwrap().rounded
    };
    let alike = of(&[1.0, 1.0, 1.1, 1.0], 0.13);
    assert!(
        (alike / (0.5 * due.sqrt()) - 1.0).abs() < 1e-3,
        "{alike} {due}"
    );
    assert_eq!(of(&[1.0, 4.0, 2.0, 1.0], 0.13), 0.0);
    assert!(of(&[1.0; 4], 1.0) < 1e-3 * alike);
}

/// Var (a + b + c)/3 = (Var a + Var b + Var c)/9: by hand from 30, 60 and 90 counts of gain 0.5
/// and read noise 3 counts, and 0 counts in the dark.
#[test]
fn the_mean_of_channels_has_their_share_of_the_variance() {
    let noise = Some(CameraNoise::new(0.5, 3.0).unwrap());
    let of = |light: f64| {
        let mut mean = shot(&[light]);
        (mean.share, mean.rounding) = (1.0 / 3.0, vec![0.0]);
        mean
    };
    let (dark, mean) = (of(10.0), of(70.0));
    let correction = Correction {
        dark: Some(&dark),
        shortest: Some(&dark),
        flat: None,
        noise,
        exposure: 1.0,
    };
    let found = correction.apply("a", &mean).unwrap().variance.unwrap()[0];
    let due = ((0.5 * 30.0 + 9.0) + (0.5 * 60.0 + 9.0) + (0.5 * 90.0 + 9.0) + 3.0 * 9.0) / 9.0;
    assert!((found / due - 1.0).abs() < 1e-12, "{found} {due}");
}

/// By hand, gain 0.5 and read noise 3 counts: 60 counts of light above 200 of a dark current
/// that the shortest dark frame, of 10 counts, has none of.
#[test]
fn a_dark_current_has_noise_of_its_own() {
    let [shortest, dark, lit] = [10.0, 210.0, 270.0].map(|light| {
        let mut mean = shot(&[light]);
        mean.rounding = vec![0.0];
        mean
    });
    let correction = Correction {
        dark: Some(&dark),
        shortest: Some(&shortest),
        flat: None,
        noise: Some(CameraNoise::new(0.5, 3.0).unwrap()),
        exposure: 1.0,
    };
    let found = correction.apply("a", &lit).unwrap();
    let due = (0.5 * 260.0 + 9.0) + (0.5 * 200.0 + 9.0);
    let variance = found.variance.unwrap()[0];
    assert_eq!(found.flux[0], 60.0);
    assert!((variance / due - 1.0).abs() < 1e-12, "{variance} {due}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let dark = shot(&[1.0; 2]);
    let plain = Correction {
        dark: Some(&dark),
        shortest: Some(&dark),
        flat: None,
        noise: None,
        exposure: 1.0,
    };
    let error = plain.apply("a", &shot(&[1.0; 3])).unwrap_err().to_string();
    assert!(error.contains("a dark frame has 2 × 1"), "{error}");
    let never = Correction {
        dark: None,
        shortest: None,
        exposure: 0.0,
        ..plain
    };
    assert!(never.apply("a", &shot(&[1.0])).is_err());
    assert!(Flat::new(&dark, Some(&dark), None, None).is_err());
}
