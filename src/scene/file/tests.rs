//! A scene made in code is the one read from its text.

use super::super::{Scene, builtins};
use super::*;

/// A file that is written and read again means the same scene, known answers and sensor too.
#[test]
fn a_scene_made_in_code_is_the_one_read_from_its_text() {
    for builtin in builtins().iter().filter(|b| b.name != "room") {
        let mut file = SceneFile::builtin(builtin.name).unwrap();
        let own = Scene::load(builtin.name).unwrap();
        let made = Scene::new(&file, None).unwrap();
        assert_eq!(made.hash, own.hash, "{}", builtin.name);
        assert_eq!((&made.known, &made.sensor), (&own.known, &own.sensor));
        assert_eq!(
            Scene::from_toml("again", &made.text).unwrap().hash,
            own.hash
        );

        let Some(laser) = &mut file.laser else {
            continue;
        };
        laser.power *= 2.0;
        assert_ne!(Scene::new(&file, None).unwrap().hash, own.hash);
    }
}

/// An error of a scene made in code names the line of the text that it would be written as.
#[test]
fn what_is_wrong_is_found_in_the_written_text() {
    let mut file = SceneFile::default();
    file.laser.as_mut().unwrap().power = -1.0;
    let error = Scene::new(&file, None).unwrap_err();
    assert_eq!(error.place.unwrap().text, "power = -1.0");
    assert!(error.cause.contains("-1 W"));
}
