//! Layouts of a small bench.

use super::design::left;
use super::photographs::Photographs;
use super::places::Places;
use super::plan::Plan;
use super::prior::Prior;
use super::search::searched;
use super::tasks::LayoutTasks;
use super::unsure::Unsure;
use crate::lab::finding::Describe;
use crate::lab::study::tests::divides;
use crate::lab::study::{Study, run};
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::scene::Scene;
use crate::transport::Control;

/// The thesis with 4 × 4 pixels on a wall that reaches further by `wall`.
fn scene(wall: f64) -> Scene {
    let mut scene = Scene::load("thesis").unwrap();
    if wall > 0.0 {
        scene = scene.with_extended_relay(wall).unwrap();
    }
    (scene.camera.columns, scene.camera.rows) = (4, 4);
    scene
}

fn plan() -> Plan {
    Plan {
        count: 6,
        candidates: 9,
        noise: NoiseLaw::Relative,
        level: 1e-3,
        prior: Prior {
            deviation: 0.5,
            length: Some(1.0),
        },
        margin: 0.4,
        apart: 0.5,
        refine: 2,
        boards: vec![2],
        draws: 2,
        elements: Some(2),
        seed: 1,
        unsure: Vec::new(),
        wall_in_view: true,
    }
}

fn photographs(scene: &Scene, plan: &Plan) -> Photographs {
    let tasks = LayoutTasks::new(scene, plan.clone()).unwrap();
    tasks.context(Control::none()).unwrap().photographs
}

#[test]
fn it_divides_and_leaves_a_scene() {
    let study = LayoutTasks::new(&scene(1.0), plan()).unwrap();
    let found = divides(&study);
    let said = found.describe();
    let row = |name: &str| found.rows.iter().find(|r| r.name == name).unwrap().risk;
    assert!(
        row("optimised") < row("square of 6 in."),
        "{:?}",
        found.rows
    );
    assert!(row("optimised, whole wall in view") < row("optimised"));
    assert!(found.optimum.bound <= found.optimum.on_grid);
    // The scene that is left has the wall of the study and its spots, and no others.
    let left = Scene::from_toml("layout", &said.files[0].1).unwrap();
    assert_eq!(left.laser.spots.len(), found.optimum.layout.len());
    for (spot, [x, y]) in left.laser.spots.iter().zip(&found.optimum.layout) {
        let off = spot.target.position - glam::DVec3::new(*x, *y, 0.0);
        assert!(off.length() < 1e-12, "{off}");
    }
    let (low, high) = left.relays().next().unwrap().1.shape.bounds();
    assert_eq!([low.x, low.y, high.x, high.y], [-4.0, -5.0, 14.0, 16.5]);
}

/// On one thread and on two the same bytes.
#[test]
fn threads_change_no_bit() {
    let study = LayoutTasks::new(&scene(0.0), plan()).unwrap();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        let found = pool.install(|| run(&study, Control::none()).unwrap());
        serde_json::to_string(&found).unwrap()
    };
    assert_eq!(on(1), on(2));
}

/// Every spot is where spots may be, apart from the others, also after it has left the grid, and
/// that lowers the risk.
#[test]
fn layouts_keep_the_rules() {
    let (scene, plan) = (scene(0.0), plan());
    let places = Places::new(&scene, plan.margin, plan.apart);
    let found = searched(&plan, &photographs(&scene, &plan), &places, Control::none()).unwrap();
    assert_eq!(found.layout.len(), plan.count);
    for (k, place) in found.layout.iter().enumerate() {
        let others = found.layout[..k].iter().copied();
        assert!(
            places.allow(*place) && places.apart_from(*place, others),
            "{place:?}"
        );
    }
    let photographs = photographs(&scene, &plan);
    let triangles = photographs
        .triangles(&found.layout, Control::none())
        .unwrap();
    let refined = left(
        triangles.into_iter().flatten().collect(),
        &photographs.factor,
    )
    .unwrap();
    assert!(
        refined.risk < found.on_grid,
        "{refined:?} {}",
        found.on_grid
    );
    let crowded = Plan { count: 80, ..plan };
    let refused = searched(&crowded, &photographs, &places, Control::none()).unwrap_err();
    assert!(refused.to_string().contains("--candidates"), "{refused}");
}

/// tr (K⁻¹ + Σ_s AᵀΣ⁻¹A)⁻¹/tr K by the inverse of the matrix, entry by entry, for each law of the
/// noise; and what is unsure costs something.
#[test]
fn the_risk_is_that_of_the_equation() {
    let scene = scene(0.0);
    let places = [[1.0, 1.0], [9.0, 3.0], [2.0, 11.0], [8.0, 8.0], [0.5, 6.0]];
    for noise in [NoiseLaw::Relative, NoiseLaw::Shot, NoiseLaw::Read] {
        let plan = Plan { noise, ..plan() };
        let own = photographs(&scene, &plan);
        let lit = scene.with_spots_at(&places).unwrap();
        let model = MatrixModel::new(&lit, Kernel::Physical, Some([2; 2])).unwrap();
        let k = &own.factor * own.factor.transpose();
        let mut information = k.clone().try_inverse().unwrap();
        let [c, d] = [&model.camera_side, &model.laser_side];
        for (p, l) in (0..16 * places.len()).map(|i| (i % 16, i / 16)) {
            let a = Matrix::from_fn(1, 4, |_, j| c[(p, j)] * d[(j, l)]);
            let grey = 0.5 * a.sum();
            let sigma = plan.level
                * match noise {
                    NoiseLaw::Relative => grey,
                    NoiseLaw::Shot => (grey * own.top).sqrt(),
                    NoiseLaw::Read => own.top,
                };
            information += a.transpose() * &a / (sigma * sigma);
        }
        let want = information.try_inverse().unwrap().trace() / k.trace();
        let risk = |own: &Photographs| {
            let triangles = own.triangles(&places, Control::none()).unwrap();
            left(triangles.into_iter().flatten().collect(), &own.factor)
                .unwrap()
                .risk
        };
        let found = risk(&own);
        assert!(
            (found / want - 1.0).abs() < 1e-6,
            "{noise:?}: {found} {want}"
        );
        let options = [("hinge", 0.5), ("offset", 0.05), ("aim", 0.05)];
        for (option, deviation) in options {
            let mut roughly = own.clone();
            roughly.unsure = Unsure::of(option, deviation).collect();
            assert!(
                !roughly.unsure.is_empty() && risk(&roughly) > found,
                "{option}"
            );
        }
    }
}

/// ∂φ/∂θ of an offset δ along the normal against the quotient of ten times the step on one side.
#[test]
fn slopes_of_the_geometry_are_those_of_the_model() {
    let scene = scene(0.0);
    let grey = |scene: &Scene| {
        let model = MatrixModel::new(scene, Kernel::Physical, Some([2; 2])).unwrap();
        Ok(model.phi_of(&[0.5; 4]))
    };
    let sigma = 0.1;
    let unsure: Vec<Unsure> = Unsure::of("offset", sigma).collect();
    let slope = unsure[0].slope(&scene, grey).unwrap();
    let hidden = scene.hidden().next().unwrap().1;
    let by = hidden.shape.at([0.5; 2]).normal * 1e-5;
    let motion = glam::DAffine3::from_translation(by);
    let moved = scene.with_moved_hidden(&motion).unwrap();
    let quotient = (grey(&moved).unwrap() - grey(&scene).unwrap()) * (sigma / 1e-5);
    assert!((&slope - &quotient).norm() < 1e-4 * slope.norm());
}
