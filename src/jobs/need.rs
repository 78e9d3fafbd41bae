//! How much memory a scene takes, command by command: upper bounds by the numbers that are held at
//! once, refused before they are taken.

mod numbers;

use super::spots::Spots;
use crate::film::exr::PIXEL_BYTES_MAX;
use crate::geometry::Shape;
use crate::scene::Scene;
use crate::store::memory::{self, NoRoom};
use crate::transport::Plan;
pub use numbers::Need;

/// What the program takes besides, bytes.
const BASE: f64 = 64.0 * 1024.0 * 1024.0;
/// Bytes of a pixel beside its numbers: what it sees, and the heads of what it has traced.
const PIXEL: f64 = 512.0;
/// Terms of an element past what stands in the way.
const TERMS: f64 = 6.0;
/// Unknowns of a calibration whose derivatives are held at once.
const UNKNOWNS: f64 = 16.0;

/// Pixels of a frame of `channels` channels that can be written.
fn most_pixels(channels: f64) -> f64 {
    (PIXEL_BYTES_MAX as f64 / (4.0 * channels)).floor()
}

/// Refuses frames that no file holds: whatever the machine, the scene cannot be rendered.
///
/// # Errors
/// [`NoRoom`].
pub fn frames(scene: &Scene) -> Result<(), NoRoom> {
    let (pixels, channels) = (
        scene.camera.pixels() as f64,
        f64::from(scene.max_bounces) + 2.0,
    );
    let most = most_pixels(channels);
    if pixels <= most {
        return Ok(());
    }
    let cause = format!(
        "{pixels} pixels with max_bounces {} take {} a frame, and a frame has 1 GiB at most",
        scene.max_bounces,
        memory::size(4.0 * pixels * channels)
    );
    let cure = format!("use at most {most} pixels, or fewer max_bounces");
    Err(NoRoom::new(&cause, &cure))
}

/// Refuses a scene whose program for Mitsuba does not fit: numbers as text, held up to five times
/// while it grows.
///
/// # Errors
/// [`NoRoom`].
pub fn mitsuba(scene: &Scene) -> Result<(), NoRoom> {
    const NUMBER: f64 = 5.0 * 25.0;
    const FACE: f64 = 5.0 * 80.0;
    let need = scene.surfaces.iter().map(|s| {
        let [nu, nv] = s.albedo.smooth_cells();
        let faces = match &s.shape {
            Shape::Instance(body) => body.mesh().triangles().len(),
            _ => 0,
        };
        NUMBER * nu as f64 * nv as f64 + FACE * faces as f64
    });
    memory::refuse("the meshes and textures as text", need.sum(), &[])
}

/// Refuses what cannot be rendered in the memory there is.
///
/// # Errors
/// [`NoRoom`].
pub fn render(scene: &Scene, plan: &Plan) -> Result<(), NoRoom> {
    frames(scene)?;
    let bytes = |need: &Need| need.render(plan, together(need, plan));
    Need::of(scene, None).refuse(&format!("the frames by {plan}"), &bytes)
}

/// Refuses a shard that does not fit: one group of spots.
///
/// # Errors
/// [`NoRoom`].
pub fn shard(scene: &Scene, plan: &Plan) -> Result<(), NoRoom> {
    let bytes = |need: &Need| need.tracing(plan, together(need, plan)) + BASE;
    Need::of(scene, None).refuse("the blocks of a shard", &bytes)
}

/// Refuses a merge that does not fit: three matrices of Φcam's size, and one group of spots.
///
/// # Errors
/// [`NoRoom`].
pub fn merge(scene: &Scene, plan: &Plan) -> Result<(), NoRoom> {
    let bytes = |need: &Need| {
        let n = together(need, plan);
        BASE + 3.0 * 8.0 * need.entries() + Need::parts(plan) * need.part(n) + need.writing(n)
    };
    Need::of(scene, None).refuse("the shards put together", &bytes)
}

/// Spots that are traced together.
fn together(need: &Need, plan: &Plan) -> f64 {
    let [pixels, orders] = [need.pixels, need.orders].map(|n| n as usize);
    let most = Spots::together_of(pixels, orders, plan.estimator);
    need.spots.min(most as f64)
}

