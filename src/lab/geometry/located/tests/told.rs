//! What is said of places that photographs do not tell, and of errors.

use super::*;
use crate::lab::comparison::misplaced;
use crate::lab::finding::Describe;
use crate::lab::uncertainty::certainty::Errors;
use crate::scene::Role;
use crate::scene::file::{Layout, SpotsTable, SurfaceTable};

/// A shift within the plane of a flat surface moves its picture: what photographs do not tell from
/// another picture is refused.
#[test]
fn a_shift_of_the_picture_is_refused() {
    let scene = bench();
    let (phi, stderr) = photographed(&scene, 1e-2, 7);
    let photographs = Unexplained {
        phi: &phi,
        stderr: Some(&stderr),
        certainty: Certainty::STATED,
        left_out: None,
        patterns: None,
    };
    for what in ["u", "v"] {
        let plan = LocatedPlan {
            what,
            ..by_centres([-1.0, 1.0], 0)
        };
        let refused = plan.locate(&scene, &photographs, Control::none());
        let refused = refused.unwrap_err().to_string();
        assert!(
            refused.contains("where on them the picture lies"),
            "{refused}"
        );
    }
    // Of two faces in different planes only along the edge that both have.
    let faces = Scene::load("scenes/known/two-faces.toml").unwrap();
    for (what, is_within) in [("u", true), ("v", false), ("normal", false)] {
        let plan = LocatedPlan {
            what,
            ..plan([0.0; 2], 0)
        };
        let altered = plan.misplaced().unwrap();
        assert_eq!(altered.is_of_the_picture(&faces), is_within, "{what}");
    }
}

/// Where within an element the light lies no photograph says: bright parts that end within
/// elements have their middles within three stated errors, and none is stated finer than an element
/// is, a side over √12.
#[test]
fn a_bright_part_is_known_no_finer_than_its_elements() {
    let scene = bench();
    let fine = LocatedPlan {
        elements: Some([8, 8]),
        ..by_centres([-0.2, 0.2], 0)
    };
    let model = fine.model(&scene).unwrap();
    for (us, vs) in [(1..4, 2..5), (4..8, 5..7), (3..4, 3..4)] {
        let bright = |j: usize| us.contains(&(j % 8)) && vs.contains(&(j / 8));
        let own: Vec<usize> = (0..64).filter(|j| bright(*j)).collect();
        let albedo: Vec<f64> = (0..64).map(|j| if bright(j) { 0.8 } else { 0.0 }).collect();
        let clean = model.phi_of(&albedo);
        let sigma = 2e-3 * clean.norm() / (clean.len() as f64).sqrt();
        let phi = &clean + noise(clean.nrows(), clean.ncols(), 3) * sigma;
        let stderr = clean.map(|_| sigma);
        for elements in [4, 8] {
            let plan = LocatedPlan {
                elements: Some([elements; 2]),
                ..fine
            };
            let found = located(&scene, &phi, &stderr, plan);
            let found = found.picture.unwrap().bright.unwrap();
            let error = found.stderr.unwrap();
            let side = 4.0 / elements as f64;
            assert!(error[0] >= 0.99 * side / 12f64.sqrt(), "{error:?}");
            for (k, error) in error.into_iter().enumerate() {
                let truth = own.iter().map(|j| model.places[*j][k]).sum::<f64>() / own.len() as f64;
                let off = (found.middle[k] - truth) / error;
                assert!(off.abs() < 3.0, "{us:?} {vs:?} {elements} {k}: {off}");
            }
        }
    }
}

/// Two bright corners have their common middle where nothing is: that they are two is said, and of
/// one board not.
#[test]
fn a_bright_part_in_pieces_is_told() {
    let scene = bench();
    let plan = LocatedPlan {
        elements: Some([4, 4]),
        ..by_centres([-0.2, 0.2], 0)
    };
    let model = plan.model(&scene).unwrap();
    for (bright, pieces) in [(vec![0, 15], 2), (vec![5, 6, 9, 10], 1)] {
        let albedo = |j: usize| if bright.contains(&j) { 0.8 } else { 0.0 };
        let albedo: Vec<f64> = (0..16).map(albedo).collect();
        let phi = model.phi_of(&albedo);
        let sigma = 1e-3 * phi.norm() / (phi.len() as f64).sqrt();
        let stderr = phi.map(|_| sigma);
        let phi = &phi + noise(phi.nrows(), phi.ncols(), 3) * sigma;
        let found = located(&scene, &phi, &stderr, plan);
        let notes = found.describe().notes.concat();
        assert_eq!(found.picture.unwrap().bright.unwrap().pieces, pieces);
        assert_eq!(notes.contains("PIECES"), pieces > 1, "{notes}");
    }
}

