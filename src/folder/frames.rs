//! The frames of a run: one column of Φcam each, with its parts by the number of surfaces met.

use super::error::FolderError;
use super::record::Record;
use crate::film::{self, Channel, Frame};
use crate::matrix::Matrix;
use crate::scene::Scene;
use crate::transport::Traced;

/// What is kept of each spot: one column per bounce count, then the standard error and its code;
/// pixels × (bounces + 2).
pub fn columns(traced: &Traced) -> impl Iterator<Item = Matrix> {
    (0..traced.flux.ncols()).map(|column| {
        let kept = traced.bounces.iter();
        let kept = kept.chain([&traced.stderr, &traced.tails]);
        let kept: Vec<_> = kept.map(|m| m.column(column).into_owned()).collect();
        Matrix::from_columns(&kept)
    })
}

/// The frame of a spot, from what is kept of it: one column per bounce count, then the standard
/// error and its code.
pub fn frame(scene: &Scene, record: &Record, spot: usize, kept: &Matrix) -> Frame {
    let orders = kept.ncols() - 2;
    let channel = |name: String, values: Vec<f64>| Channel {
        name,
        values: values.into_iter().map(|x| x as f32).collect(),
    };
    let column = |n: usize| kept.column(n).iter().copied().collect();
    // The same order of additions as in the tracer, so that the bits are the same.
    let flux = kept.row_iter().map(|row| row.iter().take(orders).sum());
    let mut channels = vec![
        channel(film::frame::FLUX.into(), flux.collect()),
        channel(film::frame::FLUX_STDERR.into(), column(orders)),
    ];
    channels.extend((0..orders).map(|n| channel(film::frame::bounce_channel(n + 1), column(n))));
    Frame {
        columns: scene.camera.columns,
        rows: scene.camera.rows,
        channels,
        meta: record.meta(scene, spot),
    }
}

/// Frames hold f32: a flux beyond its range would be stored as infinity.
///
/// # Errors
/// [`FolderError`].
pub fn refuse_beyond_f32(traced: &Traced) -> Result<(), FolderError> {
    let most = traced.flux.amax().max(traced.stderr.amax());
    if most <= f64::from(f32::MAX) {
        return Ok(());
    }
    let cause = format!("a flux of {most:.1e} W is more than the f32 of a frame can hold");
    Err(FolderError::new(
        cause,
        "lower the laser's power in the scene",
    ))
}

/// Bytes that the file of a frame of `scene` has at most.
pub fn frame_max(scene: &Scene) -> u64 {
    let size = [scene.camera.columns, scene.camera.rows];
    film::exr::file_max(size, scene.max_bounces as usize + 2)
}
