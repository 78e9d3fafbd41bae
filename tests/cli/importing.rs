//! `phicam import`: photographs of a real camera → Φcam.

use phicam::image::{grey16_png, rgb_png};
use phicam::matrix::{Matrix, npy};

use crate::small_scene::{SMALL, TINY, altered};
use crate::workspace::{Workspace, assert_same};

/// Stored value of pixel (u, v) of photograph k: some light, more to the right and below.
fn stored(k: usize, u: usize, v: usize) -> u16 {
    (100 + 1000 * k + 10 * u + v) as u16
}

fn photograph(k: usize, size: [usize; 2]) -> Vec<u8> {
    let all = (0..size[1]).flat_map(|v| (0..size[0]).map(move |u| stored(k, u, v)));
    let pixels: Vec<u16> = all.collect();
    grey16_png(size.map(|n| n as u32), &pixels).unwrap()
}

/// The tiny bench (3 × 2 pixels, 8 spots) with a photograph of 6 × 4 pixels for each spot.
fn with_photographs() -> Workspace {
    let w = Workspace::with_scenes();
    std::fs::create_dir(w.path("in")).unwrap();
    for k in 0..8 {
        w.write(&format!("in/input_{k}.png"), photograph(k, [6, 4]));
    }
    w
}

/// Sums of 2 × 2 pixels, the photograph's first row at the top of the view.
fn sums() -> Matrix {
    Matrix::from_fn(6, 8, |p, k| {
        let [u, v] = [2 * (p % 3), 2 * (1 - p / 3)];
        let block = [[0, 0], [1, 0], [0, 1], [1, 1]];
        block
            .iter()
            .map(|[i, j]| f64::from(stored(k, u + i, v + j)))
            .sum()
    })
}

const PLAIN: &str = "import --frames in/input_*.png --scene tiny.toml -o out";

#[test]
fn photographs_become_a_run_that_is_recovered() {
    let w = with_photographs();
    let told = w.phicam(PLAIN).exits(0);
    for words in ["--free-scale", "no dark frames", "noise is not known"] {
        assert!(told.stderr.contains(words), "{}", told.account());
    }
    let due = sums();
    let phi = w.matrix("out/phi.npy");
    assert!((&phi - &due).amax() < 1e-9 * due.amax(), "{phi}");
    assert_eq!(w.matrix("out/left_out.npy"), Matrix::zeros(6, 8));
    assert!(!w.path("out/phi.stderr.npy").exists());
    let record = w.json("out/run.json");
    let sources = record["imported"]["sources"].as_array().unwrap();
    assert_eq!((sources.len(), record["seed"].is_null()), (8, true));
    assert_eq!(sources[3]["name"], "in/input_3.png");
    // As sha256sum has it.
    use sha2::Digest as _;
    let digest = sha2::Sha256::digest(w.read("in/input_3.png"));
    let hex: String = digest.iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(sources[3]["sha256"], hex);
    let account = w.json("out/import.json");
    assert_eq!(
        (&account["unit"], &account["photographs"]),
        (&"counts".into(), &8.into())
    );
    assert_eq!(w.read("out/import.png")[..4], *b"\x89PNG");

    // Another value of their scene is for another import.
    for command in [
        "recover out",
        "calibrate out --free hinge.angle",
        "locate out",
    ] {
        let line = format!("{command} -D laser.power=1");
        w.refuses(&line, &["phicam import … -D laser.power=VALUE"]);
    }
    let other = PLAIN.replace("-o out", "-o other -D laser.power=1");
    let _ = w.phicam(&other).exits(0);
    assert!(w.text("other/scene.toml").contains("power = 1"));

    let recovered = w.phicam("recover out --method pinv").exits(0);
    assert!(
        recovered.stderr.contains("no noise model") || w.path("out/recovered/pinv.npy").exists()
    );
    w.refuses("recover out", &["counts", "not in W", "--free-scale"]);
    w.refuses("validate out", &["noise", "cure: ", "repeats"]);
    w.refuses("expose out --sensor ccd", &["real camera"]);
    let of_scene = "validate out --phi out/phi.npy --stderr out/phi.npy";
    assert!([0, 1].contains(&w.phicam(of_scene).code));
}

