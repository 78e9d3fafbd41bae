use super::super::lens::Lens;
use super::super::mapping::Mark;
use super::*;
use crate::geometry::DVec3;
use crate::num::quadrature::Rule;
use crate::scene::Scene;
use crate::scene::file::SceneFile;

/// The bench's camera with 8 × 6 pixels.
fn camera() -> Camera {
    let mut file = SceneFile::default();
    file.camera.pixels = [8, 6];
    Scene::new(&file, None).unwrap().camera
}

/// A crop of whole pixels is their sum, upside down: the photograph's first row is the view's top.
#[test]
fn a_crop_is_a_sum_of_pixels() {
    let camera = camera();
    let mapping = Mapping::upright([4.0, 2.0], [32.0, 18.0]);
    let found = Footprints::new(&camera, &mapping, [40, 20], Evenness::Same).unwrap();
    let values: Vec<f64> = (0..800)
        .map(|q| f64::from(q % 40) + 100.0 * f64::from(q / 40))
        .collect();
    let sums = found.gathered(&values);
    let variances = found.gathered_variance(&values);
    for (p, (sum, variance)) in sums.iter().zip(variances).enumerate() {
        let [i, j] = [p % 8, p / 8];
        let due: f64 = (0..4)
            .flat_map(|u| (0..3).map(move |v| [4 + 4 * i + u, 2 + 3 * (5 - j) + v]))
            .map(|[u, v]| u as f64 + 100.0 * v as f64)
            .sum();
        assert!(
            (sum - due).abs() < 1e-9 && (variance - due).abs() < 1e-9,
            "{p}: {sum} {due}"
        );
        assert_eq!(found.of(p).len(), 12);
    }
    // Shifted by a third of a pixel the weights are fractions, and still add up to the crop.
    let part = Mapping::upright([4.0 + 1.0 / 3.0, 1.5], [31.0, 17.25]);
    let part = Footprints::new(&camera, &part, [40, 20], Evenness::Same).unwrap();
    let total: f64 = part.gathered(&[1.0; 800]).iter().sum();
    assert!((total - 31.0 * 17.25).abs() < 1e-9);
    let mut marked = vec![false; 800];
    marked[4 + 4 + 40 * 19] = true;
    assert!(found.touches(1, &marked) && !found.touches(0, &marked));
}

#[test]
fn what_reaches_beyond_the_photograph_is_outside() {
    let camera = camera();
    let mapping = Mapping::upright([-4.0, 0.0], [32.0, 18.0]);
    let found = Footprints::new(&camera, &mapping, [40, 18], Evenness::Same).unwrap();
    for p in 0..48 {
        assert_eq!(found.is_outside(p), p % 8 == 0, "{p}");
    }
    let beyond = Mapping::upright([90.0, 0.0], [32.0, 18.0]);
    let error = Footprints::new(&camera, &beyond, [40, 18], Evenness::Same).unwrap_err();
    assert!(error.to_string().contains("no pixel of the scene's view"));
}

