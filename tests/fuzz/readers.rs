//! What reads bytes from outside, as the fuzz targets and `tests/forged` run it: bytes are refused
//! with a reason, or give a value that keeps its promises. A panic is a finding, and so is memory
//! beyond the stated bound.

use std::io::Write;
use std::path::Path;
use std::sync::OnceLock;

use phicam::film::exr;
use phicam::image::{self, DEFLATE_RATIO_MAX, MOST_PIXELS, MOST_SAMPLED, MOST_SAMPLES};
use phicam::jobs::{BlockFile, Identity, PlanFile};
use phicam::matrix::{MOST_ENTRIES, mat, npy};
use phicam::num::stream::Sampling;
use phicam::photographs::Set;
use phicam::scene::{Scene, mesh};
use phicam::transport::{Budget, Estimator, Plan, Tally};
use sha2::{Digest, Sha256};

/// What became of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A value.
    Accepted,
    /// An error that says why.
    Refused,
    /// Not tried: it asks for what takes long as it should.
    Passed,
}

/// A reader under test.
pub struct Reader {
    /// Its name: of the target, and of its folders of seeds and findings.
    pub name: &'static str,
    /// Reads an input.
    pub read: fn(&[u8]) -> Outcome,
    /// Most bytes of memory that an input of so many bytes may take.
    pub memory: fn(usize) -> usize,
}

/// All of them.
pub const ALL: [Reader; 11] = [
    SCENE, MESH, PICTURE, MEASURED, FRAME, NPY, SHARD, PLAN, PHOTOGRAPH, ARRAY, LIST,
];

const MIB: usize = 1 << 20;

/// A scene file that names no others, up to everything that `phicam scene check` says of it.
pub const SCENE: Reader = Reader {
    name: "scene",
    read: |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else {
            return Outcome::Refused;
        };
        if asks_for_many_triangles(text) {
            return Outcome::Passed;
        }
        let Ok(scene) = Scene::from_toml("scene.toml", text).map_err(reason) else {
            return Outcome::Refused;
        };
        // Every pixel and every spot is looked at.
        if scene.camera.pixels() <= 10_000 && scene.laser.spots.len() <= 1_000 {
            for warning in scene.warnings() {
                reason(warning);
            }
        }
        Outcome::Accepted
    },
    memory: |_| 1024 * MIB,
};

/// A mesh of any format: the first byte says which, the rest is the file, and any file beside it.
/// Nodes of a glTF may multiply what it holds, to four million vertices and triangles.
pub const MESH: Reader = Reader {
    name: "mesh",
    read: |bytes| {
        let Some((first, rest)) = bytes.split_first() else {
            return Outcome::Refused;
        };
        let name = ["a.ply", "a.obj", "a.gltf", "a.glb"][usize::from(first % 4)];
        let Ok(found) = mesh::read(name, rest, &mut |_| Ok(rest.to_vec())).map_err(reason) else {
            return Outcome::Refused;
        };
        let count = found.positions.len();
        assert!(
            found
                .triangles
                .iter()
                .flatten()
                .all(|c| (*c as usize) < count)
        );
        let (mended, _) = found.mended();
        assert!(mended.positions.iter().all(|p| p.is_finite()));
        assert!(
            mended
                .uv
                .is_none_or(|uv| uv.len() == mended.triangles.len())
        );
        Outcome::Accepted
    },
    memory: |length| 1024 * length + 640 * MIB,
};

/// A picture by its first bytes. At most 48 bytes a pixel, as `phicam::image` says.
pub const PICTURE: Reader = Reader {
    name: "picture",
    read: |bytes| {
        let Ok(image) = image::decode("a", bytes).map_err(reason) else {
            return Outcome::Refused;
        };
        let pixels = image.width * image.height;
        assert!(pixels > 0 && pixels <= MOST_PIXELS);
        assert_eq!(image.values.len(), pixels * image.channels.len());
        Outcome::Accepted
    },
    memory: |length| 48 * MOST_PIXELS.min(8 * DEFLATE_RATIO_MAX * length) + MIB,
};

