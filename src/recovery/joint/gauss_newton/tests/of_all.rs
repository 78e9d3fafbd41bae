//! A factor of all, and the mean of those of the frames.

use super::*;

/// A surface of one reflectance, of a scale known to 5 %: its mean is known to no less, and to
/// hardly more where the noise is small; the factor itself is known to its σ.
#[test]
fn a_scale_known_to_five_percent_leaves_five_percent() {
    let small = Small::new();
    let flat = DVector::from_element(4, 0.6);
    let phi = &small.c * DMatrix::from_diagonal(&flat) * &small.d;
    let nuisance = Nuisance {
        scale_error: Some(0.05),
        ..Nuisance::default()
    };
    let stderr = &phi * 1e-3;
    let problem = Problem::new(&phi, &small.c, &small.d, Some(&stderr)).unwrap();
    let problem = problem.with_grids(&[[2, 2]]).unwrap();
    let problem = problem.with_nuisance(nuisance).unwrap();
    let of_mean = |found: &Recovered| found.covariance.as_ref().unwrap().mean().sqrt() / 0.6;
    let free = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
    assert!(
        free.standard_error
            .as_ref()
            .unwrap()
            .iter()
            .all(|s| *s >= 0.05 * 0.6)
    );
    assert!(
        (0.05..0.0505).contains(&of_mean(&free)),
        "{}",
        of_mean(&free)
    );
    let of = gains(&free);
    assert!(of.widened.unwrap() > 1.0, "{of:?}");
    let whole = of.whole.as_ref().unwrap();
    assert!(near(whole.standard_error[0], 0.05, 1e-6) && whole.size[0].abs() < 1e-6);
    // What is known of pictures beforehand, ½ ± ½ throughout, tells a little of the scale: M = 0.6
    // being known, p(ε) ∝ N(ε; 0, σ²) N(M/(1 + ε); ½, ½²)/(1 + ε), and the error is of M/(1 + ε).
    let smooth = recover(Method::JointGp, &problem, &Options::default()).unwrap();
    let mut moments = [0.0; 3];
    for scale in (-120..=120).map(|k| 1.0 + 0.05 * 0.05 * f64::from(k)) {
        let [z, off] = [(scale - 1.0) / 0.05, (0.6 / scale - 0.5) / 0.5];
        let weight = libm::exp(-0.5 * (z * z + off * off)) / scale;
        for (sum, power) in moments.iter_mut().zip([0, 1, 2]) {
            *sum += weight * scale.powi(-power);
        }
    }
    let [all, first, second] = moments;
    let want = (second / all - (first / all).powi(2)).sqrt();
    let own = of_mean(&smooth);
    assert!(near(own, want, 5e-3 * want), "{own} {want}");
    let levels = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
    assert!(gains(&levels).settled, "{:?}", gains(&levels));
}

/// Sides of a model that tells 36 elements apart.
fn sides(level: &mut impl FnMut() -> f64, spots: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    (
        DMatrix::from_fn(60, 36, |_, _| level()),
        DMatrix::from_fn(36, spots, |_, _| level()),
    )
}

/// Photographs with their errors, of 6 × 6 elements, by `joint-gp`.
fn by_process(
    (c, d): (&DMatrix<f64>, &DMatrix<f64>),
    [phi, stderr]: [&DMatrix<f64>; 2],
    nuisance: Nuisance<'_>,
) -> Recovered {
    let problem = Problem::new(phi, c, d, Some(stderr)).unwrap();
    let problem = problem.with_grids(&[[6, 6]]).unwrap();
    let problem = problem.with_nuisance(nuisance).unwrap();
    recover(Method::JointGp, &problem, &Options::default()).unwrap()
}

/// Photographs that tell each element tell nothing of a factor of all, and a picture of a prior's
/// size little: with (1 + ε) A in place of A, by Gauss's rule over ε,
///
/// > p(ε|Φ) ∝ N(ε; 0, σ²) p(Φ|ε),   p(Φ|ε) the evidence with the factor known,
///
/// the same mean, errors and evidence of elements between 0 and 1 and a factor that is off. A fit
/// of picture and factor together is off by 36 σ².
#[test]
fn a_factor_of_all_is_averaged_over_not_fitted_with_the_picture() {
    for (known, noise) in [(0.07, 0.02), (0.1, 1e-3), (0.3, 1e-5)] {
        averaged_over(known, noise);
    }
}

