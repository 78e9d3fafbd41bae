//! Valid inputs of each reader, small: where the fuzzers start.

use phicam::film::{Channel, Frame, FrameMeta, RunMeta, exr};
use phicam::image::{grey16_png, rgb_png};
use phicam::jobs::{self, PlanFile, Provenance, Settings};
use phicam::matrix::{Matrix, npy};
use phicam::num::stream::Sampling;
use phicam::scene::builtins;
use phicam::scene::mesh::{FaceValues, Generator, to_ply};
use phicam::transport::Estimator;

use super::readers::work;

#[path = "../../src/image/tests/bytes.rs"]
mod pictures;

/// The seeds of the reader called `name`.
pub fn of(name: &str) -> Vec<Vec<u8>> {
    match name {
        "scene" => scenes(),
        "mesh" => meshes(),
        "picture" => pictures(),
        "measured" => tables(),
        "frame" => vec![frame(["flux", "flux.stderr", "flux.b3"])],
        "npy" => arrays(),
        "shard" => shards(),
        "plan" => plans(),
        "photograph" => photographs(),
        "array" => stacks(),
        "list" => lists(),
        other => unreachable!("no seeds of {other}"),
    }
}

macro_rules! stored {
    ($($name:literal),*) => {
        vec![$(include_bytes!(concat!("../photographs/", $name)).to_vec()),*]
    };
}

/// What other programs wrote: `tests/photographs/make_files.py`.
fn photographs() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = stored![
        "grey8-s1-strips-lzw.tif",
        "grey16-s257-big-endian.tif",
        "grey16-s257-20x37-tiles-deflate.tif",
        "grey32-s16777259.tif",
        "float32-s0.25-packbits.tif",
        "colour16-s257-planar.tif",
        "pages8-s1-3.tif",
        "grey8-s1-turned-6.tif",
        "grey8-s1-turned-6.png",
        "halves-turned-6.jpg"
    ];
    all.extend(grey16_png([3, 2], &[1000; 6]));
    all.push(pictures::EXR_COLOUR.to_vec());
    all
}

fn stacks() -> Vec<Vec<u8>> {
    stored![
        "one-v7.mat",
        "tree-v73.mat",
        "later-v73.mat",
        "python-v73.mat",
        "stack-i2-fortran.npy",
        "stack-u1.npy",
        "colour-f4.npy"
    ]
}

fn lists() -> Vec<Vec<u8>> {
    let rest = "repeats = 2\ndark = [{ files = \"d*.png\", exposure = 0.5 }]\nflat = [\"a.png\", \"b.png\"]\nflat_dark = \"c.png\"\nchannel = \"mean\"\nvariable = \"x\"\n\
        axes = \"rows-columns-frames\"\nexposure = 0.5\ngamma = 2.2\nfull_scale = 4095\nsaturation = 4000\ndead = [[1, 2]]\nhalo = 0.1\nnoise = { gain = 1, read_noise = 2 }\n\
        watts = 1e-9\n[camera]\nfx = 1\nfy = 1\ncx = 0\ncy = 0\nk1 = -0.1\n[[marks]]\npixel = [1, 2]\nwall = [3, 4, 0]\n";
    [
        include_str!("../../scenes/steady-state-nlos-set.toml").to_owned(),
        format!("scene = \"bench\"\nframes = \"a*.tif\"\n{rest}"),
        "scene = \"bench\"\n[[frame]]\nfile = \"a\"\nposition = [1, 2]\ngain = 2\ngain_error = 0.1\n".to_owned(),
    ]
    .map(String::into_bytes)
    .to_vec()
}

