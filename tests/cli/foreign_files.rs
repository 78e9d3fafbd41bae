//! Scenes that name files: meshes, pictures and materials from anyone, broken and forged ones among
//! them.

use crate::small_scene::{TINY, altered};
use crate::workspace::{Workspace, assert_same};

/// What every process may take of memory here, KiB: the program, its threads' stacks and a few
/// hundred MiB.
const MEMORY: u64 = 3 << 20;

/// The tiny bench with one surface more, or another albedo of the board.
fn with_surface(lines: &str) -> String {
    altered(&TINY) + "\n[[surface]]\nname = \"thing\"\nrole = \"occluder\"\n" + lines
}

fn with_mesh(file: &str) -> String {
    with_surface(&format!(
        "mesh = {{ file = \"{file}\" }}\nmaterial = {{ lambertian = 0.5 }}\n"
    ))
}

const BOARD: &str = "lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 }";

fn with_picture(file: &str) -> String {
    let picture = format!("lambertian = {{ image = \"{file}\", transfer = \"linear\" }}");
    altered(TINY.iter().chain([&(BOARD, picture.as_str())]))
}

/// Refused with the scene's line, within bounded memory, by commands that read and by commands that
/// would write.
fn refused(workspace: &Workspace, scene: &str, words: &[&str]) {
    workspace.write("bad.toml", scene);
    let words = [&["error: bad.toml:", "cure: "], words].concat();
    for command in ["scene check bad.toml", "render bad.toml -o out"] {
        workspace.refuses_within(MEMORY, command, &words);
    }
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n";

#[test]
fn broken_meshes() {
    let w = Workspace::new();
    refused(&w, &with_mesh("absent.ply"), &["no file `absent.ply`"]);
    w.write("cut.ply", &PLY[..PLY.len() - 12]);
    refused(&w, &with_mesh("cut.ply"), &["cut.ply"]);
    let faces = PLY.replace("element face 1\n", "element face 4294967296\n");
    w.write("many.ply", &faces);
    refused(&w, &with_mesh("many.ply"), &["many.ply", "4294967296"]);
    let binary = faces.replace("ascii", "binary_little_endian");
    w.write("more.ply", binary);
    refused(&w, &with_mesh("more.ply"), &["more.ply"]);
    let mut nan = PLY
        .replace("ascii 1.0", "binary_little_endian 1.0")
        .into_bytes();
    nan.truncate(nan.len() - "0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n".len());
    nan.extend([f32::NAN; 9].iter().flat_map(|x| x.to_le_bytes()));
    nan.push(3);
    nan.extend([0_i32, 1, 2].iter().flat_map(|x| x.to_le_bytes()));
    w.write("nan.ply", nan);
    refused(
        &w,
        &with_mesh("nan.ply"),
        &["none of the", "no finite number"],
    );
    w.write("odd.obj", "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 9\n");
    refused(&w, &with_mesh("odd.obj"), &["odd.obj", "9"]);
    w.write("text.ply", "this is no mesh");
    refused(&w, &with_mesh("text.ply"), &["text.ply"]);
    w.write("mesh.stl", "solid\n");
    refused(&w, &with_mesh("mesh.stl"), &["mesh.stl", ".ply, .obj"]);
}

#[test]
fn nothing_outside_the_folder_is_read_unless_asked() {
    let w = Workspace::new();
    std::fs::create_dir(w.path("scene")).unwrap();
    w.write("mesh.ply", PLY);
    let place = w.path("mesh.ply");
    for name in ["../mesh.ply", place.to_str().unwrap(), "/etc/passwd"] {
        w.write("scene/own.toml", with_mesh(name));
        w.refuses("scene check scene/own.toml", &["outside", "--also-read"]);
    }
    let gltf = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
        )
    };
    for uri in [
        "../mesh.ply",
        "/etc/passwd",
        "file:///etc/passwd",
        "https://example.org/a.bin",
    ] {
        w.write("scene/far.gltf", gltf(uri));
        w.write("scene/own.toml", with_mesh("far.gltf"));
        w.refuses("scene check scene/own.toml", &["far.gltf", "cure: "]);
    }
    w.write("scene/own.toml", with_mesh("../mesh.ply"));
    let _ = w
        .phicam("scene check scene/own.toml --also-read .")
        .exits(0);
}

