//! Headers that promise terabytes.

use crate::readers::{FRAME, MESH, NPY, Outcome, PICTURE};
use crate::{Alone, seeds};

const SMALL: usize = 1 << 20;

fn npy(shape: &str, numbers: usize) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [
        b"\x93NUMPY\x01\0",
        &length[..],
        header.as_bytes(),
        &vec![0; numbers],
    ]
    .concat()
}

#[test]
fn an_array_of_terabytes_takes_no_memory() {
    let alone = Alone::new();
    for shape in [
        "(1000000, 1000000)",
        "(4294967296, 4294967296)",
        "(9999999999999999999,)",
        "(18446744073709551615, 2)",
        "(1, 137438953472)",
    ] {
        let (outcome, taken) = alone.read(&NPY, &npy(shape, 64), shape);
        assert_eq!(outcome, Outcome::Refused, "{shape}");
        assert!(taken < SMALL / 8, "{shape}: {taken}");
    }
    // A header of four gigabytes.
    let (outcome, taken) = alone.read(&NPY, b"\x93NUMPY\x02\0\xff\xff\xff\xff{'descr'", "header");
    assert!(outcome == Outcome::Refused && taken < SMALL / 8, "{taken}");
}

/// A frame and a picture of the same bytes but for the windows: 2³¹ − 1 pixels a side, and as many
/// as an hour of rendering would give.
#[test]
fn a_frame_of_terabytes_takes_no_memory() {
    let alone = Alone::new();
    for reader in [&FRAME, &PICTURE] {
        let seed = seeds::of(reader.name).pop().unwrap();
        for side in [i32::MAX, 1 << 20, 20_000] {
            let mut forged = seed.clone();
            for window in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
                let found = forged
                    .windows(window.len())
                    .position(|w| w == window.as_bytes());
                let at = found.unwrap() + window.len() + 4 + 8;
                let corner = [(side - 1).to_le_bytes(), (side - 1).to_le_bytes()].concat();
                forged[at..at + 8].copy_from_slice(&corner);
            }
            let (outcome, taken) = alone.read(reader, &forged, &format!("{side} a side"));
            assert_eq!(outcome, Outcome::Refused, "{} {side}", reader.name);
            assert!(taken < SMALL, "{} {side}: {taken}", reader.name);
        }
    }
}

/// Sixteen thousand nodes that show one mesh of a thousand triangles.
#[test]
fn a_mesh_that_multiplies_itself_is_refused() {
    let alone = Alone::new();
    let nodes = vec![r#"{"mesh":0}"#; 16_000].join(",");
    let roots: Vec<String> = (0..16_000).map(|i| i.to_string()).collect();
    let text = format!(
        r#"2{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{nodes}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"buffers":[{{"uri":"a.bin","byteLength":4200}}],"bufferViews":[{{"buffer":0,"byteLength":4200}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":256,"type":"VEC3"}},{{"bufferView":0,"componentType":5121,"count":3000,"type":"SCALAR"}}]}}"#,
        roots.join(",")
    );
    let (outcome, _) = alone.read(&MESH, text.as_bytes(), "sixteen million triangles");
    assert_eq!(outcome, Outcome::Refused);
}