/// A photograph, or several in a file, as a camera stored them. LZW makes at most 1400 bytes of
/// one; the samples are held twice while they are turned upright, each up to 24 bytes.
pub const PHOTOGRAPH: Reader = Reader {
    name: "photograph",
    read: |bytes| {
        let Ok(frames) = image::samples("a", bytes).map_err(reason) else {
            return Outcome::Refused;
        };
        assert!(!frames.is_empty());
        for frame in &frames {
            let pixels = frame.width * frame.height;
            assert!(pixels > 0 && pixels <= MOST_SAMPLED);
            assert_eq!(frame.values.len(), pixels * frame.channels.len());
            assert!(frame.values.iter().all(|x| x.is_finite()));
        }
        Outcome::Accepted
    },
    memory: |length| 32 * MOST_SAMPLES.min(1400 * length) + 4 * MIB,
};

/// An array of NumPy or MATLAB, by its first bytes.
pub const ARRAY: Reader = Reader {
    name: "array",
    read: |bytes| {
        let read = match bytes {
            [0x93, ..] => npy::read_array("a", bytes),
            _ => mat::read("a", bytes, None),
        };
        let Ok(array) = read.map_err(reason) else {
            return Outcome::Refused;
        };
        assert_eq!(array.shape.iter().product::<usize>(), array.values.len());
        assert!(array.values.iter().all(|x| x.is_finite()));
        Outcome::Accepted
    },
    memory: |length| 24 * MOST_ENTRIES.min(1032 * length) + 2 * MIB,
};

/// The list of a set of photographs.
pub const LIST: Reader = Reader {
    name: "list",
    read: |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else {
            return Outcome::Refused;
        };
        match Set::parse("set.toml", text).map_err(reason) {
            Ok(set) => {
                assert!(set.camera_noise().is_ok());
                Outcome::Accepted
            }
            Err(()) => Outcome::Refused,
        }
    },
    memory: |length| 256 * length + 4 * MIB,
};

/// A measured material, as a scene names it: the first byte says whether it is a text or a MERL
/// table.
pub const MEASURED: Reader = Reader {
    name: "measured",
    read: |bytes| {
        let Some((first, rest)) = bytes.split_first() else {
            return Outcome::Refused;
        };
        let (name, channel) = match first % 2 {
            0 => ("wall.csv", ""),
            _ => ("wall.binary", ", channel = \"red\""),
        };
        let material = format!("material = {{ measured = \"{name}\"{channel} }}");
        let scene = include_str!("../../scenes/bench.toml");
        let scene = scene.replacen("material = { lambertian = 0.8 }", &material, 1);
        in_folder(
            &[("scene.toml", scene.as_bytes()), (name, rest)],
            |folder| {
                let path = folder.join("scene.toml");
                match Scene::load(&path.to_string_lossy()).map_err(reason) {
                    Ok(_) => Outcome::Accepted,
                    Err(()) => Outcome::Refused,
                }
            },
        )
    },
    memory: |length| 64 * length + 16 * MIB,
};

/// A frame. Its pixels are at most what deflate makes of so many bytes; they are held twice while
/// they are put in place.
pub const FRAME: Reader = Reader {
    name: "frame",
    read: |bytes| {
        in_folder(&[("frame.exr", bytes)], |folder| {
            let Ok(frame) = exr::read(&folder.join("frame.exr")).map_err(reason) else {
                return Outcome::Refused;
            };
            let whole = |c: &phicam::film::Channel| c.values.len() == frame.pixels();
            assert!(frame.pixels() > 0 && frame.channels.iter().all(whole));
            Outcome::Accepted
        })
    },
    memory: |length| 2 * (DEFLATE_RATIO_MAX * length).min(exr::PIXEL_BYTES_MAX) + 4 * MIB,
};

/// A matrix: at once, and some rows at a time, which must be the same numbers.
pub const NPY: Reader = Reader {
    name: "npy",
    read: |bytes| {
        in_folder(&[("a.npy", bytes)], |folder| {
            let path = folder.join("a.npy");
            let Ok(matrix) = npy::read(&path).map_err(reason) else {
                assert!(npy::Rows::open(&path).is_err());
                return Outcome::Refused;
            };
            let finite = npy::read_finite(&path).map_err(reason);
            assert_eq!(finite.is_ok(), matrix.iter().all(|x| x.is_finite()));
            if let (Ok(mut rows), Ok(finite)) = (npy::Rows::open(&path).map_err(reason), finite) {
                assert_eq!(rows.shape(), (matrix.nrows(), matrix.ncols()));
                for first in (0..matrix.nrows()).step_by(7) {
                    let some = rows.read(first, 7).map_err(reason);
                    assert_eq!(some.as_ref().map(|m| m.ncols()), Ok(matrix.ncols()));
                    let some = some.unwrap_or_default();
                    assert_eq!(some, finite.rows(first, some.nrows()));
                }
            }
            Outcome::Accepted
        })
    },
    // Three matrices, each twice what its numbers take as f32.
    memory: |length| 8 * length + MIB / 4,
};