#[test]
fn broken_pictures() {
    let w = Workspace::new();
    refused(&w, &with_picture("absent.png"), &["no file `absent.png`"]);
    w.write("text.png", "this is no picture");
    refused(&w, &with_picture("text.png"), &["text.png"]);
    // 2³¹ − 1 pixels a side, in 33 bytes and nothing behind them; the checksum is right.
    let mut bomb =
        b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\0\0\0\0".to_vec();
    bomb.extend(0x31a2_54ba_u32.to_be_bytes());
    w.write("bomb.png", &bomb);
    refused(&w, &with_picture("bomb.png"), &["bomb.png"]);
    // An OpenEXR magic with a data window of 2³¹ pixels a side.
    let mut exr = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    for name in ["dataWindow", "displayWindow"] {
        exr.extend(name.bytes().chain(*b"\0box2i\0\x10\0\0\0"));
        for x in [0_i32, 0, i32::MAX, i32::MAX] {
            exr.extend(x.to_le_bytes());
        }
    }
    exr.push(0);
    w.write("bomb.exr", &exr);
    refused(&w, &with_picture("bomb.exr"), &["bomb.exr"]);
    let mut card = {
        let _ = w.phicam("target card -o card.png --linear").exits(0);
        w.read("card.png")
    };
    card.truncate(card.len() / 2);
    w.write("cut.png", &card);
    refused(&w, &with_picture("cut.png"), &["cut.png"]);
    std::fs::remove_file(w.path("card.png")).unwrap();
}

#[test]
fn broken_materials() {
    let w = Workspace::new();
    let paint = |material: &str| altered(TINY.iter().chain([&("lambertian = 0.8", material)]));
    refused(
        &w,
        &paint("measured = \"absent.csv\""),
        &["no file `absent.csv`"],
    );
    w.write("short.binary", [0_u8; 40]);
    let short = paint("measured = \"short.binary\", channel = \"red\"");
    refused(&w, &short, &["short.binary"]);
    w.write(
        "huge.binary",
        [90_i32, i32::MAX, i32::MAX].map(i32::to_le_bytes).concat(),
    );
    let huge = paint("measured = \"huge.binary\", channel = \"red\"");
    refused(&w, &huge, &["huge.binary"]);
    w.write("words.csv", "theta_i,theta_o,phi,value\n0,0,0,much\n");
    refused(&w, &paint("measured = \"words.csv\""), &["words.csv", "2"]);
    refused(
        &w,
        &paint("coated = 0.5, roughness = 7"),
        &["roughness of 7"],
    );
    refused(&w, &paint("lambertian = 0.5, coated = 0.5"), &["both"]);
}

/// A run keeps what its scene names: it is validated, recovered and continued after the originals
/// are gone, and where it is moved to.
#[test]
fn a_run_carries_its_files() {
    let w = Workspace::new();
    std::fs::create_dir(w.path("scene")).unwrap();
    w.write("scene/own.ply", PLY);
    let _ = w
        .phicam("target edge -o scene/edge.png --linear --size 16,16")
        .exits(0);
    let scene = with_picture("edge.png")
        + "\n[[surface]]\nname = \"thing\"\nrole = \"occluder\"\nmesh = { file = \"own.ply\" }\nmaterial = { lambertian = 0.5 }\n";
    w.write("scene/own.toml", scene);
    let line = "render scene/own.toml -o out --samples 64 --estimator shared";
    let _ = w.phicam(line).exits(0);
    assert_eq!(w.contents("out/files").len(), 2);
    let _ = w.phicam(line).exits(0);
    let before = w.contents("out/frames");
    std::fs::remove_dir_all(w.path("scene")).unwrap();
    std::fs::rename(w.path("out"), w.path("moved")).unwrap();
    let _ = w
        .phicam("recover moved --method joint --noise 0.1")
        .exits(0);
    assert!(w.path("moved/recovered/joint.ply").exists());
    assert!(w.path("moved/recovered/joint.texture.png").exists());
    let again = "render moved/scene.toml -o again --samples 64 --estimator shared";
    let _ = w.phicam(again).exits(0);
    assert_same(&before, &w.contents("again/frames"), again);
    // A copy that was tampered with is another scene.
    let copies = w.contents("moved/files");
    let mesh = copies.keys().find(|n| n.ends_with("own.ply")).unwrap();
    w.write(
        &format!("moved/files/{mesh}"),
        PLY.replace("0 1 1\n3", "0 2 1\n3"),
    );
    let changed = w.phicam("validate moved").exits(2);
    assert!(changed.stderr.contains("error: "), "{}", changed.account());
}
