//! How much memory a scene takes, command by command: upper bounds by the numbers that are held at
//! once, refused before they are taken.

use super::spots::Spots;
use crate::film::exr::PIXEL_BYTES_MAX;
use crate::geometry::Shape;
use crate::model::is_obstructed;
use crate::scene::{Profile, Scene};
use crate::store::memory::{self, NoRoom};
use crate::transport::{Estimator, Plan};

/// What the program takes besides, bytes.
const BASE: f64 = 64.0 * 1024.0 * 1024.0;
/// Bytes of a lit point, or of a vertex of a path.
const POINT: f64 = 176.0;
/// Bytes of a pixel beside its numbers: what it sees, and the heads of what it has traced.
const PIXEL: f64 = 512.0;
/// Parts of a surface's guide.
const PARTS: f64 = 1024.0;
/// Hidden points that the quadrature handles at once, and wall points of a pixel or a spot.
const CHUNK: f64 = 4096.0;
const WALL: f64 = 16.0 * 128.0;

/// The numbers of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    pixels: f64,
    spots: f64,
    elements: f64,
    orders: f64,
    /// Surfaces, cells of their textures, and facets of meshes.
    surfaces: f64,
    cells: f64,
    wide: bool,
    /// Whether something stands in the way of the model's light.
    obstructed: bool,
    threads: f64,
}

/// A need of memory as a function of the numbers.
type Bytes<'a> = &'a dyn Fn(&Need) -> f64;

/// Terms of an element past what stands in the way, and cells of it.
const TERMS: f64 = 6.0;
const CELLS: f64 = 1024.0;
/// Unknowns of a calibration whose derivatives are held at once.
const UNKNOWNS: f64 = 16.0;

impl Need {
    /// Of `scene`; `elements` in place of its own for each surface that is divided by cells.
    pub fn of(scene: &Scene, elements: Option<[usize; 2]>) -> Self {
        let count = |surface: [usize; 2]| {
            let [nu, nv] = elements.unwrap_or(surface);
            nu as f64 * nv as f64
        };
        let cells = scene.surfaces.iter().map(|s| {
            let faces = match &s.shape {
                Shape::Instance(body) => body.facet_count() as f64,
                _ => 0.0,
            };
            let [nu, nv] = s.albedo.smooth_cells();
            faces + nu as f64 * nv as f64
        });
        Self {
            pixels: scene.camera.pixels() as f64,
            spots: scene.laser.spots.len() as f64,
            elements: scene.hidden().map(|(_, s)| count(s.elements)).sum(),
            orders: f64::from(scene.max_bounces),
            surfaces: scene.surfaces.len() as f64,
            cells: cells.sum(),
            wide: scene.laser.profile != Profile::Ideal,
            obstructed: false,
            threads: rayon::current_num_threads() as f64,
        }
    }

    /// The same for what computes the model.
    fn of_model(scene: &Scene, elements: Option<[usize; 2]>) -> Self {
        Self {
            obstructed: is_obstructed(scene),
            ..Self::of(scene, elements)
        }
    }

    /// Refuses what needs more than there is. `what` is what is to be done.
    fn refuse(&self, what: &str, bytes: Bytes<'_>) -> Result<(), NoRoom> {
        let with = |change: fn(&mut Self, f64)| {
            move |n: f64| {
                let mut other = *self;
                change(&mut other, n);
                bytes(&other)
            }
        };
        let pixels = with(|need, n| need.pixels = n);
        let spots = with(|need, n| need.spots = n);
        let elements = with(|need, n| need.elements = n);
        let orders = with(|need, n| need.orders = n);
        let what = format!(
            "{what}: {} pixels × {} spots with {} elements and max_bounces {}",
            self.pixels, self.spots, self.elements, self.orders
        );
        memory::refuse(
            &what,
            bytes(self),
            &[
                ("pixels", self.pixels as u64, &pixels),
                ("spots", self.spots as u64, &spots),
                ("elements", self.elements as u64, &elements),
                ("max_bounces", self.orders as u64, &orders),
            ],
        )
    }

    /// Entries of Φcam.
    fn entries(&self) -> f64 {
        self.pixels * self.spots
    }