/// Errors that entries share are the same in every frame, so that none left out shows them.
#[test]
fn errors_that_hang_together_are_told() {
    let scene = bench();
    let (phi, stderr) = photographed(&scene, 1e-2, 9);
    for errors in Errors::ALL {
        let photographs = Unexplained {
            phi: &phi,
            stderr: Some(&stderr),
            certainty: Certainty::new(errors, None),
            left_out: None,
            patterns: None,
        };
        let plan = by_centres([-0.5, 0.5], 0);
        let found = plan.locate(&scene, &photographs, Control::none()).unwrap();
        let notes = found.describe().notes.concat();
        let is_shared = errors != Errors::Independent;
        assert_eq!(notes.contains("HANG TOGETHER"), is_shared, "{notes}");
    }
}

/// Spots, view and camera on the line x = 5, about which the hidden surface is symmetric: turned to
/// the left it makes the photographs that it makes turned to the right, and both are told; where
/// the range holds one alone, that is found.
#[test]
fn places_that_make_the_same_photographs_are_told() {
    let mut file = SceneFile::default();
    let laser = file.laser.as_mut().unwrap();
    laser.position[0] = 5.0;
    laser.spots = SpotsTable {
        layout: Layout::List,
        points: Some((0..16).map(|k| [5.0, 1.2 + 0.48 * f64::from(k)]).collect()),
        ..SpotsTable::default()
    };
    file.camera.position[0] = 5.0;
    file.camera.view.x = [3.5, 6.5];
    file.camera.pixels = [1, 12];
    let scene = Scene::new(&file, None).unwrap();
    let yaw = misplaced::ALL.iter().find(|m| m.name == "yaw of S2");
    let plan = |range: [f64; 2]| LocatedPlan {
        what: "yaw",
        steps: 13,
        elements: Some([1, 3]),
        ..by_centres(range, 0)
    };
    for turned in [12.0, -12.0] {
        let truth = yaw.unwrap().apply(&scene, turned).unwrap();
        let clean = plan([0.0; 2])
            .model(&truth)
            .unwrap()
            .phi_of(&[0.8, 0.3, 0.6]);
        let stderr = clean.map(|_| 2e-3 * clean.mean());
        let phi = &clean + noise(clean.nrows(), clean.ncols(), 4).component_mul(&stderr);
        let both = located(&scene, &phi, &stderr, plan([-20.0, 20.0]));
        let size = both.size.unwrap();
        let [other] = both.elsewhere[..] else {
            panic!("{:?}", both.elsewhere);
        };
        let error = both.stderr().unwrap();
        let off = [size, other.size].map(|at| (at.abs() - 12.0) / error);
        let both_ways = size * other.size < 0.0;
        assert!(
            both_ways && off.iter().all(|off| off.abs() < 3.0),
            "{off:?} {error}"
        );
        assert!(!both.is_found() && both.describe().sentence.contains("do NOT TELL"));
        let range = [turned.min(0.0) * 2.0, turned.max(0.0) * 2.0];
        let one = located(&scene, &phi, &stderr, plan(range));
        let off = (one.size.unwrap() - turned) / one.stderr().unwrap();
        assert!(
            one.is_found() && off.abs() < 3.0,
            "{off} {:?}",
            one.elsewhere
        );
    }
}

