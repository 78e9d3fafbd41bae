use crate::model::cut::Cut;
use crate::model::extent::{Extent, Take};
use crate::model::{Kernel, converged};
use crate::scene::Scene;

/// Spots at the origin and beside it, on walls of these rectangles and albedos.
fn scene(profile: &str, walls: &[(&str, f64)]) -> Scene {
    let walls: Vec<String> = walls
        .iter()
        .enumerate()
        .map(|(k, (rectangle, albedo))| {
            format!(
                "[[surface]]\nname = \"wall {k}\"\nrole = \"relay\"\n\
                 rectangle = {{ {rectangle} }}\nmaterial = {{ lambertian = {albedo} }}\n"
            )
        })
        .collect();
    let text = format!(
        "name = \"seam\"\nunit = \"in\"\nmax_bounces = 3\n\
         [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [-20, 10, 15]\n\
         spot_diameter = 0.5\nprofile = \"{profile}\"\n\
         [laser.spots]\nlayout = \"list\"\npoints = [[0, 0], [-0.1, 1]]\n\
         [camera]\nposition = [-20, 10, 15]\naperture_area = 0.05\npixels = [2, 1]\n\
         view = {{ x = [-3.25, -1.5], y = [-2.75, -1.0] }}\n{}\
         [[surface]]\nname = \"object\"\nrole = \"hidden\"\nelements = [2, 2]\n\
         rectangle = {{ corner = [-2, 4, 4], u = [4, 0, 0], v = [0, -2, 2] }}\n\
         material = {{ lambertian = 0.7 }}\n",
        walls.concat()
    );
    Scene::from_toml("seam", &text).unwrap()
}

/// A wall in two parts is lit as the wall is, wherever across a spot they meet and along whatever
/// line; and a dark part loses what the other does not have.
#[test]
fn a_wall_in_two_parts_is_one_wall() {
    let extent = Extent {
        footprints: Take::Centre,
        ..Extent::UNOBSTRUCTED
    };
    let of = |profile: &str, walls: &[(&str, f64)]| {
        let found = converged(&scene(profile, walls), Kernel::Physical, extent).unwrap();
        assert!(found.worst().is_none_or(|(_, off)| off < 1e-7));
        found.phi
    };
    for profile in ["disc", "gaussian"] {
        let one = "corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0]";
        let whole = of(profile, &[(one, 0.8)]);
        for [left, right] in [
            [
                "corner = [-30, -30, 0], u = [30, 0, 0], v = [0, 60, 0]",
                "corner = [0, -30, 0], u = [30, 0, 0], v = [0, 60, 0]",
            ],
            [
                "corner = [-30, -30, 0], u = [29.95, 0, 0], v = [0, 60, 0]",
                "corner = [-0.05, -30, 0], u = [30, 0, 0], v = [0, 60, 0]",
            ],
            [
                "corner = [-39, -30, 0], u = [30, 0, 0], v = [18, 60, 0]",
                "corner = [-9, -30, 0], u = [30, 0, 0], v = [18, 60, 0]",
            ],
        ] {
            let near = |found: &crate::matrix::Matrix| {
                let off = (found - &whole).component_div(&whole).amax();
                assert!(off < 1e-7, "{profile} {left}: {off:e}");
            };
            near(&of(profile, &[(left, 0.8), (right, 0.8)]));
            let [bright, dark] =
                [[0.8, 0.0], [0.0, 0.8]].map(|[a, b]| of(profile, &[(left, a), (right, b)]));
            // The camera sees the left part alone.
            assert!(dark.amax() == 0.0 && bright.amin() > 0.0);
            let [some, more] =
                [0.3, 0.6].map(|albedo| of(profile, &[(left, 0.8), (right, albedo)]));
            near(&(&bright + (&more - &some) * (0.8 / 0.3)));
            near(&(&bright + (&some - &bright) * (0.8 / 0.3)));
        }
    }
}

/// The cells of a wall's texture are walls of their own, wherever spots and pixels lie across them;
/// of a checkerboard so fine that nothing is cut along it, which lights as a wall of its mean
/// albedo does, the bound says how far the rule is off.
#[test]
fn cells_of_a_texture_are_walls() {
    let one = "corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0]";
    let quarters = [(-30, -30, 0.2), (0, -30, 0.8), (-30, 0, 0.5), (0, 0, 0.3)];
    let rectangles: Vec<String> = quarters
        .iter()
        .map(|(x, y, _)| format!("corner = [{x}, {y}, 0], u = [30, 0, 0], v = [0, 30, 0]"))
        .collect();
    let walls: Vec<(&str, f64)> = (0..4)
        .map(|k| (rectangles[k].as_str(), quarters[k].2))
        .collect();
    let across = |scene: &Scene, albedo: &str| {
        let view = "x = [-3.25, -1.5], y = [-2.75, -1.0]";
        let text = scene
            .text
            .replacen(view, "x = [-1.0, 0.7], y = [-0.4, 0.9]", 1)
            .replacen("lambertian = 0.11", &format!("lambertian = {albedo}"), 1);
        let scene = Scene::from_toml("seam", &text).unwrap();
        let jumps = Cut::new(&scene, Extent::UNOBSTRUCTED).jumps(4).concat();
        let found = converged(&scene, Kernel::Physical, Extent::UNOBSTRUCTED);
        (found.unwrap(), jumps)
    };
    for profile in ["disc", "gaussian"] {
        let (walls, _) = across(&scene(profile, &walls), "");
        let plain = scene(profile, &[(one, 0.11)]);
        let (cells, none) = across(&plain, "{ cells = [[0.2, 0.8], [0.5, 0.3]] }");
        assert!(none.iter().all(|jump| *jump == 0.0), "{none:?}");
        assert!(cells.worst().unwrap().1 < 1e-6, "{:?}", cells.worst());
        for (a, b) in cells.phi.iter().zip(&walls.phi) {
            assert!((a - b).abs() < 1e-7 * b, "{profile}: {a:e} {b:e}");
        }
        let fine = "{ checkerboard = [3999, 3999], dark = 0.2, light = 0.6 }";
        let [(fine, jumps), (mean, _)] = [fine, "0.4"].map(|albedo| across(&plain, albedo));
        // 2 (0.6 − 0.2)/0.4 over the root of 16 to 1000 nodes, the mean to a tenth.
        assert!(
            jumps.iter().all(|jump| (0.05..0.55).contains(jump)),
            "{jumps:?}"
        );
        for k in 0..fine.phi.len() {
            let off = (fine.phi[k] - mean.phi[k]).abs();
            assert!(off > mean.bound[k] && off < fine.bound[k], "{profile} {k}");
        }
    }
}
