use super::*;
use crate::film::{Channel, FrameMeta, RunMeta};

const SPOTS: u32 = 12;

/// Entry (p, l) of a channel: exact in f32, and different for every pixel, spot and channel.
fn value(channel: usize, p: usize, l: u32) -> f32 {
    (1 + p) as f32 + 1000.0 * l as f32 + 0.25 * channel as f32
}

fn frame(spot: u32) -> Frame {
    let names = [FLUX, FLUX_STDERR, "flux.b10", "flux.b3"];
    let values = |c| (0..6).map(|p| value(c, p, spot)).collect();
    let channels = names.iter().enumerate().map(|(c, name)| Channel {
        name: (*name).into(),
        values: values(c),
    });
    let run = RunMeta {
        scene_name: "bench".into(),
        scene_hash: "ab".repeat(32),
        unit: "in".into(),
        spot_count: SPOTS,
        seed: 7,
        samples: 64,
        estimator: "independent".into(),
        sampler: "pcg".into(),
        version: "0.1.0".into(),
    };
    let meta = FrameMeta {
        run,
        spot_index: spot,
        spot_position: [f64::from(spot), 0.1, 0.0],
    };
    Frame {
        columns: 3,
        rows: 2,
        channels: channels.collect(),
        meta,
    }
}

/// A whole run, after `change` had its way with the frame of each spot.
fn run(change: impl Fn(&mut Frame)) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("frames")).unwrap();
    for spot in 0..SPOTS {
        let mut frame = frame(spot);
        change(&mut frame);
        exr::write(&file(&dir, spot), &frame).unwrap();
    }
    dir
}

fn file(dir: &tempfile::TempDir, spot: u32) -> PathBuf {
    dir.path().join("frames").join(frame_name(spot))
}

fn refusal(dir: &tempfile::TempDir) -> String {
    stack(dir.path()).unwrap_err().to_string()
}

/// Changes the frame of spot 5 only.
fn fifth(change: impl Fn(&mut Frame)) -> tempfile::TempDir {
    run(|frame| {
        if frame.meta.spot_index == 5 {
            change(frame);
        }
    })
}

#[test]
fn columns_are_spots_and_rows_are_pixels() {
    let dir = run(|_| ());
    let whole = stack(dir.path()).unwrap();
    assert_eq!(whole.resolution, [3, 2]);
    let expected = |c| Matrix::from_fn(6, SPOTS as usize, |p, l| f64::from(value(c, p, l as u32)));
    assert_eq!(whole.phi, expected(0));
    assert_eq!(whole.stderr, expected(1));
    assert_eq!(
        whole.bounces,
        [
            ("flux.b3".to_owned(), expected(3)),
            ("flux.b10".to_owned(), expected(2))
        ]
    );
    assert_eq!(whole.spot_positions[11], [11.0, 0.1, 0.0]);
    assert_eq!(whole.run, frame(0).meta.run);
    assert_eq!(stack(&dir.path().join("frames")).unwrap(), whole);
}

#[test]
fn missing_spots_are_named_compactly() {
    let dir = run(|_| ());
    for spot in [3, 7, 8, 9, 11] {
        std::fs::remove_file(file(&dir, spot)).unwrap();
    }
    assert!(
        refusal(&dir).contains("5 of 12 spots: 3, 7-9, 11;"),
        "{}",
        refusal(&dir)
    );
    std::fs::remove_file(file(&dir, 0)).unwrap();
    assert!(
        refusal(&dir).contains("6 of 12 spots: 0, 3, 7-9, 11;"),
        "{}",
        refusal(&dir)
    );
}

#[test]
fn no_frames_is_said() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("other.exr"), b"").unwrap();
    assert!(matches!(
        stack(dir.path()),
        Err(StackError::NoFrames { .. })
    ));
    let nowhere = stack(&dir.path().join("nowhere"));
    assert!(
        matches!(nowhere, Err(StackError::Unreadable { .. })),
        "{nowhere:?}"
    );
}