/// A surface that the scene has 0.8 or 1.25 times as large as it is: that it is likelier with the
/// right size is told, and of that size nothing.
#[test]
fn another_size_of_the_surface_is_told() {
    let right = bench();
    let middle = right.hidden().next().unwrap().1.shape.at([0.5; 2]).position;
    let by = |factor: f64| {
        let motion = glam::DAffine3::from_translation(middle)
            * glam::DAffine3::from_scale(glam::DVec3::splat(factor))
            * glam::DAffine3::from_translation(-middle);
        right.with_moved_hidden(&motion).unwrap()
    };
    let plan = LocatedPlan {
        elements: Some([5; 2]),
        ..by_centres([-1.5, 1.5], 0)
    };
    let rho: Vec<f64> = (0..25).map(|k| 0.5 + 0.05 * f64::from(k % 5)).collect();
    let clean = plan.model(&right).unwrap().phi_of(&rho);
    let stderr = clean.map(|x| 2e-3 * x);
    let phi = &clean + noise(clean.nrows(), clean.ncols(), 5).component_mul(&stderr);
    let of = |factor: f64| located(&by(factor), &phi, &stderr, plan);
    let (own, small, large) = (of(1.0), of(0.8), of(1.25));
    assert!(own.is_found() && own.resized.is_none(), "{:?}", own.resized);
    for (found, factor) in [(small, 1.25), (large, 0.8)] {
        let other = found.resized.as_ref().unwrap();
        assert_eq!(other.factor, factor);
        let off = (other.values[0] - own.size.unwrap()) / own.stderr().unwrap();
        assert!(
            off.abs() < 1.0 && other.log_likelier > 5.0,
            "{off} {other:?}"
        );
        let told = found.describe();
        let all = told.sentence + &told.notes.concat();
        assert!(all.contains("may have its size WRONG"), "{all}");
    }
}

/// Without a stated noise too it is told that what is left of neighbouring pixels hangs together,
/// as where the surface is turned; of noise of each pixel alone nothing.
#[test]
fn what_hangs_together_is_told_without_a_stated_noise() {
    let scene = bench();
    let yaw = misplaced::ALL.iter().find(|m| m.name == "yaw of S2");
    let plan = LocatedPlan {
        elements: Some([2; 2]),
        steps: 7,
        ..by_centres([-1.5, 1.5], 0)
    };
    for (turned, is_told) in [(0.0, false), (40.0, true)] {
        let there = yaw.unwrap().apply(&scene, turned).unwrap();
        let clean = plan.model(&there).unwrap().phi_of(&[0.9, 0.2, 0.3, 0.8]);
        let level = 5e-3 * clean.mean();
        let phi = &clean + noise(clean.nrows(), clean.ncols(), 9) * level;
        let photographs = Unexplained {
            phi: &phi,
            stderr: None,
            certainty: Certainty::STATED,
            left_out: None,
            patterns: None,
        };
        let found = plan.locate(&scene, &photographs, Control::none()).unwrap();
        let notes = found.describe().notes.concat();
        let told = notes.contains("hangs together from pixel to pixel");
        assert_eq!(told, is_told, "{:?} {notes}", found.neighbours);
        assert_eq!(found.neighbours.is_some(), is_told);
    }
}

/// Of two hidden surfaces it is said that both are moved, of which one the middle is told, and how
/// each alone is looked for; of one nothing.
#[test]
fn surfaces_that_are_moved_together_are_named() {
    let mut file = SceneFile::default();
    file.laser.as_mut().unwrap().spots.per_side = Some(3);
    file.camera.pixels = [8, 8];
    let first = file
        .surface
        .iter()
        .find(|s| s.role == Role::Hidden)
        .unwrap()
        .clone();
    let (phi, stderr) = photographed(&Scene::new(&file, None).unwrap(), 1e-2, 7);
    let plan = LocatedPlan {
        elements: Some([2; 2]),
        ..by_centres([-1.0, 1.0], 0)
    };
    let told = |file: &SceneFile| {
        let scene = Scene::new(file, None).unwrap();
        located(&scene, &phi, &stderr, plan).describe().sentence
    };
    assert!(!told(&file).contains("hidden surfaces"));
    let mut second = SurfaceTable {
        name: "beside".to_owned(),
        ..first.clone()
    };
    let corner = &mut second.rectangle.as_mut().unwrap().corner;
    (corner[0], corner[2]) = (corner[0] + 3.0, corner[2] + 1.0);
    file.surface.push(second);
    let words = told(&file);
    for due in [
        format!("the middle of `{}` is then at", first.name),
        "All 2 hidden surfaces are moved, as one body".to_owned(),
        format!("--free {}.normal,beside.normal", first.name),
    ] {
        assert!(words.contains(&due), "{words}");
    }
}