/// A PNG that says that its values are encoded is taken as it was, and that is told unless the user
/// says how they are.
#[test]
fn encoded_values_are_told() {
    let w = with_photographs();
    let plain = photograph(3, [6, 4]);
    let srgb = b"\0\0\0\x01sRGB\0\xae\xce\x1c\xe9";
    let encoded = [&plain[..33], srgb, &plain[33..]].concat();
    w.write("in/input_3.png", encoded);
    let told = w.phicam(PLAIN).exits(0);
    for words in ["in/input_3.png", "1/2.20", "`gamma = 1`"] {
        assert!(told.stderr.contains(words), "{}", told.account());
    }
    assert!((w.matrix("out/phi.npy") - sums()).amax() < 1e-9);
    let told = w.phicam(&format!("{PLAIN} --gamma 1 --replace")).exits(0);
    assert!(!told.stderr.contains("1/2.20"), "{}", told.account());
}

#[test]
fn an_import_is_replaced_only_by_another_that_is_meant_to() {
    let w = with_photographs();
    let _ = w.phicam(PLAIN).exits(0);
    let before = w.contents("out");
    let _ = w.phicam(PLAIN).exits(0);
    assert_same(&before, &w.contents("out"), "the same import again");
    let other = format!("{PLAIN} --exposure 2");
    w.refuses(&other, &["other settings", "--replace"]);
    w.refuses(
        "render tiny.toml -o out --samples 32",
        &["imported photographs"],
    );
    w.refuses(
        "render tiny.toml -o out --samples 32 --replace",
        &["imported photographs"],
    );
    let _ = w.phicam(&format!("{other} --replace")).exits(0);
    assert!((w.matrix("out/phi.npy") * 2.0 - sums()).amax() < 1e-9);
    // One whose files were changed is made again.
    w.write("out/left_out.npy", b"");
    let _ = w.phicam(&other).exits(0);
    assert_eq!(w.matrix("out/left_out.npy"), Matrix::zeros(6, 8));
    let _ = w.phicam("render tiny.toml -o run --samples 32").exits(0);
    w.refuses(
        "import --frames in/input_*.png --scene tiny.toml -o run --replace",
        &["rendered run"],
    );
    // Another photograph under the same name is another import.
    w.write("in/input_7.png", photograph(9, [6, 4]));
    w.refuses(&other, &["other settings"]);
}

/// Dark frames, flat field, gain, exposure, repeats and given noise: by hand.
#[test]
fn a_list_says_what_the_photographs_are() {
    let w = with_photographs();
    let level = |x: u16| grey16_png([6, 4], &[x; 24]).unwrap();
    w.write("in/dark.png", level(50));
    let flat: Vec<u16> = (0..24)
        .map(|q| if q % 6 < 3 { 1050 } else { 3050 })
        .collect();
    w.write("in/flat.png", grey16_png([6, 4], &flat).unwrap());
    let mut list = String::from(
        "scene = \"tiny.toml\"\ndark = \"in/dark.png\"\nflat = \"in/flat.png\"\nflat_dark = \"in/dark.png\"\n\
         exposure = 0.5\nwatts = 1e-12\nnoise = { gain = 2.0, read_noise = 3.0 }\n",
    );
    for k in 0..8 {
        let gain = if k == 2 {
            "\ngain = 2.0\ngain_error = 0.1"
        } else {
            ""
        };
        list += &format!(
            "[[frame]]\nfile = \"in/input_{}.png\"\nspot = {k}{gain}\n",
            7 - k
        );
    }
    w.write("set.toml", &list);
    let _ = w.phicam("import set.toml -o out").exits(0);
    let (phi, stderr) = (w.matrix("out/phi.npy"), w.matrix("out/phi.stderr.npy"));
    let taken = |u: usize, v: usize| -> f64 {
        let x = 3.25 + 3.25 * (u as f64 + 0.5) / 6.0;
        let y = 6.0 - 3.25 * (v as f64 + 0.5) / 4.0;
        1.0 / ((x + 20.0).powi(2) + (y - 10.0).powi(2) + 225.0).powi(2)
    };
    let mean = (0..24).map(|q| taken(q % 6, q / 6)).sum::<f64>() / 24.0;
    for (p, spot) in [(0, 0), (2, 2), (4, 7)] {
        let k = 7 - spot;
        let gain = if spot == 2 { 2.0 } else { 1.0 };
        let [u, v] = [2 * (p % 3), 2 * (1 - p / 3)];
        let (mut flux, mut variance) = (0.0, 0.0);
        // The flat field has 1000 and 3000 counts, so 0.5 and 1.5; what it leaves is radiance, of
        // which the scene's camera takes 1/r⁴ of each part of the wall, relative to the mean.
        for [i, j] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let level: f64 = if u + i < 3 { 0.5 } else { 1.5 };
            let signal = f64::from(stored(k, u + i, v + j)) - 50.0;
            let scale = taken(u + i, v + j) / mean / (level * 0.5);
            let of_flat =
                (2.0 * 2000.0 * level + 2.0 * (9.0 + 1.0 / 12.0)) / (2000.0 * level).powi(2);
            flux += signal * scale;
            variance += (2.0 * signal + 2.0 * (9.0 + 1.0 / 12.0)) * scale * scale
                + of_flat * (signal * scale).powi(2);
        }
        let scale = 1e-12 / gain;
        let (flux, variance) = (scale * flux, scale * scale * variance);
        let found = phi[(p, spot)];
        assert!((found / flux - 1.0).abs() < 1e-6, "{found} {flux}");
        // The gain's error is one of the whole photograph, not of an entry.
        let relative = stderr[(p, spot)] / found / (variance.sqrt() / flux);
        assert!((relative - 1.0).abs() < 1e-6, "{relative}");
    }
    let record = w.json("out/run.json");
    assert_eq!(record["imported"]["flux_unit"], "W");
    assert_eq!(record["imported"]["frame_gain"], 0.05);
    for (command, taken) in [
        ("validate out", true),
        ("recover out --method joint-unbounded", true),
        (
            "recover out --method joint-unbounded --frame-gain 0.1",
            false,
        ),
        ("recover out --method pinv", false),
    ] {
        let told = w.phicam(command).stderr;
        assert_eq!(
            told.contains("--frame-gain 0.05"),
            taken,
            "{command}: {told}"
        );
        assert_eq!(
            told.contains("pinv know nothing"),
            command.contains("pinv"),
            "{told}"
        );
    }
    // What is written is a run: it is validated, though it cannot be this scene's light.
    assert_eq!(w.phicam("validate out").code, 1);
}

