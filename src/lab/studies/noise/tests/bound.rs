//! The bound of Cramér and Rao.

use super::*;

/// No unbiased recovery is nearer to the truth than the bound: over 200 draws, by the spread of
/// what was found. And the joint one, whose weights are those of the noise here but for what is not
/// separable, comes within a tenth of it.
#[test]
fn unbiased_recoveries_keep_the_bound_of_cramer_and_rao() {
    let (scene, plan) = small();
    for (axis, levels) in [
        (NoiseAxis::Relative, vec![1e-6]),
        (NoiseAxis::Photons, vec![1e12]),
        (NoiseAxis::Scale, vec![0.03]),
    ] {
        let plan = NoisePlan {
            boards: vec![2],
            elements: vec![2],
            methods: vec![Method::Pinv, Method::JointUnbounded],
            axis,
            levels,
            seeds: 200,
            ..plan.clone()
        };
        let study = run(&scene, &plan);
        let ratios = study.curves.into_iter().map(|c| {
            let p = &c.points[0];
            // Five standard errors of a root mean square; errors of four elements spread at most as
            // those of one.
            (p.rmse_over_bound.unwrap(), 5.0 / (2.0 * 200f64).sqrt())
        });
        let ratios: Vec<(f64, f64)> = ratios.collect();
        assert!(ratios.iter().all(|(r, s)| *r > 1.0 - s), "{ratios:?}");
        assert!(ratios[1].0 < 1.1 + ratios[1].1, "{ratios:?}");
    }
}

/// √(tr (Wᵀ W)⁻¹/r) of W = ∂Φ/∂ρ2 over σ = 10⁻³ Φ, Φ summed by Gauss and Legendre over 2 × 2
/// elements (8 × 8 nodes each) and footprints (3 × 3), cosines and distances as the equation of the
/// crate has them. At the centres the bound is another by a tenth and more.
#[test]
fn the_bound_is_that_of_integrated_light() {
    let (scene, plan) = small();
    let own = |integration| {
        let plan = NoisePlan {
            boards: vec![2],
            elements: vec![2],
            methods: vec![Method::JointUnbounded],
            levels: vec![1e-3],
            seeds: 1,
            integration,
            ..plan.clone()
        };
        let study = run(&scene, &plan);
        assert_eq!(study.curves[0].integration, integration.name());
        study.curves[0].points[0].cramer_rao.unwrap()
    };
    let (corner, u, v) = {
        let (_, hidden) = scene.hidden().next().unwrap();
        let at = |a: f64, b: f64| hidden.shape.at([a, b]).position;
        (
            at(0.0, 0.0),
            at(1.0, 0.0) - at(0.0, 0.0),
            at(0.0, 1.0) - at(0.0, 0.0),
        )
    };
    let normal = u.cross(v).normalize();
    // cos·cos/R² between a point of S2 and one of the wall.
    let coupling = |on: DVec3, wall: DVec3| {
        let d = wall - on;
        let r2 = d.length_squared();
        (d.dot(normal) * d.z / (r2 * r2)).abs()
    };
    let camera = &scene.camera;
    let nodes = |n: usize| Rule::gauss_legendre(n).on(0.0, 1.0).collect::<Vec<_>>();
    let (fine, coarse) = (nodes(8), nodes(3));
    let spots: Vec<DVec3> = scene
        .laser
        .spots
        .iter()
        .map(|s| s.target.position)
        .collect();
    let mut slopes = Matrix::zeros(camera.pixels() * spots.len(), 4);
    for element in 0..4usize {
        for ((a, wa), (b, wb)) in fine.iter().flat_map(|a| fine.iter().map(move |b| (a, b))) {
            let [s, t] = [(element % 2) as f64 + a, (element / 2) as f64 + b].map(|x| 0.5 * x);
            let on = corner + u * s + v * t;
            for p in 0..camera.pixels() {
                let footprint = camera.footprint(p);
                let mut seen = 0.0;
                for ((c, wc), (d, wd)) in coarse
                    .iter()
                    .flat_map(|c| coarse.iter().map(move |d| (c, d)))
                {
                    let wall = footprint.at([*c, *d]);
                    let to = camera.position - wall;
                    let r2 = to.length_squared();
                    seen += wc * wd * to.z * to.z / (r2 * r2) * coupling(on, wall);
                }
                for (l, spot) in spots.iter().enumerate() {
                    slopes[(p + l * camera.pixels(), element)] +=
                        wa * wb * seen * coupling(on, *spot);
                }
            }
        }
    }
    // The board: white where column and row of the element differ, or where they do not.
    let bound = |white: [usize; 2]| {
        let phi = slopes.column(white[0]) + slopes.column(white[1]);
        let weighed = Matrix::from_fn(slopes.nrows(), 4, |k, j| slopes[(k, j)] / (1e-3 * phi[k]));
        let inverse = (weighed.transpose() * weighed).try_inverse().unwrap();
        (inverse.trace() / 4.0).sqrt()
    };
    let due = [bound([0, 3]), bound([1, 2])];
    let off = |found: f64| {
        due.map(|due| (found / due - 1.0).abs())
            .into_iter()
            .fold(1.0, f64::min)
    };
    assert!(off(own(Integration::Quadrature)) < 0.01, "{due:?}");
    assert!(off(own(Integration::Centres)) > 0.05, "{due:?}");
}
