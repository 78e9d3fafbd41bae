use super::*;

/// Against the scalar term, for points on all sides, coincident ones and some of weight 0 among
/// them.
#[test]
fn wide_geometry_terms_are_the_scalar_ones() {
    let spiral = |i: usize, r: f64| {
        let t = i as f64 * 0.7;
        DVec3::new(libm::cos(t), libm::sin(t), libm::sin(t * 0.37)) * (r + 0.01 * i as f64)
    };
    let n = 40;
    let (mut a, mut b) = (Batch::zeros(n), Batch::zeros(n));
    for i in 0..n {
        let at = if i == 5 {
            spiral(i, 2.0)
        } else {
            spiral(i, 1.0)
        };
        a.set(i, (at, spiral(i + 3, 1.0).normalize()), i as f64 * 0.1, 0);
        b.set(i, (spiral(i, 2.0), spiral(i + 20, 1.0).normalize()), 1.0, 1);
    }
    let mut out = vec![f64::NAN; n];
    a.geometry_terms_to(&b, &a.weight, &mut out);
    let mut from = vec![f64::NAN; n];
    b.geometry_terms_from(a.oriented(7), 3.0, &b.weight, &mut from);
    let expected = |p, q| geometry_term(p, q).map_or(0.0, |(f, _)| f);
    for i in 0..n {
        let close = |x: f64, y: f64| (x - y).abs() <= 1e-14 * y.abs();
        assert!(
            close(out[i], a.weight[i] * expected(a.oriented(i), b.oriented(i))),
            "{i}"
        );
        assert!(
            close(from[i], 3.0 * expected(a.oriented(7), b.oriented(i))),
            "{i}"
        );
    }
    assert!(out.iter().filter(|x| **x > 0.0).count() > 3);
}