/// Repeats tell the noise; a flickering one is told.
#[test]
fn repeats_tell_the_noise() {
    let w = Workspace::with_scenes();
    std::fs::create_dir(w.path("in")).unwrap();
    // 48 × 32 pixels, variance 0.5·light + 16 in counts, from a generator of its own.
    let mut state = 7u64;
    let mut normal = || {
        let sum: f64 = (0..12)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64
            })
            .sum();
        sum - 6.0
    };
    for k in 0..24 {
        let pixels: Vec<u16> = (0..48 * 32)
            .map(|q| {
                let light = 50.0 + f64::from(q % 48) * 40.0;
                (200.0 + light + (0.5 * light + 16.0f64).sqrt() * normal()).round() as u16
            })
            .collect();
        w.write(
            &format!("in/i{k}.png"),
            grey16_png([48, 32], &pixels).unwrap(),
        );
    }
    w.write("in/dark.png", grey16_png([48, 32], &[200; 1536]).unwrap());
    let told = w
        .phicam("import --frames in/i*.png --scene tiny.toml --repeats 3 --dark in/dark.png -o out --json")
        .exits(0);
    let account: serde_json::Value = serde_json::from_str(&told.stdout).unwrap();
    let noise = |key: &str| account["noise"][key].as_f64().unwrap();
    let error = account["photon_transfer"]["gain_error"].as_f64().unwrap();
    assert!(
        (noise("gain") - 0.5).abs() < 4.0 * error && error < 0.02,
        "{account}"
    );
    assert!((noise("read_variance") - 16.0).abs() < 8.0, "{account}");
    assert!(account["photon_transfer"]["p"].as_f64().unwrap() > 1e-3);
    // Standard error of a sum of 16 × 16 pixels and 3 photographs at the middle column.
    let stderr = w.matrix("out/phi.stderr.npy")[(1, 0)];
    let variance: f64 = (16..32)
        .map(|u| 0.5 * (50.0 + f64::from(u) * 40.0) + 16.0 + 1.0 / 12.0)
        .sum();
    // The one dark frame has the read noise, too.
    let due = (16.0 * variance / 3.0 + 256.0 * (16.0 + 1.0 / 12.0)).sqrt();
    assert!((stderr / due - 1.0).abs() < 0.05, "{stderr} {due}");
    // Two dark frames tell the read noise by what they differ, 16 to √(2/1536) of it: the line
    // alone knows it ten times worse.
    for k in 0..2 {
        let dark: Vec<u16> = (0..48 * 32)
            .map(|_| (200.0 + 4.0 * normal()).round() as u16)
            .collect();
        w.write(
            &format!("in/z{k}.png"),
            grey16_png([48, 32], &dark).unwrap(),
        );
    }
    let command =
        "import --frames in/i*.png --scene tiny.toml --repeats 3 --dark in/z*.png -o dark";
    let told = w.phicam(&format!("{command} --json")).exits(0);
    let account: serde_json::Value = serde_json::from_str(&told.stdout).unwrap();
    let read = account["noise"]["read_variance"].as_f64().unwrap();
    let error = account["photon_transfer"]["read_variance_error"].as_f64();
    assert!((read - 16.0).abs() < 4.0 * error.unwrap(), "{account}");
    assert!(error.unwrap() < 1.2 * 16.0 * (2.0f64 / 1536.0).sqrt());
    assert!(!told.stderr.contains("the dark frames are too bright"));
    // Of a level of one read noise a sixth is cut off at 0.
    for k in 0..2 {
        let dark: Vec<u16> = (0..48 * 32)
            .map(|_| (4.0 + 4.0 * normal()).round().max(0.0) as u16)
            .collect();
        w.write(
            &format!("in/cut{k}.png"),
            grey16_png([48, 32], &dark).unwrap(),
        );
    }
    let cut = command.replace("in/z*.png -o dark", "in/cut*.png -o cut");
    let words = w.phicam(&cut).exits(0).stderr;
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("% of the dark frames' stored values are 0")
            && words.contains("every entry too dark"),
        "{words}"
    );
    let told = w.phicam(&format!("{command} --replace")).exits(0);
    assert!(told.stdout.contains("read noise 4.") || told.stdout.contains("read noise 3.9"));
    assert!(told.stdout.contains(" ± 0.07"), "{}", told.stdout);
    w.refuses(
        "import --frames in/i*.png --scene tiny.toml --repeats 4 -o other",
        &["24 photographs for 8 spots with 4 each"],
    );
    // In a list they contradict a stated noise as well.
    let list = |gain: &dyn Fn(usize) -> f64| -> String {
        let table = |k: usize| {
            let (spot, gain) = (k / 3, gain(k));
            format!("[[frame]]\nfile = \"in/i{k}.png\"\nspot = {spot}\ngain = {gain:?}\n")
        };
        (0..24).map(table).collect()
    };
    let head = "scene = \"tiny.toml\"\ndark = \"in/dark.png\"\n";
    let noise = "noise = { gain = 50.0, read_noise = 40.0 }\n";
    w.write("list.toml", format!("{head}{noise}{}", list(&|_| 1.0)));
    let told = w.phicam("import list.toml -o listed").exits(0);
    assert!(
        told.stderr.contains("repeats of one photograph scatter by"),
        "{}",
        told.stderr
    );
    // Eight times the camera's gain in half of them: no line has both.
    for k in 12..24 {
        let pixels: Vec<u16> = (0..48 * 32)
            .map(|q| {
                let light = 50.0 + f64::from(q % 48) * 40.0;
                (200.0 + 8.0 * (light + (0.5 * light + 16.0f64).sqrt() * normal())).round() as u16
            })
            .collect();
        w.write(
            &format!("in/i{k}.png"),
            grey16_png([48, 32], &pixels).unwrap(),
        );
    }
    let gain = |k: usize| if k < 12 { 1.0 } else { 8.0 };
    w.write("gains.toml", format!("{head}{}", list(&gain)));
    let told = w.phicam("import gains.toml -o gains --json").exits(0);
    assert!(told.stderr.contains("several `gain`s"), "{}", told.stderr);
    let account: serde_json::Value = serde_json::from_str(&told.stdout).unwrap();
    let of = |key: &str| account["photon_transfer"][key].as_f64().unwrap();
    // Far from either gain, by an error that says so.
    let found = account["noise"]["gain"].as_f64().unwrap();
    assert!(
        of("p") < 1e-3 && of("gain_error") > 0.02 * found,
        "{account}"
    );
}

