use std::f64::consts::{PI, TAU};

use super::file::MaterialTable;
use super::*;
use crate::num::stream::{Key, Sampling, Stream};
use crate::scene::Scene;

/// Pairs of directions above the surface, uniform per solid angle.
pub(super) fn directions(n: usize) -> impl Iterator<Item = (DVec3, DVec3)> {
    let key = Key {
        seed: 5,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    let above = |z: f64, phi: f64| {
        let (z, r) = (1.0 - z, (z * (2.0 - z)).sqrt());
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    };
    (0..n).map(move |_| {
        let [a, b, c, d] = stream.next_four();
        (above(a, TAU * b), above(c, TAU * d))
    })
}

fn material(text: &str, file: &[u8]) -> Result<Material, String> {
    #[derive(serde::Deserialize)]
    struct Holder {
        m: MaterialTable,
    }
    let table = toml::from_str::<Holder>(&format!("m = {text}")).map_err(|e| e.to_string())?;
    Material::from_table(&table.m, 632.8e-9, &mut |_| Ok(file.to_vec()))
        .map(|(m, _)| m)
        .map_err(|f| format!("{}; {}", f.cause, f.cure))
}

/// Every kind of material, several roughnesses.
pub(crate) fn zoo() -> Vec<(String, Material)> {
    let mut all = vec![("lambertian".to_owned(), Material::Lambertian)];
    let mut add =
        |text: &str, file: &[u8]| all.push((text.to_owned(), material(text, file).unwrap()));
    for sigma in ["0.0", "0.2", "0.6", "1.5"] {
        add(&format!("{{ oren_nayar = 1.0, roughness = {sigma} }}"), b"");
    }
    for alpha in ["0.01", "0.05", "0.3", "1.0"] {
        for coat in ["coated", "paint"] {
            add(
                &format!("{{ {coat} = 1.0, roughness = {alpha}, ior = 1.5 }}"),
                b"",
            );
        }
        add(
            &format!("{{ conductor = {{ eta = 0.2, k = 3.9 }}, roughness = {alpha} }}"),
            b"",
        );
    }
    add("{ coated = 1.0, roughness = 0.2, ior = 3.5 }", b"");
    add("{ paint = 1.0, roughness = 0.2, ior = 3.5 }", b"");
    let gloss = Ggx::new(0.25);
    let shiny = merl::tests::written(|h, d, p| {
        let m = DVec3::new(h.sin(), 0.0, h.cos());
        0.1 + 0.02 * (2.0 * p).cos() * d.sin().powi(2) + 0.04 * gloss.distribution(m)
    });
    add("{ measured = \"a.binary\", channel = \"green\" }", &shiny);
    let theta: Vec<f64> = (0..=9).map(|k| 10.0 * f64::from(k)).collect();
    let phi: Vec<f64> = (0..=12).map(|k| 15.0 * f64::from(k)).collect();
    let csv = grid::tests::written(&theta, &phi, |i, o, p| {
        0.2 + 0.05 * (i + o).cos().powi(2) - 0.1 * i.sin() * o.sin() * p.cos()
    });
    add("{ measured = \"a.csv\" }", csv.as_bytes());
    add(
        "{ mixture = [{ weight = 0.5, material = { coated = 0.7, roughness = 0.1 } }, \
         { weight = 0.3, material = { conductor = { eta = 1.5, k = 7.6 }, roughness = 0.4, reflectance = 0.9 } }, \
         { weight = 0.2, material = { oren_nayar = 0.8, roughness = 0.5 } }] }",
        b"",
    );
    all
}

#[test]
fn every_material_is_reciprocal() {
    for (name, m) in zoo() {
        for (i, o) in directions(3000) {
            for albedo in [0.3, 1.0] {
                let (f, g) = (m.brdf(albedo, i, o), m.brdf(albedo, o, i));
                assert!(f >= 0.0 && f.is_finite(), "{name}");
                // MERL angles go through an arc tangent, whose error the slope of the table
                // magnifies.
                assert!((f - g).abs() <= 1e-9 * f.max(g), "{name}: {i} {o}: {f} {g}");
            }
            let below = DVec3::new(i.x, i.y, -i.z);
            assert_eq!(m.brdf(1.0, below, o), 0.0);
            assert_eq!(m.brdf(1.0, o, below), 0.0);
        }
    }
}

/// ∫ f cosθ dω by brute force, knowing nothing of the material: midpoints over hemispheres refined
/// around the mirror direction, as θ, φ about the half vector: ω = mirror of the incident direction
/// in h, dω = 4 |ω_i·h| dω_h, and θ_h = (π/2) x³ so that sharp lobes are met.
fn reflected(m: &Material, albedo: f64, wi: DVec3, n: usize) -> f64 {
    let mut sum = 0.0;
    for a in 0..n {
        let x = (a as f64 + 0.5) / n as f64;
        let theta = 0.5 * PI * x.powi(3);
        let slope = 1.5 * PI * x * x / n as f64;
        for b in 0..n {
            let phi = TAU * (b as f64 + 0.5) / n as f64;
            let (s, c) = theta.sin_cos();
            let h = DVec3::new(s * phi.cos(), s * phi.sin(), c);
            let cosine = wi.dot(h);
            let w = h * (2.0 * cosine) - wi;
            if cosine > 0.0 && w.z > 0.0 {
                let solid = 4.0 * cosine * s * slope * TAU / n as f64;
                sum += m.brdf(albedo, wi, w) * w.z * solid;
            }
        }
    }
    sum
}

#[test]
#[ignore = "slow"]
fn no_material_reflects_more_than_it_receives() {
    for (name, m) in zoo() {
        let mut most: f64 = 0.0;
        for mu in [1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.03, 0.01] {
            let w = slanted(mu);
            let brute = reflected(&m, 1.0, w, 500);
            let own = m.directional_albedo(1.0, w);
            most = most.max(brute);
            assert!(
                (brute - own).abs() < 2e-3,
                "{name} at {mu}: {own} beside {brute}"
            );
            assert!(own <= 1.0 + 1e-6, "{name} at {mu}: {own}");
        }
        let white = m.white_sky_albedo(1.0);
        assert!(white > 0.0 && white <= most + 2e-3, "{name}: {white}");
    }
}

/// EON returns all light at ρ = 1 (its definition); its closed reflectance at any ρ is the
/// integral.
#[test]
fn rough_matt_white_is_white() {
    let rule = Rule::gauss_legendre(128);
    for sigma in [0.0, 0.1, 0.5, 1.5] {
        let m = Material::OrenNayar(OrenNayar::new(sigma));
        let mut white = 0.0;
        for (mu, weight) in Rule::gauss_legendre(12).on(0.0, 1.0) {
            let w = slanted(mu);
            let integral =
                |albedo: f64| Lobe::cosine().integral(w, &rule, |v, _| m.brdf(albedo, w, v) * v.z);
            let e = integral(1.0);
            assert!((e - 1.0).abs() < 1e-4, "σ {sigma} μ {mu}: {e}");
            let half = integral(0.5);
            assert!((m.directional_albedo(0.5, w) - half).abs() < 1e-4);
            white += 2.0 * mu * weight * half;
        }
        assert!((m.white_sky_albedo(0.5) - white).abs() < 1e-4);
        assert!(white < 0.5 + 1e-4);
    }
}

/// The white furnace: over a ground that loses nothing, paint reflects all light at every angle, by
/// a quadrature that knows of it the BRDF alone. Below a coat that is nearly smooth a ground of ρ =
/// 0.5 reflects what Saunderson's equation says, R_e + (1 − R_e)(1 − R_i) ρ/(1 − ρ R_i) = 0.353
/// with R_e = 0.0918 and R_i = 0.5963.
#[test]
fn white_paint_is_white() {
    let rule = Rule::gauss_legendre(160);
    for (alpha, eta) in [(0.1, 1.5), (0.3, 1.5), (0.6, 1.33), (1.0, 1.5), (0.3, 4.0)] {
        let coat = Coated::new(alpha, eta, SecondFacet::Passes);
        let m = Material::Coated(Arc::new(coat));
        for mu in [1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.03, 0.01] {
            let w = slanted(mu);
            let lobe = Lobe {
                glossy: 0.5,
                ggx: Ggx::new(alpha),
            };
            let e = lobe.integral(w, &rule, |v, _| m.brdf(1.0, w, v) * v.z);
            assert!((e - 1.0).abs() < 3e-4, "α {alpha} η {eta} μ {mu}: {e}");
        }
    }
    let smooth = Material::Coated(Arc::new(Coated::new(0.01, 1.5, SecondFacet::Passes)));
    let grey = smooth.white_sky_albedo(0.5);
    assert!((grey - 0.353).abs() < 2e-3, "{grey}");
}

#[test]
fn limits() {
    let smooth = Material::OrenNayar(OrenNayar::new(0.0));
    let coat = |alpha, second| Material::Coated(Arc::new(Coated::new(alpha, 1.0 + 1e-9, second)));
    let clear = coat(0.3, SecondFacet::Absorbs);
    let open = coat(0.3, SecondFacet::Passes);
    for (i, o) in directions(1000).filter(|(i, o)| i.z > 0.05 && o.z > 0.05) {
        for albedo in [0.2, 0.9] {
            let matt = Material::Lambertian.brdf(albedo, i, o);
            assert!((smooth.brdf(albedo, i, o) - matt).abs() < 1e-15);
            // A coat of index 1 bends nothing, but its facets still hide some of the light: T =
            // G₁-weighted, not 1.
            assert!(clear.brdf(albedo, i, o) <= matt * (1.0 + 1e-9));
            assert!((open.brdf(albedo, i, o) / matt - 1.0).abs() < 1e-6);
        }
    }
    let clear = coat(0.01, SecondFacet::Absorbs);
    for (i, o) in directions(1000).filter(|(i, o)| i.z > 0.1 && o.z > 0.1) {
        let matt = Material::Lambertian.brdf(0.6, i, o);
        assert!(
            (clear.brdf(0.6, i, o) / matt - 1.0).abs() < 2e-2,
            "{}",
            clear.brdf(0.6, i, o) / matt
        );
    }
    assert_eq!(Material::Lambertian.white_sky_albedo(0.37), 0.37);
    assert_eq!(
        Material::Lambertian.directional_albedo(0.37, DVec3::Z),
        0.37
    );
}

#[test]
fn what_is_black_reflects_nothing() {
    for (name, m) in zoo() {
        for albedo in [0.0, 0.4] {
            let any = directions(300).any(|(i, o)| m.brdf(albedo, i, o) > 0.0);
            assert_eq!(any, !m.is_black(albedo), "{name} {albedo}");
        }
    }
}

/// The table as serialised before there was more than one material: the hash of a scene is taken
/// from it.
#[test]
fn a_lambertian_table_is_serialised_as_ever() {
    #[derive(serde::Deserialize, serde::Serialize)]
    struct Holder {
        material: MaterialTable,
    }
    for (text, json) in [
        (
            "{ lambertian = 0.8 }",
            "{\"material\":{\"lambertian\":0.8}}",
        ),
        (
            "{ lambertian = { ramp = [0.1, 0.2] } }",
            "{\"material\":{\"lambertian\":{\"ramp\":[0.1,0.2]}}}",
        ),
    ] {
        let holder: Holder = toml::from_str(&format!("material = {text}")).unwrap();
        assert_eq!(serde_json::to_string(&holder).unwrap(), json);
    }
}

#[test]
fn wrong_tables_are_refused_with_a_cure() {
    let part = |w: &str, m: &str| format!("{{ mixture = [{{ weight = {w}, material = {m} }}] }}");
    let cases: Vec<(String, &str)> = vec![
        ("{}".into(), "exactly one of"),
        ("{ roughness = 0.5 }".into(), "exactly one of"),
        ("{ lambertian = 0.5, coated = 0.5 }".into(), "both `lambertian` and `coated`"),
        ("{ lambertian = 0.5, roughness = 0.1 }".into(), "remove `roughness`"),
        ("{ oren_nayar = 0.5, ior = 1.3, roughness = 0.1 }".into(), "remove `ior`"),
        ("{ oren_nayar = 0.5 }".into(), "add `roughness"),
        ("{ oren_nayar = 0.5, roughness = 1.6 }".into(), "0 to 1.5708 (radians)"),
        ("{ oren_nayar = 1.5, roughness = 0.1 }".into(), "albedo 1.5"),
        ("{ coated = 0.5, roughness = 0.001 }".into(), "0.01 to 1.0000"),
        ("{ coated = 0.5, roughness = nan }".into(), "roughness of NaN"),
        ("{ coated = 0.5, roughness = 0.1, ior = 1.0 }".into(), "above 1"),
        ("{ conductor = { eta = 0, k = 1 }, roughness = 0.1 }".into(), "`eta` is 0"),
        ("{ conductor = { eta = 1 }, roughness = 0.1 }".into(), "missing field `k`"),
        ("{ measured = \"a.binary\" }".into(), "add `channel"),
        ("{ measured = \"a.csv\", channel = \"red\" }".into(), "remove `channel`"),
        ("{ measured = \"a.csv\" }".into(), "a.csv: the table is empty"),
        ("{ mixture = [] }".into(), "0 parts"),
        (part("1.1", "{ lambertian = 1 }"), "weight of 1.1"),
        (part("-0.1", "{ lambertian = 1 }"), "weight of -0.1"),
        (part("0.1", "{ lambertian = { ramp = [0, 1] } }"), "give it a number"),
        (part("0.1", &part("0.1", "{ lambertian = 1 }")), "inside a mixture"),
        (
            "{ mixture = [{ weight = 0.6, material = { lambertian = 1 } }, { weight = 0.6, material = { lambertian = 1 } }] }".into(),
            "add up to 1.2",
        ),
        ("{ lambertien = 0.5 }".into(), "unknown field"),
    ];
    for (text, words) in cases {
        let error = material(&text, b"").unwrap_err();
        assert!(error.contains(words), "{text}: {error}");
    }
    let bright = format!("theta_i,theta_o,phi,value\n0,0,0,{}\n", 1.25 / PI);
    let error = material("{ measured = \"a.csv\" }", bright.as_bytes()).unwrap_err();
    assert!(
        error.contains("1.2500") && error.contains("scale = 0.8"),
        "{error}"
    );
    assert!(material("{ measured = \"a.csv\", scale = 0.8 }", bright.as_bytes()).is_ok());
    // Of a Lambertian table of the value f the largest scale is 1/(π f), in three digits downwards:
    // 1/2857 is 3.500e-4.
    for (value, scale, reflects) in [
        (2857.0 / PI, "scale = 3.5e-4`", "reflects 2857.0 of"),
        (20.0 / PI, "scale = 0.05`", "reflects 20.000 of"),
        (1e29 / PI, "scale = 1e-29`", "reflects 1.0000e29 of"),
    ] {
        let bright = format!("theta_i,theta_o,phi,value\n0,0,0,{value:e}\n");
        let error = material("{ measured = \"a.csv\" }", bright.as_bytes()).unwrap_err();
        assert!(error.contains(scale) && error.contains(reflects), "{error}");
        let own = scale.trim_end_matches('`');
        let scaled = format!("{{ measured = \"a.csv\", {own} }}");
        assert!(material(&scaled, bright.as_bytes()).is_ok(), "{own}");
    }
    // No albedo is as little as 1e-300.
    let error = material(
        "{ measured = \"a.csv\" }",
        b"theta_i,theta_o,phi,value\n0,0,0,1e300\n",
    );
    let error = error.unwrap_err();
    assert!(
        error.contains("reflects 3.1416e300 of") && !error.contains("scale ="),
        "{error}"
    );
    let uneven = "theta_i,theta_o,phi,value\n0,0,0,0\n0,9,0,1e300\n9,0,0,1\n9,9,0,0\n";
    let error = material("{ measured = \"a.csv\" }", uneven.as_bytes()).unwrap_err();
    assert!(error.contains("1.00000 and 1.00000e300"), "{error}");
    // A peak of half a degree: 2π ∫ of its hat sinθ cosθ dθ = 2π (1.25°)(0.25°) = 5.98e-4 to 1e-3
    // of it.
    let peak = |value: f64| {
        let near = |x: f64| (x.to_degrees() - 1.25).abs() < 1e-9;
        let f = |i: f64, o: f64, _: f64| if near(i) && near(o) { value } else { 0.0 };
        let text = grid::tests::written(&[0.0, 1.0, 1.25, 1.5, 90.0], &[0.0], f);
        material("{ measured = \"a.csv\" }", text.as_bytes())
    };
    let error = peak(2000.0).unwrap_err();
    assert!(
        error.contains("reflects 1.19") && error.contains("1.25°"),
        "{error}"
    );
    assert!(peak(1600.0).is_ok());
}

/// A wall whose table lacks the half of its directions, alone or in a mixture, is suspicious; one
/// that has them all is not.
#[test]
fn a_table_that_was_not_measured_is_suspicious() {
    let folder = tempfile::tempdir().unwrap();
    let part = "{ measured = \"wall.binary\", channel = \"red\" }";
    let mixed = format!("{{ mixture = [{{ weight = 0.5, material = {part} }}] }}");
    for (lacking, material) in [(-1.0, part), (-1.0, &mixed), (0.1, part)] {
        let table = merl::tests::written(|_, _, p| if p < 0.5 * PI { 0.1 } else { lacking });
        std::fs::write(folder.path().join("wall.binary"), table).unwrap();
        let text = include_str!("../../../scenes/bench.toml");
        let text = text.replacen("{ lambertian = 0.8 }", material, 1);
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        let scene = Scene::load(&path.to_string_lossy()).unwrap();
        let told = scene.warnings().iter().any(|w| {
            let words = w.to_string();
            words.contains("table of `wall` lacks 50.0 % of the directions")
        });
        assert_eq!(told, lacking < 0.0, "{:?}", scene.warnings());
    }
}

/// θ_i, θ_o and φ in degrees as directions.
pub(super) fn pair([i, o, phi]: [f64; 3]) -> (DVec3, DVec3) {
    let (i, o, phi) = (i.to_radians(), o.to_radians(), phi.to_radians());
    let across = o.sin();
    (
        DVec3::new(i.sin(), 0.0, i.cos()),
        DVec3::new(across * phi.cos(), across * phi.sin(), o.cos()),
    )
}

/// α, η, k; θ_i, θ_o, φ; f_r by Mitsuba 3.8.0 (`roughconductor`, `distribution = "ggx"`, variant
/// `llvm_ad_mono`: single precision).
const METAL: [([f64; 3], [f64; 3], f64); 18] = [
    ([0.1, 0.2, 3.9], [0.0, 0.0, 0.0], 7.5753932),
    ([0.1, 0.2, 3.9], [30.0, 30.0, 180.0], 10.0798733),
    ([0.1, 0.2, 3.9], [30.0, 60.0, 60.0], 0.00895948242),
    ([0.1, 0.2, 3.9], [80.0, 10.0, 90.0], 0.0219825407),
    ([0.1, 0.2, 3.9], [80.0, 80.0, 180.0], 216.660449),
    ([0.1, 0.2, 3.9], [85.0, 60.0, 150.0], 0.0753893331),
    ([0.3, 1.5, 7.6], [0.0, 0.0, 0.0], 0.801313877),
    ([0.3, 1.5, 7.6], [30.0, 30.0, 180.0], 1.05177115),
    ([0.3, 1.5, 7.6], [30.0, 60.0, 60.0], 0.0593862943),
    ([0.3, 1.5, 7.6], [80.0, 10.0, 90.0], 0.111063156),
    ([0.3, 1.5, 7.6], [80.0, 80.0, 180.0], 11.0486711),
    ([0.3, 1.5, 7.6], [85.0, 60.0, 150.0], 0.266917944),
    ([1.0, 0.2, 3.9], [0.0, 0.0, 0.0], 0.0757539272),
    ([1.0, 0.2, 3.9], [30.0, 30.0, 180.0], 0.0869889561),
    ([1.0, 0.2, 3.9], [30.0, 60.0, 60.0], 0.108238131),
    ([1.0, 0.2, 3.9], [80.0, 10.0, 90.0], 0.129917387),
    ([1.0, 0.2, 3.9], [80.0, 80.0, 180.0], 0.219163992),
    ([1.0, 0.2, 3.9], [85.0, 60.0, 150.0], 0.18407391),
];

#[test]
fn metal_is_as_in_another_program() {
    for ([alpha, eta, k], angles, theirs) in METAL {
        let m = Material::Conductor(Conductor::new(alpha, eta, k));
        let (i, o) = pair(angles);
        let f = m.brdf(1.0, i, o);
        assert!(
            (f / theirs - 1.0).abs() < 1e-5,
            "α {alpha} {angles:?}: {f} for {theirs}"
        );
    }
}