/// The built-in scenes, smaller, and what they do not use.
fn scenes() -> Vec<Vec<u8>> {
    const SMALLER: [(&str, &str); 8] = [
        ("per_side = 30", "per_side = 3"),
        ("per_side = 16", "per_side = 3"),
        ("per_side = 12", "per_side = 3"),
        ("pixels = [16, 16]", "pixels = [4, 3]"),
        ("pixels = [64, 64]", "pixels = [4, 3]"),
        ("pixels = [72, 48]", "pixels = [4, 3]"),
        ("faces = 1000000", "faces = 300"),
        ("size = [380, 252]", "size = [38, 25]"),
    ];
    let smaller = |text: &str| {
        let lines = text.lines().filter(|l| !l.starts_with('#'));
        let text: String = lines
            .flat_map(|l| [l.split(" #").next().unwrap_or(l).trim_end(), "\n"])
            .collect();
        SMALLER
            .iter()
            .fold(text, |t, (old, new)| t.replace(old, new))
    };
    let mut all: Vec<String> = builtins().iter().map(|b| smaller(b.text)).collect();
    let bench = all
        .iter()
        .find(|t| t.starts_with("\nname = \"bench\"") || t.contains("name = \"bench\""));
    let bench = bench.cloned().unwrap_or_default();
    let matt = "{ lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 } }";
    for material in [
        "{ oren_nayar = { ramp = [0.1, 0.9] }, roughness = 0.3 }",
        "{ coated = { cells = [[0.1, 0.2], [0.3, 0.4]] }, roughness = 0.2, ior = 1.4 }",
        "{ paint = { ramp = [0.1, 0.9] }, roughness = 0.3, ior = 1.4 }",
        "{ conductor = { eta = 0.2, k = 3.9 }, roughness = 0.3, reflectance = 0.9 }",
        "{ mixture = [{ weight = 0.5, material = { lambertian = 0.8 } }, { weight = 0.4, material = { conductor = { eta = 1, k = 2 }, roughness = 0.1 } }] }",
        "{ lambertian = { target = \"siemens\", size = [9, 9], filter = \"bilinear\", wrap = \"repeat\", dark = 0.1, light = 0.9 } }",
    ] {
        all.push(bench.replacen(matt, material, 1));
    }
    let square = bench.find("layout = ").unwrap_or(0)..bench.find("[camera]").unwrap_or(0);
    for spots in [
        "layout = \"ring\"\ncentre = [5, 4]\nradius = 3.0\ncount = 7\nstart_angle = 10.0\n\n",
        "layout = \"random\"\ncentre = [5, 4]\nhalf_width = 3.0\ncount = 7\nseed = 3\n\n",
        "layout = \"list\"\npoints = [[2, 2], [8, 1.5]]\n\n",
        "layout = \"lines\"\nlines = [{ from = [2, 2], to = [8, 2], count = 4 }]\nstagger = [0.1, 0]\n\n",
    ] {
        let mut text = bench.clone();
        text.replace_range(square.clone(), spots);
        all.push(text);
    }
    let rest = "\n[[surface]]\nname = \"coin\"\nrole = \"occluder\"\nsides = \"two\"\ndisc = { centre = [6, 8, 1], normal = [0, 1, 1], radius = 0.5 }\nmaterial = { lambertian = 0.5 }\n\
        \n[[surface]]\nname = \"stone\"\nrole = \"occluder\"\nmesh = { generate = \"sphere\", faces = 60, scale = [0.3, 0.2, 0.1], on = { surface = \"wall\", at = [0.9, 0.1] }, closed = true }\nmaterial = { lambertian = 0.5 }\n\
        \n[[known]]\npixel = 1\nspot = 2\nflux = 1e-12\nbounces = 3\n\
        \n[sensor]\nmodel = \"ccd\"\nquantum_efficiency = 0.5\ndark_current = 0.1\nfull_well = inf\nread_noise = 2\ngain = 1.5\nbits = 12\noffset = 10\nshot_noise = true\nbrackets = [1, 2]\nambient = 1e-15\nglare = { fraction = 0.01, spread = { falloff = 2 } }\n";
    all.push(bench + rest);
    all.into_iter().map(String::into_bytes).collect()
}

/// Whole ones, and without the closing digest, which the reader puts there.
fn shards() -> Vec<Vec<u8>> {
    let (identity, _) = work();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.phs");
    let numbers = |n: usize| {
        (0..n)
            .flat_map(|i| (i as f64 * 1e-12).to_le_bytes())
            .collect()
    };
    let provenance = || Provenance {
        version: "0.1.0".to_owned(),
        threads: 2,
        seconds: 1.5,
    };
    let mut all = Vec::new();
    for parts in [
        vec![(0..32, numbers(4 * 256))],
        vec![(3..4, numbers(2)), (4..8, vec![]), (8..9, numbers(1))],
        vec![(31..32, vec![7; 3])],
    ] {
        jobs::write(&path, &identity, &parts, provenance()).expect("a shard");
        let bytes = std::fs::read(&path).expect("it was written");
        all.push(bytes[..bytes.len() - 32].to_vec());
        all.push(bytes);
    }
    all
}

fn plans() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("plan.json");
    let render = Settings::Render {
        estimator: Estimator::Shared,
        sampler: Sampling::Sobol,
        seed: 1,
        samples: 512,
    };
    let command = Settings::Command(["study", "noise", "bench"].map(str::to_owned).to_vec());
    let written = |settings| {
        let (identity, blocks) = work();
        PlanFile::new(identity, settings, blocks, 7)
            .write(&path)
            .expect("a plan");
        std::fs::read(&path).expect("it was written")
    };
    [render, command].map(written).to_vec()
}