#[test]
fn what_means_nothing_is_left_out_with_its_reason() {
    let w = with_photographs();
    w.write("in/dead.png", {
        let mut pixels = [0u16; 24];
        pixels[6 * 3 + 5] = 1;
        grey16_png([6, 4], &pixels).unwrap()
    });
    let list = "scene = \"tiny.toml\"\nframes = \"in/input_*.png\"\nsaturation = 7150\n";
    w.write(
        "set.toml",
        format!("{list}dead = \"in/dead.png\"\nhalo = 0.75\n"),
    );
    let told = w.phicam("import set.toml -o out").exits(0);
    assert!(told.stdout.contains("left out"), "{}", told.account());
    let left = w.matrix("out/left_out.npy");
    let phi = w.matrix("out/phi.npy");
    for spot in 0..8 {
        for p in 0..6 {
            let code = left[(p, spot)] as u8;
            // Photograph 7 reaches 7150 at u = 5 (v = 0 to 3) alone.
            assert_eq!(code & 1, u8::from(spot == 7 && p % 3 == 2), "{p} {spot}");
            // The dead pixel is in the lower right one of the view.
            assert_eq!(code & 2, 2 * u8::from(p == 2), "{p} {spot}");
            assert_eq!(code == 0, phi[(p, spot)] != 0.0);
        }
    }
    // Spots of the square of half-width 3 about (5, 4.37) lie outside the view, two of them within
    // 0.75 in. of it: nothing else is in the halo.
    let account = w.json("out/import.json");
    let halo = left.iter().filter(|c| **c as u8 & 4 != 0).count();
    assert_eq!(account["left_out"]["halo"], halo);
    w.write("wide.toml", format!("{list}halo = 50\n"));
    let _ = w.phicam("import wide.toml -o all").exits(0);
    assert!(
        w.matrix("all/left_out.npy")
            .iter()
            .all(|c| *c as u8 & 4 != 0)
    );
    w.write(
        "crop.toml",
        format!("{list}crop = {{ x = 3, y = 0, width = 6, height = 4 }}\n"),
    );
    let _ = w.phicam("import crop.toml -o crop").exits(0);
    let left = w.matrix("crop/left_out.npy");
    assert!(
        (0..6).all(|p| (left[(p, 0)] as u8 & 8 != 0) == (p % 3 > 0)),
        "{left}"
    );
}

