//! Paint against another program and quadrature.

use super::*;
use crate::scene::material::tests::pair;

/// The table beside a quadrature of 16 times as many nodes, between its entries too.
#[test]
#[ignore = "slow"]
fn tables_are_as_good_as_stated() {
    let fine = Rule::gauss_legendre(128);
    for (alpha, eta) in [
        (0.01, 1.5),
        (0.05, 1.5),
        (0.3, 1.5),
        (1.0, 1.5),
        (0.3, 1.1),
        (0.3, 4.0),
    ] {
        let coated = Coated::new(alpha, eta, SecondFacet::Absorbs);
        let paint = Coated::new(alpha, eta, SecondFacet::Passes);
        let mut worst: f64 = 0.0;
        for k in 0..=300 {
            let mu = (f64::from(k) / 300.0).powi(2);
            let exact = transmitted(&coated.ggx, eta, mu, &fine);
            worst = worst.max((coated.transmittance(mu) - exact).abs());
            let exact = 1.0 - returned(&coated.ggx, eta, mu, &fine);
            let off = (paint.transmittance(mu) - exact).abs();
            assert!(off < 3e-4, "α {alpha} η {eta} μ {mu}: {off}");
        }
        let mut internal = 0.0;
        for k in 0..1000 {
            let mu = (f64::from(k) + 0.5) / 1000.0;
            internal += 2e-3 * mu * returned(&coated.ggx, 1.0 / eta, mu, &fine);
        }
        assert!(worst < 1e-5, "α {alpha} η {eta}: {worst}");
        assert!(
            (coated.internal - internal).abs() < 1e-4,
            "α {alpha} η {eta}: {internal}"
        );
    }
}

/// α, η, ρ; θ_i, θ_o, φ; f_r by Mitsuba 3.8.0 (`roughplastic`, `distribution = "ggx"`,
/// `nonlinear = true`, variant `llvm_ad_mono`: single precision).
const PAINT: [([f64; 3], [f64; 3], f64); 30] = [
    ([0.1, 1.5, 0.5], [0.0, 0.0, 0.0], 0.408261925),
    ([0.1, 1.5, 0.5], [30.0, 30.0, 180.0], 0.529271792),
    ([0.1, 1.5, 0.5], [30.0, 60.0, 60.0], 0.08511623),
    ([0.1, 1.5, 0.5], [80.0, 10.0, 90.0], 0.0654976156),
    ([0.1, 1.5, 0.5], [80.0, 80.0, 180.0], 88.6159355),
    ([0.1, 1.5, 0.5], [85.0, 60.0, 150.0], 0.0643210635),
    ([0.1, 1.5, 1.0], [0.0, 0.0, 0.0], 0.609000087),
    ([0.1, 1.5, 1.0], [30.0, 30.0, 180.0], 0.728857528),
    ([0.1, 1.5, 1.0], [30.0, 60.0, 60.0], 0.274208665),
    ([0.1, 1.5, 1.0], [80.0, 10.0, 90.0], 0.209300504),
    ([0.1, 1.5, 1.0], [80.0, 80.0, 180.0], 88.7189818),
    ([0.1, 1.5, 1.0], [85.0, 60.0, 150.0], 0.182645619),
    ([0.3, 1.5, 0.5], [0.0, 0.0, 0.0], 0.11645104),
    ([0.3, 1.5, 0.5], [30.0, 30.0, 180.0], 0.12798022),
    ([0.3, 1.5, 0.5], [30.0, 60.0, 60.0], 0.0774504244),
    ([0.3, 1.5, 0.5], [80.0, 10.0, 90.0], 0.0700206452),
    ([0.3, 1.5, 0.5], [80.0, 80.0, 180.0], 5.19437568),
    ([0.3, 1.5, 0.5], [85.0, 60.0, 150.0], 0.098956883),
    ([0.6, 1.33, 0.5], [0.0, 0.0, 0.0], 0.0937806368),
    ([0.6, 1.33, 0.5], [30.0, 30.0, 180.0], 0.0912406351),
    ([0.6, 1.33, 0.5], [30.0, 60.0, 60.0], 0.0777651072),
    ([0.6, 1.33, 0.5], [80.0, 10.0, 90.0], 0.06150912),
    ([0.6, 1.33, 0.5], [80.0, 80.0, 180.0], 0.528662449),
    ([0.6, 1.33, 0.5], [85.0, 60.0, 150.0], 0.0781398267),
    ([1.0, 2.5, 1.0], [0.0, 0.0, 0.0], 0.0504864082),
    ([1.0, 2.5, 1.0], [30.0, 30.0, 180.0], 0.0491441022),
    ([1.0, 2.5, 1.0], [30.0, 60.0, 60.0], 0.0472406298),
    ([1.0, 2.5, 1.0], [80.0, 10.0, 90.0], 0.0464926338),
    ([1.0, 2.5, 1.0], [80.0, 80.0, 180.0], 0.112262892),
    ([1.0, 2.5, 1.0], [85.0, 60.0, 150.0], 0.0644646361),
];

/// Mitsuba takes R̄ as the mean of 2 μ R(μ) over 64 values of μ from 0 to 1, both ends among
/// them, which is up to 1.5 % below the integral, and T by linear interpolation between 64
/// values. With its R̄ the two programs differ by that interpolation only.
#[test]
fn paint_is_as_in_another_program() {
    let rule = Rule::gauss_legendre(64);
    for ([alpha, eta, albedo], angles, theirs) in PAINT {
        let mut coated = Coated::new(alpha, eta, SecondFacet::Absorbs);
        let means = (0..64).map(|k| f64::from(k) / 63.0);
        let theirs_internal: f64 = means
            .map(|mu| 2.0 * mu * returned(&coated.ggx, 1.0 / eta, mu, &rule) / 64.0)
            .sum();
        assert!((coated.internal / theirs_internal - 1.0).abs() < 0.016);
        coated.internal = theirs_internal;
        let (i, o) = pair(angles);
        let f = coated.brdf(albedo, i, o);
        assert!(
            (f / theirs - 1.0).abs() < 1e-3,
            "α {alpha} ρ {albedo} {angles:?}: {f} for {theirs}"
        );
    }
}
