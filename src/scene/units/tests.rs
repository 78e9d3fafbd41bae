use super::*;
use crate::scene::Scene;

/// A scene with a key of every dimension, whose unit is in; `pick` says which of a number without
/// unit and the same value with one is written.
fn scene(pick: impl Fn(&'static str, &'static str) -> &'static str) -> String {
    format!(
        r#"
name = "units"
unit = "in"
max_bounces = 3
laser = {{ power = {power}, wavelength = {wavelength}, position = {position}, spot_diameter = {diameter}, spots = {{ layout = "ring", centre = {centre}, radius = {radius}, count = 3, start_angle = {start} }} }}
[camera]
position = [-20.0, 10.0, 15.0]
aperture_area = {area}
view = {{ x = {x}, y = [2.75, 6.0] }}
pixels = [4, 4]
[[surface]]
name = "wall"
role = "relay"
rectangle = {{ corner = [0, 0, 0], u = [11.5, 0, 0], v = {v} }}
material = {{ oren_nayar = 0.8, roughness = {roughness} }}
[[surface]]
name = "object"
role = "hidden"
mesh = {{ generate = "rectangle", faces = 2, scale = 4, rotate = [{{ axis = [1, 0, 0], angle = {angle} }}], translate = {translate} }}
material = {{ lambertian = 0.5 }}
elements = [2, 2]
[sensor]
exposure = {exposure}
ambient = {ambient}
glare = {{ fraction = 0.1, spread = {{ falloff = {falloff} }} }}
[uncertainty]
"hinge.angle" = {turn}
"object.normal" = {shift}
"wall.roughness" = {growth}
"#,
        power = pick("5.0e-3", "\"5 mW\""),
        wavelength = pick("632.8e-9", "\"632.8 nm\""),
        position = pick("[-20, 10, 15]", "[\"-20 in\", 10, \"15in.\"]"),
        diameter = pick("0.1", "\"0.1 in\""),
        centre = pick("[5, 4]", "[\"127 mm\", \"10.16 cm\"]"),
        radius = pick("3.0", "\"0.25 ft\""),
        start = pick("45.0", "\"45 deg\""),
        area = pick("0.05", "\"0.05 in²\""),
        x = pick("[3.25, 6.5]", "[3.25, \"6.5 in\"]"),
        v = pick("[0, 15.5, 0]", "[0, \"0.3937 m\", 0]"),
        roughness = pick("0.3", "\"300 mrad\""),
        angle = pick("135", "\"135°\""),
        translate = pick("[3, 12, 4]", "[\"76.2 mm\", 12, 4]"),
        exposure = pick("0.1", "\"100 ms\""),
        ambient = pick("2e-12", "\"2pW\""),
        falloff = pick("0.5", "\"1.27 cm\""),
        turn = pick("0.5", "\"0.5 deg\""),
        shift = pick("0.1", "\"2.54 mm\""),
        growth = pick("5.0", "\"5 %\""),
    )
}

/// A weight of a mixture changes by percentage points, which neither "2 %" nor a length says.
#[test]
fn a_weight_is_uncertain_by_a_bare_number() {
    let mixture = "{ mixture = [{ weight = 0.5, material = { lambertian = 0.8 } }, { weight = 0.3, material = { lambertian = 0.2 } }] }";
    let lines: Vec<String> = scene(|bare, _| bare)
        .replace("{ oren_nayar = 0.8, roughness = 0.3 }", mixture)
        .lines()
        .filter(|line| !line.contains("wall.roughness"))
        .map(str::to_owned)
        .collect();
    let with = |sigma: &str| {
        let text = format!(
            "{}\n\"wall.mixture.0.weight\" = {sigma}\n",
            lines.join("\n")
        );
        Scene::from_toml("mixed", &text)
    };
    let stated = with("2").unwrap().uncertainty;
    assert!(stated.contains(&("wall.mixture.0.weight".to_owned(), 2.0)));
    for unit in ["\"2 %\"", "\"2 mm\""] {
        assert!(with(unit).is_err(), "{unit}");
    }
}