#[test]
fn each_channel_has_a_folder_and_listed_positions_are_the_spots() {
    let w = Workspace::with_scenes();
    for k in 0..2u8 {
        let pixels: Vec<u8> = (0..24).flat_map(|q| [10 + k, 20 + q, 30]).collect();
        w.write(
            &format!("c{k}.png"),
            rgb_png([6, 4], &pixels, None).unwrap(),
        );
    }
    w.write("list.csv", "file,x,y,z\nc0.png,4,3,0\nc1.png,5.5,2.5,\n");
    w.write("set.toml", "scene = \"tiny.toml\"\nlist = \"list.csv\"\n");
    w.refuses("import set.toml -o out", &["colour", "channel"]);
    let _ = w.phicam("import set.toml --channel all -o out").exits(0);
    for (name, due) in [("red", 44.0), ("blue", 120.0)] {
        let phi = w.matrix(&format!("out/{name}/phi.npy"));
        assert_eq!((phi.shape(), phi[(0, 1)]), ((6, 2), due));
    }
    let scene = w.text("out/green/scene.toml");
    assert!(
        scene.contains("layout = \"list\"") && scene.contains("5.5"),
        "{scene}"
    );
    let _ = w.phicam("recover out/green --method pinv").exits(0);
    let _ = w.phicam("import set.toml --channel mean -o mean").exits(0);
    let mean = w.matrix("mean/phi.npy");
    let due = (0..4)
        .map(|k| [12.0, 13.0, 18.0, 19.0][k] + 20.0 + 10.0 + 30.0)
        .sum::<f64>()
        / 3.0;
    assert!((mean[(0, 0)] - due).abs() < 1e-9, "{} {due}", mean[(0, 0)]);
}

/// A list of what is known of the camera serves with photographs and scene from arguments.
#[test]
fn arguments_take_their_place_before_the_list_is_checked() {
    let w = with_photographs();
    w.write("camera.toml", "noise = { gain = 0.5, read_noise = 2.0 }\n");
    let named = "--frames in/input_*.png --scene tiny.toml";
    let _ = w
        .phicam(&format!("import camera.toml {named} -o out"))
        .exits(0);
    assert!(w.path("out/phi.stderr.npy").exists());
    w.refuses(
        "import camera.toml --scene tiny.toml -o none",
        &["photographs are not given"],
    );
    // Nor does --replace remove what is no import.
    std::fs::create_dir(w.path("foreign")).unwrap();
    w.write("foreign/phi.npy", b"mine");
    w.refuses(
        &format!("import camera.toml {named} -o foreign --replace"),
        &["phi.npy", "run.json"],
    );
    assert_eq!(w.read("foreign/phi.npy"), b"mine");
}

