use super::*;
use crate::num::statistics::chi_square_sf;
use crate::num::stream::{Key, Sampling, Stream};
use crate::scene::Role;
use crate::transport::beam::Beams;
use crate::transport::camera::first_vertex;

const BENCH: &str = include_str!("../../../scenes/bench.toml");

fn scene() -> Scene {
    let board = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";
    let cells = "{ cells = [[0.0, 0.5, 0.2], [0.0, 0.0, 0.0], [1.0, 0.0, 0.1]] }";
    let second = "[[surface]]\nname = \"second\"\nrole = \"hidden\"\n\
        rectangle = { corner = [8, 11, 4], u = [1, 0, 0], v = [0, -1, 1] }\n\
        material = { lambertian = 0.3 }\nelements = [2, 2]\n";
    assert!(BENCH.contains(board));
    Scene::from_toml("two", &(BENCH.replace(board, cells) + second)).unwrap()
}

fn sampler(scene: &Scene) -> AreaSampler {
    let hidden: Vec<ShapeId> = scene.hidden().map(|(id, _)| id as ShapeId).collect();
    AreaSampler::new(scene, &hidden)
}

/// χ² of the sampled cells against density × cell area; the densities integrate to 1.
#[test]
fn points_follow_their_density() {
    let scene = scene();
    let hidden = sampler(&scene);
    const SUB: usize = 6;
    let n = 200_000;
    let key = Key {
        seed: 3,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    let mut counts = vec![[0.0; SUB * SUB]; 3];
    for _ in 0..n {
        let u = stream.next_four();
        let (at, _) = hidden.sample(&scene, [u[0], u[1]]);
        let (shape, p) = (at.shape, at.point);
        assert!(
            scene.surfaces[shape as usize].albedo.albedo(p.uv) > 0.0,
            "a dark cell was sampled"
        );
        let cell = |x: f64| ((x * SUB as f64) as usize).min(SUB - 1);
        counts[shape as usize][cell(p.uv[0]) + cell(p.uv[1]) * SUB] += 1.0;
    }
    let (mut chi2, mut bins, mut total) = (0.0, 0.0, 0.0);
    for shape in [1u32, 2] {
        let area = scene.surfaces[shape as usize].shape.area() / (SUB * SUB) as f64;
        for (k, count) in counts[shape as usize].iter().enumerate() {
            let centre = |i: usize| (i as f64 + 0.5) / SUB as f64;
            let p = area
                * hidden.density(&SurfaceInteraction::at(
                    &scene,
                    shape,
                    [centre(k % SUB), centre(k / SUB)],
                ));
            total += p;
            if p > 0.0 {
                let expected = p * f64::from(n);
                chi2 += (count - expected) * (count - expected) / expected;
                bins += 1.0;
            } else {
                assert_eq!(*count, 0.0);
            }
        }
    }
    assert!((total - 1.0).abs() < 1e-12, "{total}");
    assert!(
        chi_square_sf(chi2, bins - 1.0) > 1e-4,
        "chi2 {chi2} of {bins}"
    );
}

/// The way back from a point to the unit square, by the definition of the two distribution
/// functions: the share of the surfaces, rows and cells before the point, and of its own as far as
/// it lies in. The shares are the density times the area of the cells of the two textures.
#[test]
fn points_return_to_their_place_in_the_square() {
    let scene = scene();
    let hidden = sampler(&scene);
    let share = |shape: ShapeId, i: usize, j: usize| {
        let n = if shape == 1 { 3 } else { 1 };
        let centre = [i, j].map(|i| (i as f64 + 0.5) / f64::from(n));
        let at = SurfaceInteraction::at(&scene, shape, centre);
        hidden.density(&at) * scene.surfaces[shape as usize].shape.area() / f64::from(n * n)
    };
    let of_shape =
        |shape: ShapeId, n: usize| -> f64 { (0..n * n).map(|k| share(shape, k % n, k / n)).sum() };
    let [first, second] = [of_shape(1, 3), of_shape(2, 1)];
    assert!((first + second - 1.0).abs() < 1e-12);
    let key = Key {
        seed: 4,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    for _ in 0..5000 {
        let u = stream.next_four();
        let (at, _) = hidden.sample(&scene, [u[0], u[1]]);
        let (n, before, own) = if at.shape == 1 {
            (3, 0.0, first)
        } else {
            (1, first, second)
        };
        let along = |shares: Vec<f64>, x: f64| {
            let i = ((x * n as f64) as usize).min(n - 1);
            let sum: f64 = shares[..i].iter().sum();
            let all: f64 = shares.iter().sum();
            (sum + (x * n as f64 - i as f64) * shares[i]) / all
        };
        let row = ((at.point.uv[1] * n as f64) as usize).min(n - 1);
        let in_row = (0..n).map(|i| share(at.shape, i, row)).collect();
        let row_sum = |j: usize| (0..n).map(|i| share(at.shape, i, j)).sum();
        let back = [
            before + own * along(in_row, at.point.uv[0]),
            along((0..n).map(row_sum).collect(), at.point.uv[1]),
        ];
        for d in 0..2 {
            assert!((back[d] - u[d]).abs() < 1e-12, "{u:?} -> {back:?}");
        }
    }
}

/// A point that a ray finds has the density with which the sampler drew it, on meshes too, and
/// Σ 1/density over the points of a shape estimates its area, within four standard errors.
#[test]
fn a_guided_sampler_knows_its_density() {
    let scene = Scene::load("shelf").unwrap();
    let shapes: Vec<ShapeId> = (1..scene.surfaces.len() as ShapeId).collect();
    let parts = Arc::new(Parts::divided(&scene, &shapes, 16));
    let lit = Beams::new(&scene).point(0, [0.5; 2]).unwrap();
    let ends = [first_vertex(&scene, 0, [0.5; 2]).unwrap(), lit];
    let [seen, lit] = ends.map(|end| parts.seen_from(&scene, &end));
    let sampler = AreaSampler::guided(&parts, |k| seen[k] * lit[k]);
    let key = Key {
        seed: 5,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    let n = 200_000;
    let mut sums = vec![[0.0; 2]; scene.surfaces.len()];
    let mut apart = 0;
    for _ in 0..n {
        let [u, v, ..] = stream.next_four();
        let (drawn, density) = sampler.sample(&scene, [u, v]);
        assert_eq!(sampler.density(&drawn), density);
        let (p, normal) = drawn.oriented();
        let ray = Ray::new(p + normal * 1e-3, -normal);
        if let Some(hit) = scene.bvh().closest(&ray, None) {
            let found = SurfaceInteraction::hit(&scene, &ray, hit);
            let same = found.shape == drawn.shape && sampler.density(&found) == density;
            apart += u32::from(!same);
        }
        let [sum, square] = &mut sums[drawn.shape as usize];
        *sum += 1.0 / density;
        *square += 1.0 / (density * density);
    }
    // Rounding moves points at the edge of a cell over it.
    assert!(apart < n / 10_000, "{apart} of {n} points");
    for shape in shapes {
        let surface = &scene.surfaces[shape as usize];
        // Half of the board is dark.
        let light = if surface.role == Role::Hidden {
            0.5
        } else {
            1.0
        };
        let [sum, square] = sums[shape as usize];
        let (mean, samples) = (sum / f64::from(n), f64::from(n));
        let stderr = ((square / samples - mean * mean) / samples).sqrt();
        let area = light * surface.shape.area();
        assert!(
            (mean - area).abs() < 4.0 * stderr,
            "{}: {mean} ± {stderr}, area {area}",
            surface.name
        );
    }
}
