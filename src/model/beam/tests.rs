use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2};

use super::*;

/// Beams of a spot at the origin, and of two at its sides, past a plate from x = `from` on, so
/// `wide`, half way up.
fn past_plate(profile: &str, from: f64, wide: f64) -> Scene {
    let text = format!(
        "name = \"cut\"\nunit = \"in\"\nmax_bounces = 3\n\
         [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [0, 0, 10]\n\
         spot_diameter = 1.0\nprofile = \"{profile}\"\n\
         spots = {{ layout = \"list\", points = [[0, 0], [-9, 1], [9, 0]] }}\n\
         [camera]\nposition = [-20, 2, 10]\naperture_area = 0.05\npixels = [2, 2]\n\
         view = {{ x = [-3, -2], y = [-1, 1] }}\n\
         [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
         rectangle = {{ corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0] }}\n\
         [[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
         rectangle = {{ corner = [{from}, -20, 5], u = [{wide}, 0, 0], v = [0, 40, 0] }}\n\
         material = {{ lambertian = 0.0 }}\n"
    );
    Scene::from_toml("cut", &text).unwrap()
}

/// Light of a spot, and its moment along x.
fn power(spot: &[Lit], of: fn(&Lit) -> WallPoint) -> [f64; 2] {
    let each = || spot.iter().map(of);
    let moment = |w: WallPoint| w.weight * w.position.x;
    [each().map(|w| w.weight).sum(), each().map(moment).sum()]
}

/// Share of a spot of diameter 1 below x = e.
fn below(profile: &str, e: f64) -> f64 {
    let r = 0.5f64;
    if profile == "gaussian" {
        return 0.5 * libm::erfc(-e / (0.5 * r) * FRAC_1_SQRT_2);
    }
    let e = e.clamp(-r, r);
    0.5 + (e * (r * r - e * e).sqrt() / (r * r) + libm::asin(e / r)) * FRAC_1_PI
}

/// A plate half way up whose shadow ends at x = e: of a disc of radius r it leaves
/// ½ + (e √(r² − e²)/r² + asin(e/r))/π, of a Gaussian of 1/e² radius w what is below e of a
/// normal distribution of deviation w/2; wherever e lies, to 1e-4, though a node is 3 %. The
/// middle of what is left is that of the light below e, −⅔ (r² − e²)^1.5/(π r²) and −w/√(8π)
/// e^(−2e²/w²) over it.
#[test]
fn a_beam_loses_what_an_edge_cuts_off() {
    for e in [-0.41, -0.2, -0.013, 0.0, 0.07, 0.33, 0.47] {
        for profile in ["disc", "gaussian"] {
            let all = reached(&past_plate(profile, 0.5 * e, 20.0), 4);
            let shares: Vec<f64> = all
                .iter()
                .map(|spot| power(spot, |l| l.left)[0] / power(spot, |l| l.whole)[0])
                .collect();
            let r = 0.5f64;
            let rest = r * r - e * e;
            let want = below(profile, e);
            let moment = if profile == "disc" {
                -2.0 / 3.0 * rest.powf(1.5) / (r * r) * FRAC_1_PI
            } else {
                let x = e / (0.5 * r);
                -0.5 * r * libm::exp(-0.5 * x * x) / TAU.sqrt()
            };
            let off = (shares[0] - want).abs();
            assert!(off < 1e-4, "{profile} {e}: {} for {want}", shares[0]);
            let [left, along] = power(&all[0], |l| l.left);
            let off = (along / left * want - moment).abs();
            assert!(
                off < 1e-4,
                "{profile} {e}: {} for {moment}",
                along / left * want
            );
            assert_eq!(shares[1..], [1.0, 0.0], "{profile} {e}");
        }
    }
}

/// A wire whose shadow is 0.01 wide, a fiftieth of the spot, takes what lies in it, wherever it
/// crosses: to a twentieth of that.
#[test]
fn a_wire_takes_what_lies_in_its_shadow() {
    for profile in ["disc", "gaussian"] {
        for e in [-0.31, -0.004, 0.1, 0.237] {
            let all = reached(&past_plate(profile, 0.5 * e, 0.005), 4);
            let share = power(&all[0], |l| l.left)[0] / power(&all[0], |l| l.whole)[0];
            let want = below(profile, e + 0.01) - below(profile, e);
            let off = (1.0 - share) / want - 1.0;
            assert!(
                off.abs() < 0.05,
                "{profile} {e}: {} for {want}",
                1.0 - share
            );
        }
    }
}