/// A list of the tiny bench, but for its photographs.
const LIST: &str = "scene = \"tiny.toml\"\n";

fn refuses_list(w: &Workspace, list: &str, words: &[&str]) {
    w.write("bad.toml", list);
    w.refuses("import bad.toml -o out", words);
}

/// Right on the wall is right in a photograph, and up is up: marks that say else are of a mirror.
#[test]
fn a_mirrored_wall_is_told() {
    let w = with_photographs();
    for (flip, is_told) in [(1.0, false), (-1.0, true)] {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let marks = corners.map(|[x, y]| {
            let u = 2.5 + flip * (5.0 * x - 2.5);
            let (v, at) = (3.5 - 4.0 * y, [3.25 + 3.25 * x, 2.75 + 3.25 * y]);
            format!("[[marks]]\npixel = [{u}, {v}]\nwall = {at:?}\n")
        });
        w.write(
            "set.toml",
            format!("{LIST}frames = \"in/input_*.png\"\n{}", marks.concat()),
        );
        let told = w.phicam("import set.toml -o mirror --replace").exits(0);
        assert_eq!(
            told.stderr.contains("as in a mirror"),
            is_told,
            "{}",
            told.stderr
        );
    }
}

#[test]
fn what_does_not_fit_is_refused_and_nothing_is_written() {
    let w = with_photographs();
    let import = |list: &str, words: &[&str]| refuses_list(&w, list, words);
    let (plain, frames) = (LIST, format!("{LIST}frames = \"in/input_*.png\"\n"));
    import(
        &format!("{frames}dakr = \"x\"\n"),
        &["bad.toml:3", "did you mean `dark`"],
    );
    import(plain, &["photographs are not given"]);
    import(
        &format!("{plain}frames = \"in/other_*.png\"\n"),
        &["no file in", "cure: "],
    );
    import(&format!("{frames}gamma = 0\n"), &["gamma 0", "cure: "]);
    import(
        &format!("{frames}gamma = 2\nresponse = \"a.csv\"\n"),
        &["exclude each other"],
    );
    import(&format!("{frames}exposure = -1\n"), &["exposure = -1"]);
    import(&format!("{frames}halo = nan\n"), &["halo = NaN"]);
    import(
        &format!("{frames}dead = [[6, 0]]\n"),
        &["dead pixel (6, 0)"],
    );
    import(
        &format!("{frames}noise = {{ gain = -1, read_noise = 0 }}\n"),
        &["gain of -1"],
    );
    import(
        &format!("{frames}camera = {{ fx = 0, fy = 1, cx = 0, cy = 0 }}\n"),
        &["camera matrix"],
    );
    let mark = |u: f64, v: f64, x: f64, y: f64| {
        format!("[[marks]]\npixel = [{u}, {v}]\nwall = [{x}, {y}]\n")
    };
    let line: String = (0..4)
        .map(f64::from)
        .map(|k| mark(k, k, 3.5 + k, 3.0 + k))
        .collect();
    import(&format!("{frames}{line}"), &["no mapping", "cure: "]);
    import(
        &format!("{frames}{}", mark(0.0, 0.0, 3.5, 3.0)),
        &["1 marks"],
    );
    let off = format!("{frames}[[marks]]\npixel = [0, 0]\nwall = [3.5, 3, 1]\n");
    import(&off, &["no point of the wall"]);
    // A spot's position beside the wall, and one that is.
    let at =
        |z: f64| format!("{plain}[[frame]]\nfile = \"in/input_0.png\"\nposition = [4, 3, {z:?}]\n");
    import(&at(5.0), &["off the wall, where z is 0", "cure: "]);
    w.write("on.toml", at(0.0));
    let _ = w.phicam("import on.toml -o on").exits(0);
    import(
        "scene = \"tiny.toml\"\nframe = [{ file = \"in/input_0.png\", spot = 8 }]\n",
        &["spot 8", "8 spots"],
    );
    import(
        "scene = \"none.toml\"\nframes = \"in/input_*.png\"\n",
        &["none.toml"],
    );
    w.refuses("import --frames in/input_*.png -o out", &["--scene"]);
    let many = [TINY[0], SMALL[1]];
    w.write("many.toml", altered(&many));
    w.refuses(
        "import --frames in/input_*.png --scene many.toml -o out",
        &["8 photographs for 24 spots"],
    );
    w.refuses(
        "import --frames in/input_*.png --scene small.toml -o out",
        &[
            "0.38 pixels for each of the scene's",
            "camera.pixels = [2, 2]",
        ],
    );

    w.write("in/input_5.png", photograph(5, [4, 6]));
    w.refuses(PLAIN, &["in/input_5.png has 4 × 6 pixels", "6 × 4"]);
    let whole = photograph(5, [6, 4]);
    w.write("in/input_5.png", &whole[..whole.len() - 20]);
    w.refuses(PLAIN, &["`in/input_5.png` is damaged"]);
    w.write("in/input_5.png", "no picture");
    w.refuses(PLAIN, &["in/input_5.png is no PNG", "cure: "]);
    std::fs::remove_file(w.path("in/input_5.png")).unwrap();
    w.refuses(PLAIN, &["input_4.png and", "files are missing"]);
    // Files of the same kinds, of which nothing is left but a claim.
    let mut bomb =
        b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\0\0\0\0".to_vec();
    bomb.extend(0x31a2_54ba_u32.to_be_bytes());
    w.write("in/input_5.png", &bomb);
    w.refuses_within(3 << 20, PLAIN, &["`in/input_5.png`", "2147483647"]);
}