/// A shard, as it is, and with a closing digest that is right; then what it holds, added up.
pub const SHARD: Reader = Reader {
    name: "shard",
    read: |bytes| {
        let (identity, total) = work();
        let sealed = [bytes, &Sha256::digest(bytes)[..]].concat();
        in_folder(&[("a.phs", bytes), ("b.phs", &sealed)], |folder| {
            let mut outcome = Outcome::Refused;
            for name in ["a.phs", "b.phs"] {
                let Ok(shard) =
                    BlockFile::open(&folder.join(name), &identity, total).map_err(reason)
                else {
                    continue;
                };
                assert!(shard.range.start < shard.range.end && shard.range.end <= total);
                let mut end = shard.range.start;
                static BENCH: OnceLock<Scene> = OnceLock::new();
                let bench = || {
                    let text = include_str!("../../scenes/bench.toml");
                    Scene::from_toml("bench.toml", text).expect("the built-in bench")
                };
                let scene = BENCH.get_or_init(bench);
                let plan = Plan {
                    estimator: Estimator::Shared,
                    sampling: Sampling::Pcg,
                    seed: 1,
                    budget: Budget {
                        blocks: 32,
                        size: 1,
                    },
                };
                let mut tally = Tally::new(scene, &plan, 1, end as u32);
                for part in shard.parts(0..total) {
                    let (range, bytes) = part.expect("it was read before");
                    assert_eq!(range.start, end);
                    end = range.end;
                    let range = range.start as u32..range.end as u32;
                    let _ = tally.add_part(range, &bytes).map_err(reason);
                }
                assert_eq!(end, shard.range.end);
                if let Some(traced) = tally.traced(scene, 0..1) {
                    assert!(traced.flux.iter().all(|x| *x >= 0.0));
                    assert!(traced.stderr.iter().all(|x| *x >= 0.0));
                }
                outcome = Outcome::Accepted;
            }
            outcome
        })
    },
    // The header's JSON becomes numbers; a scene and one column of 256 pixels besides.
    memory: |length| 64 * length + 4 * MIB,
};

/// What the seeds of shards belong to.
pub fn work() -> (Identity, u64) {
    let identity = Identity::default()
        .with("scene", "bench")
        .with("seed", 1)
        .with(Identity::NUMERICS, 1);
    (identity, 32)
}

/// A plan, and every range that it promises.
pub const PLAN: Reader = Reader {
    name: "plan",
    read: |bytes| {
        in_folder(&[("plan.json", bytes)], |folder| {
            let Ok(plan) = PlanFile::read(&folder.join("plan.json")).map_err(reason) else {
                return Outcome::Refused;
            };
            let plan = plan.expect("the file is there");
            assert_eq!(plan.range(0).start, 0);
            assert_eq!(plan.range(plan.shards - 1).end, plan.blocks);
            for k in [0, plan.shards / 2, plan.shards - 1] {
                assert!(!plan.range(k).is_empty());
            }
            Outcome::Accepted
        })
    },
    memory: |length| 64 * length + MIB,
};

/// A reason can be told, and says something.
fn reason(error: impl std::fmt::Display) {
    assert!(error.to_string().len() > 10, "`{error}` is no reason");
}

/// Whether a text names a number of triangles beyond 20 000: the format allows it, and making them
/// takes its time.
fn asks_for_many_triangles(text: &str) -> bool {
    text.match_indices("faces").any(|(at, _)| {
        let rest = text[at + 5..].trim_start_matches([' ', '\t', '"', '\'', '=']);
        let digits = rest.split(|c: char| !c.is_ascii_alphanumeric() && !"_+".contains(c));
        let number = digits.into_iter().next().unwrap_or_default();
        number.len() > 5 || number.parse::<u32>().is_ok_and(|n| n > 20_000)
    })
}

/// Files in a folder that is gone afterwards.
fn in_folder<T>(files: &[(&str, &[u8])], run: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes) in files {
        let file = std::fs::File::create(folder.path().join(name));
        file.and_then(|mut f| f.write_all(bytes))
            .expect("a temporary file");
    }
    run(folder.path())
}