#[test]
fn frames_of_different_runs_are_refused() {
    type Change = fn(&mut Frame);
    let changes: [(&str, Change); 11] = [
        ("scene hash", |f| f.meta.run.scene_hash = "cd".repeat(32)),
        ("scene", |f| f.meta.run.scene_name = "thesis".into()),
        ("size", |f| (f.columns, f.rows) = (2, 3)),
        ("channels", |f| drop(f.channels.pop())),
        ("length unit", |f| f.meta.run.unit = "cm".into()),
        ("number of spots", |f| f.meta.run.spot_count += 1),
        ("seed", |f| f.meta.run.seed += 1),
        ("samples", |f| f.meta.run.samples += 1),
        ("estimator", |f| f.meta.run.estimator = "shared".into()),
        ("sampler", |f| f.meta.run.sampler = "sobol".into()),
        ("version", |f| f.meta.run.version = "0.2.0".into()),
    ];
    for (expected, change) in changes {
        let refused = stack(fifth(change).path());
        let named = matches!(&refused, Err(StackError::Mismatch { property, path, .. })
            if *property == expected && path.ends_with("spot-0005.exr"));
        assert!(named, "{expected}: {refused:?}");
    }
}

#[test]
fn doubles_misnamed_and_surplus_frames_are_refused() {
    let dir = run(|_| ());
    let twin = dir.path().join("frames/spot-00004.exr");
    std::fs::copy(file(&dir, 4), &twin).unwrap();
    assert!(matches!(
        stack(dir.path()),
        Err(StackError::Duplicate { spot: 4, .. })
    ));
    std::fs::rename(&twin, file(&dir, 6)).unwrap();
    assert!(matches!(
        stack(dir.path()),
        Err(StackError::Misnamed { spot: 4, .. })
    ));
    let surplus = run(|_| ());
    std::fs::copy(file(&surplus, 4), file(&surplus, SPOTS)).unwrap();
    assert!(matches!(
        stack(surplus.path()),
        Err(StackError::Surplus { spot: SPOTS, .. })
    ));
}

#[test]
fn values_that_no_rendering_gives_are_refused_by_name_and_place() {
    // Pixel 4 of 3 × 2 is column 1, row 1.
    for (channel, bad) in [
        (0, f32::NAN),
        (0, f32::NEG_INFINITY),
        (1, f32::INFINITY),
        (1, -1.0e-30),
        (3, f32::NAN),
    ] {
        let dir = fifth(|f| f.channels[channel].values[4] = bad);
        let name = frame(0).channels[channel].name.clone();
        let told = refusal(&dir);
        assert!(
            told.contains("spot-0005.exr") && told.contains("(column 1, row 1)"),
            "{told}"
        );
        assert!(
            told.contains(&format!("in channel {name} at"))
                && told.contains("render its spot again"),
            "{told}"
        );
    }
    // A negative flux is a matter of the estimator, not of the file.
    let negative = fifth(|f| f.channels[0].values[4] = -1.0);
    assert_eq!(stack(negative.path()).unwrap().phi[(4, 5)], -1.0);
}

#[test]
fn a_truncated_frame_and_one_without_flux_are_refused() {
    let dir = run(|_| ());
    let bytes = std::fs::read(file(&dir, 5)).unwrap();
    std::fs::write(file(&dir, 5), &bytes[..bytes.len() - 1]).unwrap();
    assert!(
        refusal(&dir).contains("spot-0005.exr is damaged"),
        "{}",
        refusal(&dir)
    );
    let fluxless = run(|f| f.channels.retain(|c| c.name != FLUX));
    assert!(
        refusal(&fluxless).contains("no channel flux"),
        "{}",
        refusal(&fluxless)
    );
}

#[test]
fn a_forged_number_of_spots_takes_no_memory() {
    let dir = run(|f| f.meta.run.spot_count = 2_000_000_000);
    assert!(
        refusal(&dir).contains("1999999988 of 2000000000 spots: 12-1999999999"),
        "{}",
        refusal(&dir)
    );
}