/// What would come out as numbers that mean nothing: other bit depths, a file in two roles, a
/// response that no camera has; and photographs of which nothing counts are told.
#[test]
fn numbers_without_meaning_are_refused_or_told() {
    let w = with_photographs();
    let import = |list: &str, words: &[&str]| refuses_list(&w, list, words);
    let (plain, frames) = (LIST, format!("{LIST}frames = \"in/input_*.png\"\n"));
    import(&format!("{frames}gamma = 1e308\n"), &["gamma", "0.1 to 10"]);
    import(
        &format!("{frames}dark = \"in/input_3.png\"\n"),
        &["in/input_3.png", "dark frame", "once"],
    );
    import(
        &format!("{frames}saturation = 65536\n"),
        &["saturation = 65536", "65535", "leave `saturation` out"],
    );
    import(
        &format!("{frames}saturation = 0\n"),
        &["saturation = 0 has no meaning", "positive"],
    );
    let frame =
        |k: usize, spot: usize| format!("[[frame]]\nfile = \"in/input_{k}.png\"\nspot = {spot}\n");
    let twice: String = (0..8).map(|spot| frame(spot.min(6), spot)).collect();
    import(&format!("{plain}{twice}"), &["input_6.png is named twice"]);
    // All entries, and most of them: the photographs from the third on.
    for (saturation, words) in [
        (
            50,
            "48 of 48 entries are left out (48 saturated), so that nothing",
        ),
        (2100, "36 of 48 entries are left out (36 saturated): check"),
    ] {
        w.write("few.toml", format!("{frames}saturation = {saturation}\n"));
        let told = w.phicam("import few.toml -o few --replace").exits(0);
        let said = told.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(words), "{}", told.account());
    }

    let bytes: Vec<u8> = (0..24).flat_map(|k| [k; 3]).collect();
    w.write("in/input_5.png", rgb_png([6, 4], &bytes, None).unwrap());
    w.refuses(PLAIN, &["in/input_5.png stores values up to 255", "65535"]);
}

/// One file of all frames, from NumPy or MATLAB, and its cures.
#[test]
fn stacks_of_other_programs_are_read() {
    let w = Workspace::with_scenes();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/photographs");
    let list = |file: &str, more: &str| {
        let crop = "crop = { x = 0, y = 0, width = 6, height = 4 }";
        let spots = "scene = \"three.toml\"";
        w.write(
            "set.toml",
            format!("{spots}\n{crop}\nframes = \"{file}\"\n{more}\n"),
        );
    };
    let square = "layout = \"square\"\ncentre = [5.0, 4.373476808130942]\nhalf_width = 3.0\nper_side = 2\nstagger = [-1.0, 1.0, 0.0]";
    let text = w.text("tiny.toml");
    let start = text
        .find("layout = \"square\"")
        .unwrap_or_else(|| panic!("{square}"));
    let end = text.find("[camera]").unwrap();
    let three = "layout = \"list\"\npoints = [[2.5, 2], [3, 2], [7.5, 2]]\n\n";
    w.write(
        "three.toml",
        format!("{}{three}{}", &text[..start], &text[end..]),
    );
    let sample = |page: usize, row: usize, column: usize| {
        ((37 * row + 101 * column + 5 * page) % 251) as f64
    };
    let due = Matrix::from_fn(6, 3, |p, page| {
        let [u, v] = [2 * (p % 3), 2 * (1 - p / 3)];
        (0..4).map(|k| sample(page, v + k / 2, u + k % 2)).sum()
    });
    for (file, more) in [
        ("stack-u1.npy", ""),
        (
            "stack-v7.mat",
            "variable = \"frames\"\naxes = \"frames-rows-columns\"",
        ),
        ("python-v73.mat", "axes = \"rows-columns-frames\""),
        ("pages8-s1-3.tif", ""),
    ] {
        list(file, more);
        let line = format!(
            "import set.toml --from {folder} -o {}",
            file.replace('.', "-")
        );
        let _ = w.phicam(&line).exits(0);
        let phi = w.matrix(&format!("{}/phi.npy", file.replace('.', "-")));
        assert!((phi - &due).amax() < 1e-9, "{file}");
    }
    list("stack-v7.mat", "");
    w.refuses(
        &format!("import set.toml --from {folder} -o out"),
        &["`frames`", "variable"],
    );
    list("stack-v73.mat", "");
    w.refuses(
        &format!("import set.toml --from {folder} -o out"),
        &["`photo`", "MATLAB_class", "save -v7.3"],
    );
}