/// The first byte names the format.
fn meshes() -> Vec<Vec<u8>> {
    let of = |format: u8, bytes: &[u8]| [&[format], bytes].concat();
    let cube = Generator::Box.triangles(12);
    let ply = to_ply(&Generator::Sphere.triangles(20), FaceValues::default());
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n\
        element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
        0 0 0 0.25 0.5\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2 6 0 0 1 0 1 1\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 \\\n4/4\nf -1 -2 -3 # back\n";
    let floats = cube.positions.iter().flat_map(|p| p.to_array());
    let mut buffer: Vec<u8> = floats.flat_map(|x| (x as f32).to_le_bytes()).collect();
    buffer.extend(
        cube.triangles
            .iter()
            .flatten()
            .flat_map(|i| (*i as u16).to_le_bytes()),
    );
    let json = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"children":[1,2]}},{{"mesh":0,"scale":[1,2,3]}},{{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,-1,0,1,2,3,1]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":4}}]}}],"buffers":[{{{uri}"byteLength":360}}],"bufferViews":[{{"buffer":0,"byteLength":288}},{{"buffer":0,"byteOffset":288,"byteLength":72}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":24,"type":"VEC3"}},{{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}}]}}"#
        )
    };
    // Its buffer is its own text: three triangles whose coordinates are what four letters make.
    let beside = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"uri":"a.bin","byteLength":108}],"bufferViews":[{"buffer":0,"byteLength":108}],"accessors":[{"bufferView":0,"componentType":5126,"count":9,"type":"VEC3"}]}"#;
    // The same with a target whose weight is 0.
    let moved = beside.replace(
        r#"{"POSITION":0}}]}"#,
        r#"{"POSITION":0},"targets":[{"POSITION":0}]}],"weights":[0]}"#,
    );
    let zeros = "A".repeat(480);
    vec![
        of(0, &ply),
        of(0, text.as_bytes()),
        of(1, obj.as_bytes()),
        of(1, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nfo 1 2 3\n"),
        of(2, moved.as_bytes()),
        of(
            2,
            json(&format!(
                r#""uri":"data:application/octet-stream;base64,{zeros}","#
            ))
            .as_bytes(),
        ),
        of(2, beside.as_bytes()),
        of(3, &glb(&json(""), &buffer)),
    ]
}

fn glb(json: &str, chunk: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 28 + json.len() + chunk.len();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((length as u32).to_le_bytes());
    for (kind, content) in [(b"JSON", &json[..]), (b"BIN\0", chunk)] {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
    }
    bytes
}

fn pictures() -> Vec<Vec<u8>> {
    use pictures::*;
    let mut all: Vec<Vec<u8>> = [
        &GREY_8[..],
        &GREY_16,
        &RGBA,
        &GREY_ALPHA,
        &PALETTE,
        &BITS,
        &JPEG_GREY,
        &JPEG_COLOUR,
        &JPEG_CMYK,
        &EXR_GREY,
        &EXR_COLOUR,
    ]
    .map(<[u8]>::to_vec)
    .to_vec();
    all.extend(rgb_png([3, 2], &[100; 18], Some(1000)));
    all.extend(grey16_png([3, 2], &[1000; 6]));
    all.push(frame(["B", "G", "R"]));
    all
}

/// The first byte is even for a text and odd for a MERL table, of which no seed is: it has 35 MB.
fn tables() -> Vec<Vec<u8>> {
    let table = |phis: &[u32]| {
        let mut text = String::from("\0theta_i,theta_o,phi,value\n");
        for i in [0, 45, 90] {
            for o in [0, 45, 90] {
                for phi in phis {
                    text.push_str(&format!("{i},{o},{phi},0.2\n"));
                }
            }
        }
        text.into_bytes()
    };
    vec![table(&[0, 180]), table(&[0, 90, 180])]
}

/// A frame of 5 × 3 pixels.
fn frame(names: [&str; 3]) -> Vec<u8> {
    let channels = names.map(|name| Channel {
        name: name.to_owned(),
        values: (0..15).map(|i| i as f32 / 32.0).collect(),
    });
    let run = RunMeta {
        scene_name: "a".into(),
        scene_hash: "0".repeat(64),
        unit: "m".into(),
        spot_count: 2,
        seed: 7,
        samples: 64,
        estimator: "shared".into(),
        sampler: "sobol".into(),
        version: "0".into(),
    };
    let meta = FrameMeta {
        run,
        spot_index: 1,
        spot_position: [1.0, 2.0, 0.0],
    };
    let frame = Frame {
        columns: 5,
        rows: 3,
        channels: channels.into(),
        meta,
    };
    written(|path| exr::write(path, &frame).is_ok())
}

fn arrays() -> Vec<Vec<u8>> {
    let matrix = Matrix::from_fn(9, 3, |i, j| i as f64 - 0.5 * j as f64);
    let other = |descr: &str, order: &str, shape: &str, numbers: usize| {
        let header =
            format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let start = [
            b"\x93NUMPY\x01\0",
            &(header.len() as u16).to_le_bytes()[..],
            header.as_bytes(),
        ]
        .concat();
        [start, vec![0; numbers]].concat()
    };
    vec![
        written(|path| npy::write(path, &matrix).is_ok()),
        other("<f4", "False", "(40, 3)", 480),
        other(">f8", "True", "(4, 3)", 96),
        other("<f8", "False", "(4,)", 32),
    ]
}

/// What `write` leaves in a file.
fn written(write: impl FnOnce(&std::path::Path) -> bool) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("seed");
    assert!(write(&path));
    std::fs::read(path).expect("the file just written")
}
