//! Geometry that would be lost without a word.

use super::*;

const FACE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn refused(name: &str, text: &str, words: &[&str]) {
    match alone(name, text.as_bytes()) {
        Ok(mesh) => panic!("{} faces were read of {text}", mesh.triangles.len()),
        Err(error) => {
            let told = error.to_string();
            assert!(words.iter().all(|word| told.contains(word)), "{told}");
        }
    }
}

/// Wavefront's appendix B1: what has an area and is no face, and what stands elsewhere.
#[test]
fn surfaces_that_are_no_faces() {
    for (statement, cure) in [
        ("surf 0 1 0 1 1 2 3", "export the mesh as faces"),
        ("bzp 1 2 3", "export the mesh as faces"),
        ("bsp 1 2 3", "export the mesh as faces"),
        ("cdp 1 2 3", "export the mesh as faces"),
        ("call other.obj", "export the mesh as one file"),
        ("csh -cat other.obj", "export the mesh as one file"),
        ("face 1 2 3", "mend the line"),
        ("F 1 2 3", "mend the line"),
    ] {
        let word = statement.split(' ').next().unwrap();
        let quoted = format!("`{word}`");
        refused(
            "a.obj",
            &format!("{FACE}{statement}\n"),
            &[&quoted, "line 5", cure],
        );
    }
    // Points, lines, curves, groups and looks have none, and old files name faces `fo`.
    let more = "vp 0 0\nvn 0 0 1\np 1\nl 1 2\ncstype bezier\ndeg 1\ncurv 0 1 1 2\nparm u 0 1\nend\ng a b\ns 1\n\
        mg 1 0.1\no a\nlod 1\nbevel on\nshadow_obj none.obj\nusemtl red\n\n  \n#surf 1\n";
    let mesh = alone("a.obj", format!("{FACE}{more}fo 1 3 2\n").as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 1]]);
}

/// glTF 2.0, section 3.7.2.2: weights move the vertices by the targets, those of the node before
/// those of the mesh.
#[test]
fn vertices_that_targets_or_bones_move() {
    let file = |of_mesh: &str, of_node: &str, target: &str| {
        let nodes = format!(r#"{{"mesh": 0{of_node}}}"#);
        let targets =
            format!(r#""indices": 1, "targets": [{{"NORMAL": 0}}, {target}]}}]{of_mesh}}}"#);
        gltf_text(&inline_buffer(), &nodes).replace(r#""indices": 1}]}"#, &targets)
    };
    let (none, place) = (r#"{"NORMAL": 0}"#, r#"{"POSITION": 0}"#);
    let [still, moved] = [r#", "weights": [1, 0]"#, r#", "weights": [0, 0.5]"#];
    for (of_mesh, of_node) in [(moved, ""), ("", moved), (still, moved), (moved, moved)] {
        let words = [
            "mesh 0",
            "morph targets",
            "export the mesh with the deformation applied",
        ];
        refused("a.gltf", &file(of_mesh, of_node, place), &words);
        is_unit_cube(&alone("a.gltf", file(of_mesh, of_node, none).as_bytes()).unwrap());
    }
    for (of_mesh, of_node) in [("", ""), (still, ""), ("", still), (moved, still)] {
        is_unit_cube(&alone("a.gltf", file(of_mesh, of_node, place).as_bytes()).unwrap());
    }
    let words = [
        "mesh 0",
        "a skin",
        "export the mesh with the deformation applied",
    ];
    let skin = gltf_text(&inline_buffer(), r#"{"mesh": 0, "skin": 0}"#);
    refused("a.gltf", &skin, &words);
}

#[test]
fn copies_that_an_extension_makes() {
    let text = gltf_text(&inline_buffer(), r#"{"mesh": 0}"#);
    let used = |name: &str| {
        text.replace(
            r#""scene": 0"#,
            &format!(r#""extensionsUsed": ["{name}"], "scene": 0"#),
        )
    };
    let words = [
        "EXT_mesh_gpu_instancing",
        "export the mesh with its instances made real",
    ];
    refused("a.gltf", &used("EXT_mesh_gpu_instancing"), &words);
    is_unit_cube(&alone("a.gltf", used("KHR_materials_unlit").as_bytes()).unwrap());
}