/// Refuses what cannot be rendered, compared and recovered.
///
/// # Errors
/// [`NoRoom`].
pub fn run(scene: &Scene, plan: &Plan) -> Result<(), NoRoom> {
    render(scene, plan)?;
    if scene.hidden().next().is_none() {
        return Ok(());
    }
    let bytes = |need: &Need| {
        let traced = 8.0 * need.entries() * (need.orders + 4.0);
        traced + need.model() + need.verdict().max(8.0 * 8.0 * need.entries())
    };
    Need::of_model(scene, None).refuse("the frames and their comparison with the model", &bytes)
}

/// Refuses a model that does not fit; `quadrature` where that is asked for besides.
///
/// # Errors
/// [`NoRoom`].
pub fn model(scene: &Scene, elements: Option<[usize; 2]>, quadrature: bool) -> Result<(), NoRoom> {
    let bytes = |need: &Need| {
        let more = if quadrature { need.quadrature() } else { 0.0 };
        need.model() + more
    };
    Need::of_model(scene, elements).refuse("the matrices of the model", &bytes)
}

/// Refuses what is too large to be looked for: the products of the elements' terms with each other,
/// those of every frame and, while they are formed, of each thread.
///
/// # Errors
/// [`NoRoom`].
pub fn locate(scene: &Scene, elements: Option<[usize; 2]>) -> Result<(), NoRoom> {
    let bytes = |need: &Need| {
        let (square, terms) = (need.elements * need.elements, 0.5 * TERMS * need.elements);
        let formed = terms * (terms + 2.0 * need.pixels);
        let held = need.spots * square * (need.threads + 2.0) + 2.0 * need.threads * formed;
        3.0 * 8.0 * need.entries() + need.threads * need.model() + 8.0 * held
    };
    Need::of_model(scene, elements).refuse("the photographs and the model at each size", &bytes)
}

/// Refuses photographs that do not fit beside the model and its derivatives.
///
/// # Errors
/// [`NoRoom`].
pub fn calibrate(scene: &Scene, elements: Option<[usize; 2]>) -> Result<(), NoRoom> {
    let bytes = |need: &Need| {
        let terms = TERMS * need.elements;
        let sides = 8.0 * terms * (need.pixels + need.spots);
        let square = need.elements * need.elements;
        let frames = need.threads * 4.0 * need.pixels * need.elements + need.spots * square;
        6.0 * 8.0 * need.entries() + need.model() + UNKNOWNS * sides + 8.0 * frames
    };
    Need::of_model(scene, elements).refuse("the photographs and the model's derivatives", &bytes)
}

/// Refuses photographs that do not fit beside the model that they are compared with.
///
/// # Errors
/// [`NoRoom`].
pub fn verdict(scene: &Scene) -> Result<(), NoRoom> {
    let bytes = |need: &Need| 4.0 * 8.0 * need.entries() + need.model() + need.verdict();
    Need::of_model(scene, None).refuse("the photographs and the model", &bytes)
}

/// Refuses `matrices` of Φcam's size that do not fit.
///
/// # Errors
/// [`NoRoom`].
pub fn photographs(scene: &Scene, matrices: f64) -> Result<(), NoRoom> {
    let bytes = |need: &Need| BASE + matrices * 8.0 * need.entries() + 64.0 * need.pixels;
    Need::of(scene, None).refuse("the photographs", &bytes)
}

/// Refuses a scene that no study can trace and model: all its spots at once, on every thread what
/// one trial of it takes.
///
/// # Errors
/// [`NoRoom`].
pub fn study(scene: &Scene) -> Result<(), NoRoom> {
    frames(scene)?;
    let bytes = |need: &Need| {
        let traced = 7.0 * need.part(need.spots) + PIXEL * need.pixels;
        let trials = need.threads * 8.0 * 8.0 * need.entries();
        traced + need.model() + need.quadrature() + trials
    };
    Need::of_model(scene, None).refuse("the photographs of a study", &bytes)
}
