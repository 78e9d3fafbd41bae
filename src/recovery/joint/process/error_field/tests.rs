use super::*;
use crate::num::search::largest;
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::{Method, Options, recover};

/// The likelihood of all entries, −½ (zᵀS⁻¹z + ln det S), S = A K Aᵀ + the covariance of noise and
/// field + 10⁶ of each constant, as one dense matrix: nowhere around the field that was found is it
/// larger.
#[test]
fn the_field_is_the_likeliest() {
    let bench = Bench::new(6.0, 3, 6);
    let d = bench.d.columns(0, 5).into_owned();
    let frame = [6, 6];
    let size = bench.phi(&DVector::from_element(9, 0.5)).mean();
    let mut normal = normal_stream(9);
    let truth = DVector::from_fn(9, |_, _| 0.5 + 0.2 * normal());
    let field = ErrorField {
        pixel: 0.0,
        shared: 1.0,
        range: 3.0,
    };
    let v = field.variances(frame);
    let rough = from_cosines(
        &DMatrix::from_fn(36, 5, |k, _| (1e-4 + 4e-4 * v[k]).sqrt() * size * normal()),
        frame,
    );
    let phi = bench.phi(&truth).columns(0, 5) + rough;
    let nuisance = Nuisance {
        frame_constant: true,
        ..Nuisance::default()
    };
    let problem = Problem::new(&phi, &bench.c, &d, None).unwrap();
    let problem = problem.with_nuisance(nuisance).unwrap();
    let k = DMatrix::from_fn(9, 9, |i, j| 0.25 + if i == j { 0.04 } else { 0.0 });
    let along = Along::new(&problem, frame).unwrap();
    let (found, own) = along.likeliest(&problem, &k, 1.0, None).unwrap().unwrap();
    let light = DMatrix::from_fn(180, 9, |at, j| bench.c[(at % 36, j)] * d[(j, at / 36)]);
    let z = DMatrix::from_fn(180, 1, |at, _| phi[(at % 36, at / 36)])
        - &light * DMatrix::from_element(9, 1, 0.5);
    let likelihood = |field: &ErrorField| {
        let v = field.variances(frame);
        let spread = from_cosines(&DMatrix::from_diagonal(&DVector::from_vec(v)), frame);
        let covariance = from_cosines(&spread.transpose(), frame);
        let mut s = &light * &k * light.transpose();
        for (i, j) in (0..180).flat_map(|i| (0..180).map(move |j| (i, j))) {
            if i / 36 == j / 36 {
                s[(i, j)] += covariance[(i % 36, j % 36)] + 1e6 * size * size;
            }
        }
        let factor = Cholesky::new(&s).unwrap();
        -0.5 * (factor.forward(z.clone()).norm_squared() + factor.log_det())
    };
    let best = likelihood(&found);
    // One range further either way.
    let next = libm::exp(0.35);
    for (pixel, shared, range) in [
        (1.05, 1.0, 1.0),
        (0.95, 1.0, 1.0),
        (1.0, 1.1, 1.0),
        (1.0, 0.9, 1.0),
        (1.05, 1.05, 1.0),
        (0.95, 0.95, 1.0),
        (1.0, 1.0, next),
        (1.0, 1.0, 1.0 / next),
    ] {
        let other = ErrorField {
            pixel: found.pixel * pixel,
            shared: found.shared * shared,
            range: found.range * range,
        };
        let gained = likelihood(&other) - best;
        assert!(gained < 0.02, "{found:?} {other:?}: {gained}");
    }
    // Noise of single pixels alone: as much less likely, whatever size it is found to have.
    let white = |pixel: f64| {
        likelihood(&ErrorField {
            pixel,
            shared: 0.0,
            range: 1.0,
        })
    };
    let (_, alone) = largest(0.1 * found.shared, 10.0 * found.shared, white);
    let likelier = own - along.alone(&problem, &k, 1.0, size).unwrap().unwrap();
    assert!(likelier > 10.0, "{likelier}");
    assert!(
        (likelier - (best - alone)).abs() < 1e-3,
        "{likelier} {best} {alone}"
    );
}

/// Along the cosines, with noise alone, everything is what it is without them: picture, errors and
/// the light beside it, whose constants and background are those of the photographs.
#[test]
fn the_way_back_is_that_of_the_cosines() {
    let bench = Bench::new(6.0, 2, 6);
    let truth = DVector::from_row_slice(&[0.3, 0.6, 0.7, 0.4]);
    let mut phi = bench.phi(&truth);
    let size = phi.mean();
    let mut normal = normal_stream(3);
    phi.apply(|x| *x += 0.01 * size * (3.0 + normal()));
    let slopes = DMatrix::from_fn(36, 2, |p, k| [p % 6, p / 6][k] as f64);
    let stderr = DMatrix::from_element(36, phi.ncols(), 0.01 * size);
    for (frame_constant, patterns, background) in [
        (true, None, false),
        (true, Some(&slopes), false),
        (false, Some(&slopes), false),
        (true, None, true),
        (false, None, true),
    ] {
        let nuisance = Nuisance {
            frame_constant,
            frame_patterns: patterns,
            background,
            ..Nuisance::default()
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let along = Along::new(&problem, [6, 6]).unwrap();
        let white = ErrorField {
            pixel: 0.01 * size,
            shared: 0.0,
            range: 1.0,
        };
        let errors = along.stderr(&white);
        let options = Options::default();
        let own = recover(Method::JointGp, &problem, &options).unwrap();
        let mut found =
            recover(Method::JointGp, &along.problem(&problem, &errors), &options).unwrap();
        along.back(&problem, &mut found);
        assert!((&found.reflectance - &own.reflectance).amax() < 1e-8);
        let [a, b] = [&found, &own].map(|f| f.standard_error.as_ref().unwrap());
        assert!((a - b).amax() < 1e-8 * b.amax());
        assert!((found.residual / own.residual - 1.0).abs() < 1e-8);
        let [a, b] = [&found, &own].map(|f| f.photographs(&problem));
        assert!((a - b).amax() < 1e-8 * size);
        let [a, b] = [&found, &own].map(|f| f.nuisance.as_ref().unwrap());
        for (a, b) in [
            (&a.frame_constant, &b.frame_constant),
            (&a.background, &b.background),
        ] {
            assert_eq!(a.is_some(), b.is_some());
            if let (Some(a), Some(b)) = (a, b) {
                assert!((a - b).amax() < 1e-7 * size, "{}", (a - b).amax() / size);
            }
        }
        assert_eq!(a.frame_patterns.is_some(), b.frame_patterns.is_some());
    }
}

/// What has no such form.
#[test]
fn entries_left_out_have_no_cosines() {
    let bench = Bench::new(6.0, 2, 6);
    let phi = bench.phi(&DVector::from_element(4, 0.5));
    let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
    assert!(Along::new(&problem, [6, 6]).is_some());
    assert!(Along::new(&problem, [6, 7]).is_none());
    let mut flags = DMatrix::zeros(36, phi.ncols());
    flags[(3, 1)] = 1.0;
    let holed = Nuisance {
        left_out: Some(&flags),
        ..Nuisance::default()
    };
    assert!(Along::new(&problem.with_nuisance(holed).unwrap(), [6, 6]).is_none());
    let gains = Nuisance {
        frame_gain: Some(0.1),
        ..Nuisance::default()
    };
    assert!(Along::new(&problem.with_nuisance(gains).unwrap(), [6, 6]).is_none());
}