    /// What the tracer holds beside its sums, `n` spots together.
    fn context(&self, plan: &Plan, n: f64) -> f64 {
        let threads = self.threads;
        let lit = n * (POINT + 64.0 * self.surfaces) + self.spots * POINT;
        let guided = (1.0 + threads) * n * self.surfaces * PARTS * 16.0;
        let guided = guided.min((1.0 + threads) * 134e6);
        let beams = if self.wide { 1024.0 * n * POINT } else { 0.0 };
        let size =
            f64::from(plan.budget.size).max(self.cells.min(f64::from(plan.budget.size) * 2.0));
        let deeper = (self.orders - 2.0).max(1.0);
        let own = match plan.estimator {
            Estimator::Independent => threads * beams / n.max(1.0) + guided,
            Estimator::Shared => threads * beams,
            Estimator::Factored => {
                let width = n + 8.0;
                let chunk = 256.0 * width * deeper.max(1.0) * 8.0;
                let batches = if self.wide { 256.0 * width * 72.0 } else { 0.0 };
                self.pixels * (48.0 + 56.0 * self.surfaces)
                    + 2.0 * size * (96.0 + POINT * deeper)
                    + chunk.max(1048576.0)
                    + threads * (chunk + batches + 16.0 * CHUNK)
                    + beams.max(1024.0 * POINT * 128.0)
            }
        };
        self.pixels * PIXEL + lit + own + 48.0 * self.cells
    }

    /// Numbers of the sums of one block of `n` spots, and of their spread.
    fn part(&self, n: f64) -> f64 {
        8.0 * self.pixels * n * (self.orders + 4.0)
    }

    /// Parts that are held at once: those of the blocks that are there, one for each digit of their
    /// number; what is being added; and what becomes of it.
    fn parts(plan: &Plan) -> f64 {
        f64::from(plan.budget.blocks.max(1).ilog2()) + 3.0
    }

    /// A render, `n` spots at a time: the parts, as bytes once more where they are kept on disk; a
    /// frame for each thread on its way to disk; every finished column, and in the end Φcam by the
    /// number of surfaces met besides.
    fn render(&self, plan: &Plan, n: f64) -> f64 {
        let kept = 8.0 * self.entries() * (self.orders + 2.0);
        let together = 8.0 * self.entries() * (self.orders + 4.0);
        let batch = self.tracing(plan, n).max(self.writing(n));
        BASE + kept + batch.max(together)
    }

    /// The blocks of `n` spots, and what of them goes to disk.
    fn tracing(&self, plan: &Plan, n: f64) -> f64 {
        let kept = f64::from(plan.budget.blocks.max(1).ilog2());
        self.part(n) * (Self::parts(plan) + kept) + self.context(plan, n)
    }

    /// Sums, columns and frames of `n` spots on their way to disk.
    fn writing(&self, n: f64) -> f64 {
        let frame = 4.0 * self.pixels * (self.orders + 2.0);
        2.0 * self.part(n) + self.threads.min(n) * 4.0 * frame + 64.0 * self.pixels
    }

    /// The matrix model, its product and one on the way.
    fn model(&self) -> f64 {
        let sides = 2.0 * self.elements * (self.pixels + self.spots);
        let points = 256.0 * (self.pixels + self.spots + self.elements);
        let matrices = 8.0 * (sides + 2.0 * self.entries() + self.elements * self.spots);
        BASE + matrices + points + self.past(3.0 * TERMS * sides)
    }

    /// What it takes to see past what stands in the way, beside `terms` numbers: the footprints'
    /// parts, and the light of the cells that are held at once.
    fn past(&self, terms: f64) -> f64 {
        if !self.obstructed {
            return 0.0;
        }
        let cells = CELLS * self.threads.min(self.elements) * self.pixels;
        8.0 * terms + 1024.0 * self.pixels + 48.0 * cells.max(CELLS * CHUNK)
    }

    /// The quadrature: wall points of every pixel and spot, a chunk of hidden points against all of
    /// them, five matrices of Φcam's size.
    fn quadrature(&self) -> f64 {
        let ends = self.pixels + self.spots;
        let chunk = 8.0 * CHUNK * (self.pixels.min(CHUNK) + self.spots);
        BASE + ends * WALL + chunk + 8.0 * 8.0 * self.entries() + self.past(0.0)
    }

    /// A verdict beside what is tested: the quadrature, then z, derivatives and their scores.
    fn verdict(&self) -> f64 {
        self.quadrature() + 8.0 * 24.0 * self.entries()
    }
}

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
