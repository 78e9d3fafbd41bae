//! What is refused of a sensor, and what is taken.

use super::super::{Scene, SceneError};
use super::*;

const BENCH: &str = include_str!("../../../scenes/bench.toml");

fn with(table: &str) -> Result<Scene, SceneError> {
    Scene::from_toml("my.toml", &format!("{BENCH}\n[sensor]\n{table}\n"))
}

#[test]
fn settings_are_read_as_written() {
    let text = "model = \"machine-vision\"\nfull_well = inf\nbits = 0\nshot_noise = false\nframes = 4\n\
                brackets = [1, 0.1]\nglare = { fraction = 1e-4, spread = { falloff = 2 } }";
    let settings = SensorSettings {
        model: Some(SensorModel::MachineVision),
        full_well: Some(f64::INFINITY),
        bits: Some(0),
        shot_noise: Some(false),
        frames: Some(4),
        brackets: Some(vec![1.0, 0.1]),
        glare: Some(Glare {
            fraction: 1e-4,
            spread: Spread::Falloff(2.0),
        }),
        ..SensorSettings::default()
    };
    assert_eq!(with(text).unwrap().sensor, Some(settings));
    let uniform = with("glare = { fraction = 0.5, spread = \"uniform\" }").unwrap();
    assert_eq!(
        uniform.sensor.unwrap().glare.unwrap().spread,
        Spread::Uniform
    );
    for model in SensorModel::ALL {
        let scene = with(&format!("model = \"{}\"", model.name())).unwrap();
        assert_eq!(scene.sensor.unwrap().model, Some(model));
    }
}

/// A sensor does not change the light, and so not the hash of what was rendered.
#[test]
fn a_sensor_does_not_change_the_hash() {
    let bare = Scene::from_toml("my.toml", BENCH).unwrap();
    assert!(bare.sensor.is_none());
    assert_eq!(with("model = \"ccd\"").unwrap().hash, bare.hash);
}

#[test]
fn senseless_settings_are_refused_where_they_stand() {
    for (line, cause, cure) in [
        (
            "quantum_efficiency = 0",
            "quantum_efficiency = 0",
            "above 0",
        ),
        ("quantum_efficiency = 1.1", "1.1", "up to 1"),
        ("dark_current = -1", "-1", "0 or more"),
        ("full_well = 0", "full_well = 0", "inf"),
        ("full_well = nan", "NaN", "positive"),
        ("read_noise = inf", "inf", "0 or more"),
        ("gain = 0", "gain = 0", "per count"),
        ("bits = 25", "bits = 25", "1 to 24"),
        ("bits = -1", "invalid value", ""),
        ("offset = -5", "-5", "0 or more"),
        ("relative_noise = 1", "relative_noise = 1", "below 1"),
        ("exposure = 0", "exposure = 0", "positive time"),
        ("frames = 0", "frames = 0", "1 to"),
        ("dark_frames = 2000000", "2000000", "0 to"),
        ("brackets = []", "0 exposure times", "1 to 16"),
        ("brackets = [1, 0]", "time 0 s", "positive"),
        ("ambient = -1e-15", "ambient", "W"),
        (
            "glare = { fraction = 2, spread = \"uniform\" }",
            "fraction = 2",
            "0 to 1",
        ),
        (
            "glare = { fraction = 0.1, spread = { falloff = 0 } }",
            "falloff = 0",
            "length",
        ),
        (
            "glare = { fraction = 0.1, spread = \"unifrom\" }",
            "unknown variant",
            "`uniform`",
        ),
        ("glare = { fraction = 0.1 }", "missing field", "spread"),
        ("model = \"cdc\"", "unknown variant", "`ccd`"),
        (
            "quantum_eficiency = 0.5",
            "unknown field",
            "`quantum_efficiency`",
        ),
        ("shot_noise = 1", "invalid type", ""),
    ] {
        let error = with(line).unwrap_err();
        assert_eq!(error.place.as_ref().unwrap().text, line, "{error}");
        assert!(error.cause.contains(cause), "{error}");
        assert!(error.cure.contains(cure), "{error}");
    }
    let both = with("exposure = 1\nbrackets = [1, 2]").unwrap_err();
    assert!(both.cause.contains("both"), "{both}");
    assert!(both.place.unwrap().text.starts_with("brackets"));
}
