//! Light of the spot in the lens.

use phicam::scene::{Glare, Scene, Spread};
use phicam::sensor::{entering_lens, glare};

/// Φlaser·(ρ/π)·cos²θ·A/R² of the bench, where laser and lens stand 15 in. before the wall and look
/// along its normal.
#[test]
fn the_spot_lights_the_lens_as_the_closed_form_says() {
    let scene = Scene::load("bench").unwrap();
    for (flux, spot) in entering_lens(&scene).iter().zip(&scene.laser.spots) {
        let [x, y, _] = spot.target.position.to_array();
        let r2 = (x + 20.0) * (x + 20.0) + (y - 10.0) * (y - 10.0) + 225.0;
        let exact = 5e-3 * 0.8 / std::f64::consts::PI * (225.0 / r2) * 0.05 / r2;
        assert!((flux / exact - 1.0).abs() < 1e-13, "{flux} {exact}");
    }
}

#[test]
fn scattered_light_is_the_stated_part_and_falls_off_as_stated() {
    let scene = Scene::load("bench").unwrap();
    let entering = entering_lens(&scene);
    for spread in [Spread::Uniform, Spread::Falloff(0.7)] {
        let fraction = 1e-3;
        let scattered = glare(&scene, Glare { fraction, spread });
        for (l, all) in entering.iter().enumerate() {
            let column = scattered.column(l);
            assert!((column.sum() / (fraction * all) - 1.0).abs() < 1e-13);
            let Spread::Falloff(d0) = spread else {
                assert!(column.iter().all(|x| *x == column[0]));
                continue;
            };
            // The spots lie in the view's plane, so that each is its own image. Pixels of 3.25/16
            // in.
            let spot = scene.laser.spots[l].target.position;
            let law = |column: usize, row: usize| {
                let centre = |i: usize, low: f64| low + (i as f64 + 0.5) * 3.25 / 16.0;
                let (dx, dy) = (centre(column, 3.25) - spot.x, centre(row, 2.75) - spot.y);
                d0 * d0 / (d0 * d0 + dx * dx + dy * dy)
            };
            for (c, r) in [(0, 0), (15, 0), (3, 14)] {
                let ratio = column[c + 16 * r] / column[7 + 16 * 7];
                assert!((ratio / (law(c, r) / law(7, 7)) - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// A board in the beam: its back is black; its front is what the lens sees instead.
#[test]
fn what_stands_in_the_beam_is_lit_in_place_of_the_wall() {
    let board = |edges: &str| {
        let bench = Scene::load("bench").unwrap().text;
        let text = format!(
            "{bench}\n[[surface]]\nname = \"board\"\nrole = \"occluder\"\n\
             rectangle = {{ corner = [-15.5, 0, 12], {edges} }}\nmaterial = {{ lambertian = 0.5 }}\n"
        );
        Scene::from_toml("board", &text).unwrap_or_else(|e| panic!("{e}"))
    };
    // Every beam passes (x, y, 12) with x = −20 + 0.2·(20 + x_spot), from −16 to −14: the board
    // covers part of them.
    let back = board("u = [0, 20, 0], v = [2, 0, 0]");
    let front = board("u = [2, 0, 0], v = [0, 20, 0]");
    let free = entering_lens(&Scene::load("bench").unwrap());
    let (dark, bright) = (entering_lens(&back), entering_lens(&front));
    let mut met = 0;
    for (l, spot) in front.laser.spots.iter().enumerate() {
        let [x, y, _] = spot.target.position.to_array();
        let (bx, by) = (-20.0 + 0.2 * (x + 20.0), 10.0 + 0.2 * (y - 10.0));
        if !(-15.5..=-13.5).contains(&bx) {
            assert_eq!((dark[l], bright[l]), (free[l], free[l]));
            continue;
        }
        met += 1;
        let r2 = (bx + 20.0) * (bx + 20.0) + (by - 10.0) * (by - 10.0) + 9.0;
        let exact = 5e-3 * 0.5 / std::f64::consts::PI * (9.0 / r2) * 0.05 / r2;
        assert_eq!(dark[l], 0.0);
        assert!(
            (bright[l] / exact - 1.0).abs() < 1e-9,
            "{} {exact}",
            bright[l]
        );
    }
    assert!(met > 10 && met < free.len(), "{met}");
}