/// An evenly glowing wall, photographed by a camera that stands elsewhere, with distortion: its
/// pixels have the étendue cos⁴θ·(area of the undistorted pixel), and what is imported is that of
/// the scene's camera, ∫ h²/r⁴ dA by quadrature, also as a whole: the axis is normal to the wall.
#[test]
fn the_ratio_of_etendues_is_that_of_the_cameras() {
    let camera = camera();
    let view = &camera.view;
    let lens = Lens {
        fx: 260.0,
        fy: 260.0,
        cx: 150.0,
        cy: 100.0,
        k1: -0.15,
        k2: 0.02,
        p1: 1e-3,
        p2: -5e-4,
        k3: 0.0,
    };
    // Above the wall and aside, looking straight down with its rows along −y.
    let centre = view.corner() + view.u() * 0.4 + view.v() * 0.6;
    let distance = 1.3 * view.u().length();
    let project = |a: f64, b: f64| {
        let x = view.corner() + view.u() * a + view.v() * b - centre;
        lens.pixel(lens.distorted([x.x / distance, -x.y / distance]).0)
    };
    let marks: Vec<Mark> = (0..16)
        .map(|k| [f64::from(k % 4) / 3.0, f64::from(k / 4) / 3.0])
        .map(|wall| Mark {
            pixel: project(wall[0], wall[1]),
            wall,
        })
        .collect();
    let mapping = Mapping::from_marks(&marks, Some(lens)).unwrap().mapping;
    let size = [320, 240];
    // The counts of each pixel, from the solid angle of its four corners' directions.
    let counts: Vec<f64> = (0..size[0] * size[1])
        .map(|q| {
            let at = |du: f64, dv: f64| {
                let pixel = [(q % size[0]) as f64 + du, (q / size[0]) as f64 + dv];
                lens.undistorted(lens.normalised(pixel)).unwrap_or([0.0; 2])
            };
            let corners = [at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
            let [x, y] = at(0.0, 0.0);
            let cos2 = 1.0 / (1.0 + x * x + y * y);
            area_and_centroid(&corners).0 * cos2 * cos2
        })
        .collect();
    let found = Footprints::new(&camera, &mapping, size, Evenness::ByLens).unwrap();
    let flux = found.gathered(&counts);
    for (p, (found, due)) in flux.iter().zip(openings(&camera)).enumerate() {
        assert!((found / due - 1.0).abs() < 2e-4, "{p}: {}", found / due);
    }
}

/// What an opening of unit area, parallel to the wall, collects of even radiance 1 in each pixel of
/// the scene's camera: ∫ h²/r⁴ dA by quadrature.
fn openings(camera: &Camera) -> Vec<f64> {
    let view = &camera.view;
    let rule = Rule::gauss_legendre(8);
    let height = view.normal().dot(camera.position - view.corner()).abs();
    (0..48)
        .map(|p| {
            let footprint = camera.footprint(p);
            let mut sum = 0.0;
            for (a, wa) in rule.on(0.0, 1.0) {
                for (b, wb) in rule.on(0.0, 1.0) {
                    let r2 = (footprint.at([a, b]) - camera.position).length_squared();
                    sum += wa * wb * footprint.area * height * height / (r2 * r2);
                }
            }
            sum
        })
        .collect()
}

/// An evenly glowing wall, photographed from where the scene's camera stands by a lens of area A
/// whose axis lies off the middle of the view, at θ to the wall's normal: its pixels, θ′ off the
/// axis, collect A·cos⁴θ′/(fx·fy), and what is imported is what an opening of A/cosθ parallel to
/// the wall collects. So it is after a flat field that is 1 on the axis.
#[test]
fn a_tilted_lens_collects_what_its_opening_over_the_cosine_does() {
    let mut file = SceneFile::default();
    file.camera.pixels = [8, 6];
    file.camera.position = [-4.0, 13.0, 5.0];
    let camera = Scene::new(&file, None).unwrap().camera;
    let view = &camera.view;
    let forwards = (DVec3::new(3.0, 9.0, 0.0) - camera.position).normalize();
    let right = forwards.cross(DVec3::new(0.0, 1.0, 0.0)).normalize();
    let down = forwards.cross(right);
    let lens = Lens {
        fx: 380.0,
        fy: 370.0,
        cx: 80.3,
        cy: 17.9,
        k1: 0.0,
        k2: 0.0,
        p1: 0.0,
        p2: 0.0,
        k3: 0.0,
    };
    let marks: Vec<Mark> = (0..16)
        .map(|k| [f64::from(k % 4) / 3.0, f64::from(k / 4) / 3.0])
        .map(|wall| {
            let to = view.corner() + view.u() * wall[0] + view.v() * wall[1] - camera.position;
            let along = to.dot(forwards);
            let pixel = lens.pixel([to.dot(right) / along, to.dot(down) / along]);
            Mark { pixel, wall }
        })
        .collect();
    let mapping = Mapping::from_marks(&marks, Some(lens)).unwrap().mapping;
    let size = [240, 240];
    let area = 0.03;
    let cosine4 = |q: usize| {
        let [x, y] = lens.normalised([(q % size[0]) as f64, (q / size[0]) as f64]);
        (1.0 + x * x + y * y).powi(-2)
    };
    let counts: Vec<f64> = (0..size[0] * size[1])
        .map(|q| area * cosine4(q) / (lens.fx * lens.fy))
        .collect();
    let flat: Vec<f64> = (0..counts.len()).map(|q| counts[q] / cosine4(q)).collect();
    for (evenness, counts) in [(Evenness::ByLens, &counts), (Evenness::Even, &flat)] {
        let found = Footprints::new(&camera, &mapping, size, evenness).unwrap();
        for (p, (found, due)) in found
            .gathered(counts)
            .iter()
            .zip(openings(&camera))
            .enumerate()
        {
            let due = due * area / -forwards.z;
            assert!(
                (found / due - 1.0).abs() < 2e-4,
                "{p}: {}, {evenness:?}",
                found / due
            );
        }
    }
    let pose = mapping.pose().unwrap();
    assert!((pose.cosine + forwards.z).abs() < 1e-9);
    let height = pose.height * view.u().cross(view.v()).length().sqrt();
    assert!((height / camera.position.z - 1.0).abs() < 1e-9);
}

/// Areas and centroids by hand, and a cut at a border.
#[test]
fn polygons_have_their_area() {
    let triangle = [[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]];
    assert_eq!(area_and_centroid(&triangle), (4.5, [1.0, 1.0]));
    let turned: Vec<[f64; 2]> = triangle.iter().rev().copied().collect();
    assert_eq!(area_and_centroid(&turned).0, 4.5);
    // Between x = 1 and x = 2: a trapezium of heights 2 and 1.
    assert!((area_and_centroid(&between(&triangle, 0, [1.0, 2.0])).0 - 1.5).abs() < 1e-15);
    assert!(between(&triangle, 0, [4.0, 5.0]).is_empty());
}

/// Light that rises linearly over the photograph is that of each footprint however this cuts the
/// pixels, and what all footprints have is what the crop has.
#[test]
fn linear_light_is_gathered_exactly() {
    let camera = camera();
    let [left, top, width, height] = [5.3, 3.1, 20.0, 13.8];
    let mapping = Mapping::upright([left, top], [width, height]);
    let found = Footprints::new(&camera, &mapping, [40, 24], Evenness::Same).unwrap();
    let light = |u: f64, v: f64| 7.0 + 0.9 * u - 0.4 * v;
    // Pixel q is of unit area about its middle, u from the left border.
    let values: Vec<f64> = (0..40 * 24)
        .map(|q| light(f64::from(q % 40) + 0.5, f64::from(q / 40) + 0.5))
        .collect();
    let [wide, high] = [width / 8.0, height / 6.0];
    for (p, sum) in found.gathered(&values).into_iter().enumerate() {
        let [i, j] = [(p % 8) as f64, 5.0 - (p / 8) as f64];
        let due = wide * high * light(left + (i + 0.5) * wide, top + (j + 0.5) * high);
        assert!((sum / due - 1.0).abs() < 1e-12, "{p}: {sum} {due}");
    }
    // At the border of the photograph the slope is that to the next pixel.
    let border = Mapping::upright([0.0; 2], [20.3, 13.7]);
    let found = Footprints::new(&camera, &border, [21, 14], Evenness::Same).unwrap();
    let values: Vec<f64> = (0..21 * 14)
        .map(|q| light(f64::from(q % 21) + 0.5, f64::from(q / 21) + 0.5))
        .collect();
    let sum: f64 = found.gathered(&values).iter().sum();
    let due = 20.3 * 13.7 * light(0.5 * 20.3, 0.5 * 13.7);
    assert!((sum / due - 1.0).abs() < 1e-12);
}

/// Footprints of 2 × 2 pixels, half a pixel to the right of them: along the rows the weights are
/// −1/16, ½, 9/8, ½ and −1/16, their squares add up to 1.7734375, and those of the sum of n
/// footprints to 2n − 3 + 2 (1/256 + ¼ + (17/16)²). Footprints of whole pixels share none.
#[test]
fn footprints_that_share_pixels_say_by_how_much() {
    let camera = camera();
    let shared = |left: f64, size: [f64; 2]| {
        let mapping = Mapping::upright([left, 4.0], size);
        let found = Footprints::new(&camera, &mapping, [60, 50], Evenness::Same).unwrap();
        found.shared()
    };
    assert!((shared(4.0, [32.0, 18.0]) - 1.0).abs() < 1e-12);
    let n = 8.0_f64;
    let together = 2.0 * n - 3.0 + 2.0 * (1.0 / 256.0 + 0.25 + 289.0 / 256.0);
    let due = (together / (n * 1.773_437_5)).sqrt();
    let found = shared(4.5, [16.0, 12.0]);
    assert!((found / due - 1.0).abs() < 1e-9, "{found} {due}");
}

/// A photograph of fewer pixels than the scene's camera has is refused, of as many it is not.
#[test]
fn a_photograph_is_no_coarser_than_the_scene() {
    let camera = camera();
    let of = |width: f64, height: f64| {
        let mapping = Mapping::upright([2.0; 2], [width, height]);
        Footprints::new(&camera, &mapping, [40, 24], Evenness::Same)
    };
    assert!(of(8.0, 6.0).is_ok());
    let told = of(4.0, 6.0).unwrap_err().to_string();
    assert!(
        told.contains("0.50 pixels for each of the scene's")
            && told.contains("camera.pixels = [2, 2]"),
        "{told}"
    );
}
