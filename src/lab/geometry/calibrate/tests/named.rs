//! What is named first, and how a picture of a free scale is drawn.

use super::*;

/// Of hinge, view and eighteen shifts of single spots, of which one is far off, the hidden surface
/// comes first, then the view, then that spot alone, and how many more there are. Photographs in
/// another unit give the same drawing: over its brightest element, of which the errors are told.
#[test]
fn few_unknowns_are_named_and_how_many_more_there_are() {
    let mut file = SceneFile::builtin("bench").unwrap();
    file.camera.pixels = [8; 2];
    let spots: Vec<[f64; 2]> = (0..9)
        .map(|k| [1.0 + f64::from(k), if k % 2 == 0 { 2.0 } else { 8.0 }])
        .collect();
    let scene = Scene::new(&file, None)
        .unwrap()
        .with_spots_at(&spots)
        .unwrap();
    let far = Parameter::named(&scene, "spots.7.x").unwrap();
    let there = scene.displaced(&far, &[0.5]).unwrap();
    let (phi, stderr) = photographs(&there, 2, 1e-2, 3);
    let free = [("spots.each", 0.1), ("view.x", 0.01), ("hinge.angle", 0.1)];
    let free = free.map(|(name, sigma)| Free {
        name: name.to_owned(),
        sigma: Some(sigma),
    });
    let plan = CalibrationPlan {
        free: free.to_vec(),
        is_scale_free: true,
        ..plan(&[], 2)
    };
    let by = |unit: f64| {
        let (phi, stderr) = (&phi * unit, &stderr * unit);
        let found = plan.calibrate(&scene, &unexplained(&phi, &stderr), Control::none());
        found.unwrap()
    };
    let found = by(1e6);
    let told = found.describe();
    let names: Vec<&str> = told
        .sentence
        .split_whitespace()
        .filter(|word| found.found.iter().any(|f| f.name == *word))
        .collect();
    assert!(
        names[..3] == ["hinge.angle", "view.x", "spots.7.x"],
        "{names:?}"
    );
    let single = found.found.iter().filter(|f| f.name.starts_with("spots."));
    let near = single.filter(|f| f.value.abs() <= 3.0 * f.stderr).count();
    let rest = format!("{near} of single spots within 3 of their errors");
    assert!(
        names.len() == 20 - near && told.sentence.contains(&rest),
        "{}",
        told.sentence
    );
    let pictures = &told.galleries[0].pictures;
    let brightest = pictures[0].values.iter().fold(0.0, |a: f64, b| a.max(*b));
    assert!((brightest - 1.0).abs() < 1e-12, "{brightest}");
    let grid = &found.grids[0];
    for (k, drawn) in pictures[1].values.iter().enumerate() {
        let relative = |k: usize| pictures[0].values[k] / grid.values[k];
        assert!(
            (drawn - grid.stderr[k] * relative(k)).abs() < 1e-9 * drawn,
            "{k}"
        );
    }
    assert!(
        told.galleries[0]
            .title
            .contains("over its brightest element")
    );
}