/// The photographs of Chen et al. (CVPR 2019), where `PHICAM_PUBLIC_DATA` names the folder that has
/// them as `steady-state-nlos`: see tests/README.md.
#[test]
fn public_photographs_are_imported_in_one_command() {
    let Ok(data) = std::env::var("PHICAM_PUBLIC_DATA") else {
        return;
    };
    let w = Workspace::new();
    let set = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/steady-state-nlos-set.toml"
    );
    let told = w
        .phicam(&format!(
            "import {set} --from {data}/steady-state-nlos -o out"
        ))
        .exits(0);
    assert!(
        told.stdout.contains("24 photographs of 256 × 256"),
        "{}",
        told.account()
    );
    let phi = w.matrix("out/phi.npy");
    assert_eq!(phi.shape(), (1024, 24));
    let digest = &w.json("out/run.json")["imported"]["sources"][0];
    assert_eq!(digest["name"], "input_0.png");
    // Frames 0 and 1 are nearly dark, as their authors' are; others are not.
    let mean = |spot: usize| phi.column(spot).mean();
    assert!(
        mean(0) < 0.3 * mean(9) && mean(1) < 0.3 * mean(9),
        "{} {} {}",
        mean(0),
        mean(1),
        mean(9)
    );
    let recovered = w
        .phicam("recover out --method tikhonov,nnls --free-scale")
        .exits(0);
    assert!(
        w.path("out/recovered/nnls.npy").exists(),
        "{}",
        recovered.account()
    );
    // Where the object is: near 1 m, with an error of centimetres; and the order of the light
    // positions is in the photographs, but not if they are shuffled.
    let line = "locate out --elements 6x6 --frame-polynomial 0 --orders 999 --steps 9";
    let _ = w.phicam(line).exits(0);
    let found = w.json("out/located/locate.json");
    let depth = found["middle"][2].as_f64().unwrap();
    let error = found["by_frames"].as_f64().unwrap();
    assert!(
        (depth - 1.0).abs() < 0.2 && (0.01..0.3).contains(&error),
        "{found:#}"
    );
    assert_eq!(found["order"]["as_likely"], 0);
    let phi = Matrix::from_fn(1024, 24, |p, l| phi[(p, (7 * l + 5) % 24)]);
    let flags = w.matrix("out/left_out.npy");
    let flags = Matrix::from_fn(1024, 24, |p, l| flags[(p, (7 * l + 5) % 24)]);
    npy::write(&w.path("out/phi.npy"), &phi).unwrap();
    npy::write(&w.path("out/left_out.npy"), &flags).unwrap();
    w.disown("out");
    let told = w.phicam(line).exits(1);
    assert!(told.stdout.contains("Nothing says"), "{}", told.account());
}

/// How photographs were imported is vouched for, as they are.
#[test]
fn a_changed_account_is_found() {
    let w = with_photographs();
    let _ = w.phicam(PLAIN).exits(0);
    for name in ["out/import.json", "out/import.png"] {
        let own = w.read(name);
        let mut changed = own.clone();
        changed[own.len() / 2] ^= 1;
        w.write(name, changed);
        let ended = w.phicam("recover out --method pinv -o mine").exits(2);
        assert!(ended.stderr.contains(name), "{}", ended.account());
        w.write(name, own);
    }
    let _ = w.phicam("recover out --method pinv -o mine").exits(0);
}