fn averaged_over(known: f64, noise: f64) {
    let mut level = levels(77);
    let (c, d) = sides(&mut level, 40);
    let rho = DVector::from_fn(36, |_, _| level());
    let clean = &c * DMatrix::from_diagonal(&rho) * &d * (1.0 - known);
    let stderr = clean.map(|_| noise * clean.mean());
    let mut normal = normal_stream(78);
    let phi = clean.zip_map(&stderr, |x, s| x + s * normal());
    let recovered = |factor: f64, nuisance: Nuisance<'_>| {
        by_process((&c, &d), [&(&phi / factor), &(&stderr / factor)], nuisance)
    };
    let nodes: Vec<(f64, f64, Recovered)> = (-20..=20)
        .map(|k| 0.25 * f64::from(k))
        .filter(|z| known * z > -0.95)
        .map(|z| {
            let found = recovered(1.0 + known * z, Nuisance::default());
            let density = 0.25 * libm::exp(-0.5 * z * z) / std::f64::consts::TAU.sqrt();
            (
                known * z,
                libm::log(density) + found.log_evidence.unwrap(),
                found,
            )
        })
        .collect();
    let most = nodes
        .iter()
        .fold(f64::NEG_INFINITY, |m, node| m.max(node.1));
    let all: f64 = nodes.iter().map(|node| libm::exp(node.1 - most)).sum();
    let average = |of: &dyn Fn(f64, &Recovered) -> f64| -> f64 {
        let each = nodes.iter();
        let each = each.map(|(e, log, found)| libm::exp(log - most) / all * of(*e, found));
        each.sum()
    };
    let found = recovered(
        1.0,
        Nuisance {
            scale_error: Some(known),
            ..Nuisance::default()
        },
    );
    let whole = gains(&found).whole.as_ref().unwrap();
    let errors = found.standard_error.as_ref().unwrap();
    // The factor is told by the mean of its inverse, which the mean picture has. Each evidence is a
    // sum over τ by steps of 0.35 in ln τ, which moves with ε here: a twentieth of an error.
    let off = (1.0 + whole.size[0]) * average(&|e, _| 1.0 / (1.0 + e)) - 1.0;
    assert!(off.abs() < 0.06 * known, "{off}");
    let spread = (average(&|e, _| e * e) - average(&|e, _| e).powi(2)).sqrt();
    let ratio = whole.standard_error[0] / spread;
    assert!((0.98..1.02).contains(&ratio), "{ratio}");
    let mut told = Vec::new();
    for j in 0..36 {
        let own = |_: f64, f: &Recovered| f.reflectance[j];
        let square = |_: f64, f: &Recovered| {
            f.standard_error.as_ref().unwrap()[j].powi(2) + f.reflectance[j].powi(2)
        };
        told.push([own(0.0, &found), errors[j], average(&own), average(&square)]);
    }
    for (k, [own, stated, mean, square]) in told.into_iter().enumerate() {
        let error = (square - mean * mean).sqrt();
        let off = (own - mean).abs() / error;
        assert!(off < 0.06, "{k}: {own} {mean} ± {error}");
        let ratio = stated / error;
        assert!((0.97..1.03).contains(&ratio), "{k}: {stated} {error}");
    }
    let evidence = most + libm::log(all);
    let own = found.log_evidence.unwrap();
    assert!((own - evidence).abs() < 0.1, "{own} {evidence}");
}

/// Factors of single frames have a mean, which is a factor of all known to σ_g/√n: a fit of it with
/// the picture is off by N σ_g²/n.
#[test]
fn factors_of_frames_do_not_lessen_the_picture() {
    let mut level = levels(80);
    let (c, d) = sides(&mut level, 12);
    let (known, trials) = (0.2, 20);
    let mut mean = 0.0;
    let nuisance = Nuisance {
        frame_gain: Some(known),
        ..Nuisance::default()
    };
    for _ in 0..trials {
        let rho = DVector::from_fn(36, |_, _| level());
        let phi = &c * DMatrix::from_diagonal(&rho) * &d;
        let stderr = phi.map(|_| 0.01 * phi.mean());
        let phi = phi.zip_map(&stderr, |x, s| x + s * 12f64.sqrt() * (level() - 0.5));
        let found = by_process((&c, &d), [&phi, &stderr], nuisance);
        mean += gains(&found).frames.as_ref().unwrap().size.mean() / f64::from(trials);
    }
    // 0.12 where they are fitted with the picture.
    assert!(mean.abs() < 0.02, "{mean}");
}
