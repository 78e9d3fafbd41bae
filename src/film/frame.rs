//! The frame: one photograph of the wall for one laser spot.

/// Channel of the flux into each pixel, all bounces together, W.
pub const FLUX: &str = "flux";
/// Channel of the standard error of [`FLUX`], W.
pub const FLUX_STDERR: &str = "flux.stderr";

/// Channel of the counts of a sensor: what its converter gave, averaged over frames; no unit. With
/// several exposure times `counts.0`, `counts.1`, …, the longest first.
pub const COUNTS: &str = "counts";

/// Name of the channel that holds the part of the flux that met `bounces` surfaces between laser
/// and camera, W: `flux.b3` for three.
///
/// ```
/// assert_eq!(phicam::film::frame::bounce_channel(3), "flux.b3");
/// ```
pub fn bounce_channel(bounces: usize) -> String {
    format!("{FLUX}.b{bounces}")
}

/// Name of the file that holds the frame of `spot`, four digits at least.
///
/// ```
/// assert_eq!(phicam::film::frame::frame_name(7), "spot-0007.exr");
/// assert_eq!(phicam::film::frame::frame_name(12345), "spot-12345.exr");
/// ```
pub fn frame_name(spot: u32) -> String {
    format!("spot-{spot:04}.exr")
}

/// One photograph: `columns` × `rows` pixels in one or more channels. Pixel index = column +
/// row·columns; columns go along +x and rows along +y of the camera's view, row 0 first.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Pixels along x.
    pub columns: usize,
    /// Pixels along y.
    pub rows: usize,
    /// The channels, each with columns·rows values. Their order has no meaning: a file sorts them
    /// by name.
    pub channels: Vec<Channel>,
    /// Where the frame comes from.
    pub meta: FrameMeta,
}

/// One quantity over all pixels of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// [`FLUX`], [`FLUX_STDERR`], a [`bounce_channel`], [`COUNTS`], or another; 1 to 255 bytes of
    /// printable ASCII.
    pub name: String,
    /// One value a pixel, by pixel index; fluxes in W.
    pub values: Vec<f32>,
}

/// Where a frame comes from: enough to know which frames belong to one run, and to render the frame
/// again.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameMeta {
    /// What all frames of the run have in common.
    pub run: RunMeta,
    /// Which spot this frame shows, from 0.
    pub spot_index: u32,
    /// Where the spot is, in the unit of the run.
    pub spot_position: [f64; 3],
}

/// What all frames of one run have in common.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunMeta {
    /// Name of the scene.
    pub scene_name: String,
    /// SHA-256 of the scene, hexadecimal.
    pub scene_hash: String,
    /// Length unit of the scene: m, cm, mm or in.
    pub unit: String,
    /// Spots of the run.
    pub spot_count: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Samples, counted as the estimator counts them.
    pub samples: u64,
    /// Name of the estimator.
    pub estimator: String,
    /// Name of the sampler.
    pub sampler: String,
    /// Version of the program.
    pub version: String,
}

impl Frame {
    /// Values of the channel `name`, by pixel index; `None` if the frame has no such channel.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels
            .iter()
            .find(|c| c.name == name)
            .map(|c| c.values.as_slice())
    }

    /// Pixels of the frame, columns·rows.
    pub fn pixels(&self) -> usize {
        self.columns * self.rows
    }
}
