//! Made-up runs for tests: no physics, only shapes and plausible sizes.

use crate::lab::{Agreement, Chosen, Entry, Fit, RecoveredObject, RunResults};
use crate::matrix::Matrix;
use crate::num::stream::Sampling;
use crate::scene::Scene;
use crate::transport::{Budget, Estimator, Plan};

/// A run of a built-in scene without model and recovery.
pub(crate) fn bare(scene: &str) -> RunResults {
    of(Scene::load(scene).unwrap())
}

/// A run of `scene` without model and recovery.
pub(crate) fn of(scene: Scene) -> RunResults {
    let (p, l) = (scene.camera.pixels(), scene.laser.spots.len());
    let columns = scene.camera.columns;
    let phi = Matrix::from_fn(p, l, |i, j| {
        let (x, y) = (
            (i % columns) as f64 / columns as f64,
            (i / columns) as f64 / columns as f64,
        );
        1e-12 * (1.0 + x + 0.5 * y + 0.3 * libm::sin(j as f64 * 0.1))
    });
    RunResults {
        version: "0.1.0".into(),
        plan: Plan {
            estimator: Estimator::Independent,
            sampling: Sampling::Pcg,
            seed: u64::MAX,
            budget: Budget {
                blocks: 16,
                size: 256,
            },
        },
        stderr: &phi * 1e-3,
        tails: Matrix::zeros(p, l),
        phi,
        bounces: vec![(3, 0.976), (4, 0.0), (5, 0.024)],
        model: None,
        z: None,
        agreement: None,
        recovered: Vec::new(),
        picards: Vec::new(),
        gallery: None,
        times: vec![
            ("render".into(), 12.3),
            ("model".into(), 0.01),
            ("recover".into(), 0.4),
        ],
        scene,
    }
}

/// A whole run of a built-in scene.
pub(crate) fn run(scene: &str) -> RunResults {
    whole(bare(scene))
}

/// A fit of 24 degrees of freedom.
pub(in crate::lab) fn fit(chi2_per_dof: f64) -> Fit {
    Fit {
        chi2_per_dof,
        dof: 24.0,
        p: 0.2,
        entries: 30,
        left_out: 0,
        level: 1e-3,
        fits: true,
        within_integration: None,
        outlier: None,
        pooled: None,
        neighbours: None,
        with_light: None,
    }
}

/// Adds model, verdict and recoveries.
pub(crate) fn whole(mut run: RunResults) -> RunResults {
    let (p, l) = run.phi.shape();
    let z = Matrix::from_fn(p, l, |i, j| 3.0 * libm::sin((i * 37 + j * 101) as f64));
    run.model = Some(&run.phi - run.stderr.component_mul(&z));
    run.z = Some(z);
    run.agreement = Some(Agreement {
        agrees: true,
        evidence: true,
        kernel: "physical".into(),
        integration: "centres".into(),
        occlusion: None,
        pooled: None,
        seldom: 0,
        with_light: None,
        significance: 0.01,
        entries: 30720,
        left_out: 0,
        is_rendered: true,
        fitted: 0,
        other_light: 0.0,
        gains: None,
        is_scale_free: false,
        chi2_per_dof: 1.003,
        dof: 30720.0,
        chi2_p: 0.36,
        largest_z: 4.1,
        largest_p: 0.3,
        z_limit: 4.74,
        relative_difference: 1.1e-3,
        relative_noise: 1e-3,
        relative_discretisation: 4e-4,
        worst_bound: None,
        best_scale: 1.00001,
        best_scale_stderr: 2e-5,
        pixels: Vec::new(),
        spots: Vec::new(),
        score: None,
        worst: vec![Entry {
            pixel: 17,
            spot: 3,
            traced: 1.01e-12,
            modelled: 1e-12,
            z: 4.1,
        }],
        unmodelled: Vec::new(),
        sent_on: None,
    });
    let hidden: Vec<(String, [usize; 2])> = run
        .scene
        .hidden()
        .map(|(_, s)| (s.name.clone(), s.elements))
        .collect();
    for (surface, elements) in hidden {
        let n = elements[0] * elements[1];
        let truth: Vec<f64> = (0..n)
            .map(|i| {
                f64::from(
                    (2 * (i % elements[0]) / elements[0] + 2 * (i / elements[0]) / elements[1])
                        as u8
                        % 2,
                )
            })
            .collect();
        for (method, stretch) in [
            ("pinv", 1.4),
            ("tsvd", 0.6),
            ("tikhonov", 0.8),
            ("joint", 1.0),
            ("joint-bounded", 0.97),
        ] {
            let wave = |i: usize| 0.05 * libm::sin(i as f64);
            let reflectance = truth
                .iter()
                .enumerate()
                .map(|(i, t)| 0.5 + stretch * (t - 0.5) + wave(i));
            run.recovered.push(RecoveredObject {
                surface: surface.clone(),
                method: method.into(),
                elements,
                reflectance: reflectance.collect(),
                truth: Some(truth.clone()),
                mtf_raw: Some(0.5 * stretch),
                mtf_normalized: Some(0.98),
                correlation: Some(0.97),
                rmse: Some(0.05),
                parameter: "λ 1.3e-15 by the discrepancy principle from the standard error of Φcam"
                    .into(),
                choice: Chosen {
                    parameter: None,
                    value: Vec::new(),
                    rule: None,
                    measures: Default::default(),
                    repeat: None,
                },
                solver: None,
                estimated: None,
                likelier: None,
                log_evidence: None,
                light: None,
                alike: None,
                patterns: None,
                bands: None,
                standard_error: None,
                bias: None,
                effective_rank: 4.0,
                determined: Some(4.5),
                determined_share: Some(vec![0.25; n]),
                unknowns: n,
                fit: Some(fit(1.25)),
                best_fit: Some(fit(1.0)),
                warnings: vec!["DOES NOT FIT <in this sample>".into()],
                covariance: None,
                resolution: None,
            });
        }
    }
    // As a run lists them: every surface by the first method, then by the next.
    let methods: Vec<String> = run.recovered.iter().map(|r| r.method.clone()).collect();
    run.recovered
        .sort_by_key(|r| methods.iter().position(|m| *m == r.method));
    run
}