/// The number beside each value is the conversion by hand; the scene, its hash, its text are those
/// of the numbers.
#[test]
fn values_with_units_are_the_scene_of_the_numbers() {
    let bare = Scene::from_toml("bare", &scene(|bare, _| bare)).unwrap();
    let with = Scene::from_toml("with", &scene(|_, unit| unit)).unwrap();
    assert_eq!(with.hash, bare.hash);
    assert_eq!(with.sensor, bare.sensor);
    assert_eq!(with.uncertainty, bare.uncertainty);
    assert!(
        !with.text.contains(" mW") && with.text.contains("power = 0.005"),
        "{}",
        with.text
    );
    let again = Scene::from_toml("again", &with.text).unwrap();
    assert_eq!(again.hash, bare.hash);
}

#[test]
fn a_file_without_units_keeps_its_bytes() {
    let text = scene(|bare, _| bare);
    assert_eq!(convert("s", &text).unwrap().text, text);
}

#[test]
fn what_has_no_dimension_keeps_its_text() {
    let text = "name = \"5 mm\"\nunit = \"in\"\n[[surface]]\nname = \"3 W\"\n";
    assert_eq!(convert("s", text).unwrap().text, text);
}

#[test]
fn a_unit_that_does_not_fit_is_refused_with_those_that_do() {
    let text = scene(|bare, _| bare);
    for (old, new, words) in [
        (
            "power = 5.0e-3",
            "power = \"5 mm\"",
            &["a length", "a power", "mW", "then in W"][..],
        ),
        (
            "power = 5.0e-3",
            "power = \"5 MW\"",
            &["no unit `MW`", "kW"],
        ),
        (
            "diameter = 0.1",
            "diameter = \"3 ms\"",
            &["a time", "a length", "then in in"],
        ),
        (
            "diameter = 0.1",
            "diameter = \"3\"",
            &["has no unit", "without quotes"],
        ),
        (
            "area = 0.05",
            "area = \"3 mm\"",
            &["a length", "an area", "mm²"],
        ),
        (
            "roughness = 0.3",
            "roughness = \"3 mm\"",
            &["an angle", "then in rad"],
        ),
    ] {
        assert!(text.contains(old), "{old}");
        let text = text.replace(old, new);
        let error = Scene::from_toml("s", &text).unwrap_err();
        let place = error.place.clone().unwrap();
        assert_eq!(
            place.text,
            text.lines().find(|l| l.contains(new)).unwrap(),
            "{error}"
        );
        for word in words {
            assert!(error.to_string().contains(word), "no `{word}` in {error}");
        }
        assert!(error.cure.contains("phicam help scene "), "{error}");
    }
}

/// The roughness of paint is no angle.
#[test]
fn a_number_without_dimension_takes_no_unit() {
    let text = scene(|bare, _| bare).replace(
        "oren_nayar = 0.8, roughness = 0.3",
        "paint = 0.8, roughness = \"20 deg\"",
    );
    let error = Scene::from_toml("s", &text).unwrap_err();
    assert!(error.cause.contains("expected a number"), "{error}");
}

/// A fault behind converted values is told with line and column of the text as it was given.
#[test]
fn places_are_those_of_the_given_text() {
    let text = scene(|_, unit| unit).replace("x = [3.25", "z = [3.25");
    let error = Scene::from_toml("s", &text).unwrap_err();
    let place = error.place.unwrap();
    assert_eq!(place.text, text.lines().nth(place.line - 1).unwrap());
    assert_eq!(
        place.text.chars().nth(place.column - 1),
        Some('z'),
        "{place:?}"
    );
    let text = scene(|_, unit| unit).replace("count = 3", "count = 3.5");
    let place = Scene::from_toml("s", &text).unwrap_err().place.unwrap();
    let line = text.lines().nth(place.line - 1).unwrap();
    let rest: String = line.chars().skip(place.column - 1).collect();
    assert!(rest.starts_with("3.5"), "{place:?}");
}
