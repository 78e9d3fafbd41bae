use crate::lab::comparison::misplaced::normal;
use crate::lab::study::tests::small;
use crate::lab::{Against, Certainty, Integration, Measured, Test, validate};
use crate::model::{Extent, Kernel, Occlusion, converged};
use crate::scene::{Parameter, Profile};

/// Photographs of wider spots, of a rougher wall and of another coat, noise of 1e-3: the verdict
/// has each among its likely causes, with its size within 3.5 stated errors.
#[test]
fn what_spreads_light_is_a_cause() {
    let mut scene = small("satin");
    scene.laser.profile = Profile::Disc { radius: 0.75 };
    for (name, parameter, size) in [
        ("diameter of the spots", "laser.spot_diameter", 40.0),
        ("roughness of the wall", "wall.roughness", 10.0),
        ("n − 1 of the wall's coat", "wall.ior", -6.0),
    ] {
        let own = Parameter::named(&scene, parameter).unwrap();
        let there = scene.displaced(&own, &[size]).unwrap();
        let light = converged(&there, Kernel::Physical, Extent::FULL)
            .unwrap()
            .phi;
        let stderr = &light * 1e-3;
        let mut random = normal(4);
        let noisy = light.zip_map(&stderr, |x, s| x + s * random()[0]);
        let against = Against {
            kernel: Kernel::Physical,
            integration: Integration::Quadrature,
            occlusion: Occlusion::Ignored,
        };
        let test = Test {
            significance: 1e-3,
            known: Certainty::STATED,
        };
        let measured = Measured::new(&noisy, &stderr, None);
        let found = validate(&scene, measured, against, test).unwrap().agreement;
        assert!(!found.agrees, "{name}");
        let likely = found.score.unwrap().likely;
        let own = likely.iter().find(|d| d.name == name);
        let own = own.unwrap_or_else(|| panic!("{name}: {likely:?}"));
        let off = (own.value - size) / own.stderr;
        assert!(off.abs() <= 3.5, "{name}: {} ± {}", own.value, own.stderr);
    }
}
