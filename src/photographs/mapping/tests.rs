use super::*;
use crate::num::stream::{Key, Sampling, Stream};

/// A pinhole at `eye` that looks along `axes[2]`, right and down along the others: pixel of a point
/// of the plane z = 0, by projection alone.
fn projected(point: [f64; 2], lens: &Lens) -> [f64; 2] {
    let eye = [0.3, -0.2, 2.5];
    // Turned by 0.3 about y, then looking towards −z; v runs down.
    let (s, c) = (libm::sin(0.3), libm::cos(0.3));
    let to = [point[0] - eye[0], point[1] - eye[1], -eye[2]];
    let turned = [c * to[0] + s * to[2], -to[1], -(-s * to[0] + c * to[2])];
    let (at, _) = lens.distorted([turned[0] / turned[2], turned[1] / turned[2]]);
    lens.pixel(at)
}

const LENS: Lens = Lens {
    fx: 700.0,
    fy: 705.0,
    cx: 320.5,
    cy: 238.0,
    k1: -0.18,
    k2: 0.04,
    p1: 6e-4,
    p2: -9e-4,
    k3: 0.0,
};

fn marks(lens: &Lens, n: usize) -> Vec<Mark> {
    let places = (0..n).flat_map(|i| (0..n).map(move |j| [i, j]));
    places
        .map(|ij| ij.map(|k| k as f64 / (n - 1) as f64))
        .map(|wall| Mark {
            pixel: projected(wall, lens),
            wall,
        })
        .collect()
}

/// Exact marks of a camera with perspective and distortion give its mapping at every other point,
/// there and back.
#[test]
fn exact_marks_give_the_camera() {
    let plain = Lens {
        k1: 0.0,
        k2: 0.0,
        p1: 0.0,
        p2: 0.0,
        ..LENS
    };
    for (lens, known, n) in [
        (LENS, Some(LENS), 2),
        (LENS, Some(LENS), 5),
        (plain, None, 2),
        (plain, None, 3),
    ] {
        let fitted = Mapping::from_marks(&marks(&lens, n), known).unwrap();
        assert!(fitted.rms < 1e-8, "{}", fitted.rms);
        for wall in [[0.1, 0.9], [0.5, 0.5], [0.83, 0.21], [-0.1, 1.1]] {
            let due = projected(wall, &lens);
            let found = fitted.mapping.pixel(wall).unwrap();
            assert!((found[0] - due[0]).abs() + (found[1] - due[1]).abs() < 1e-7);
            let (back, area) = fitted.mapping.wall(due).unwrap();
            assert!((back[0] - wall[0]).abs() + (back[1] - wall[1]).abs() < 1e-9);
            // The area by differences of the projection.
            let h = 1e-5;
            let corner = |a: f64, b: f64| projected([wall[0] + a, wall[1] + b], &lens);
            let [p, q] = [
                [corner(h, 0.0), corner(-h, 0.0)],
                [corner(0.0, h), corner(0.0, -h)],
            ]
            .map(|[m, l]| [(m[0] - l[0]) / (2.0 * h), (m[1] - l[1]) / (2.0 * h)]);
            let slope = (p[0] * q[1] - p[1] * q[0]).abs();
            assert!((area * slope - 1.0).abs() < 1e-6, "{area} {slope}");
        }
    }
}

/// Marks that are off by 0.3 px along each axis: that error comes back from their residuals, and
/// the mapping is off by less than a mark.
#[test]
fn the_error_of_marks_is_found() {
    let key = Key {
        seed: 3,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    let mut marks = marks(&LENS, 8);
    for mark in &mut marks {
        mark.pixel = mark.pixel.map(|x| x + 0.3 * stream.normal());
    }
    let fitted = Mapping::from_marks(&marks, Some(LENS)).unwrap();
    // 120 degrees of freedom: σ is known to 6.5 %.
    let error = fitted.mark_error.unwrap();
    assert!((error / 0.3 - 1.0).abs() < 4.0 * 0.065, "{error}");
    let at = fitted.mapping.pixel([0.5, 0.5]).unwrap();
    let due = projected([0.5, 0.5], &LENS);
    assert!(libm::hypot(at[0] - due[0], at[1] - due[1]) < 0.3);
    // Least squares: no shift of all marks together is left.
    let left: f64 = marks
        .iter()
        .map(|m| fitted.mapping.pixel(m.wall).unwrap()[0] - m.pixel[0])
        .sum();
    assert!(left.abs() < 0.05, "{left}");
}

#[test]
fn marks_on_a_line_are_refused() {
    let line: Vec<Mark> = (0..5)
        .map(|k| Mark {
            pixel: [10.0 * f64::from(k), 5.0 * f64::from(k)],
            wall: [0.2 * f64::from(k), 0.1],
        })
        .collect();
    for marks in [&line[..], &line[..3]] {
        let error = Mapping::from_marks(marks, None).unwrap_err().to_string();
        assert!(
            error.contains("no mapping") && error.contains("cure: "),
            "{error}"
        );
    }
    // Three of four on a line.
    let mut three = marks(&LENS, 2);
    three[3] = Mark {
        pixel: [0, 1].map(|k| 0.5 * (three[0].pixel[k] + three[1].pixel[k])),
        wall: [0, 1].map(|k| 0.5 * (three[0].wall[k] + three[1].wall[k])),
    };
    assert!(Mapping::from_marks(&three, None).is_err());
}

/// The upright crop: the view's lower left corner is the lower left corner of the rectangle.
#[test]
fn an_upright_crop_is_upright() {
    let mapping = Mapping::upright([10.0, 20.0], [100.0, 50.0]);
    assert_eq!(mapping.pixel([0.0, 0.0]), Some([9.5, 69.5]));
    assert_eq!(mapping.pixel([1.0, 1.0]), Some([109.5, 19.5]));
    let (wall, area) = mapping.wall([59.5, 44.5]).unwrap();
    assert_eq!(wall, [0.5, 0.5]);
    assert!((area * 5000.0 - 1.0).abs() < 1e-15);
}
