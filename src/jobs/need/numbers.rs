//! The numbers of a scene, and the bytes that they take.

use super::{BASE, PIXEL, TERMS};
use crate::geometry::Shape;
use crate::model::is_obstructed;
use crate::scene::{Profile, Scene};
use crate::store::memory::{self, NoRoom};
use crate::transport::{Estimator, Plan};

/// Bytes of a lit point, or of a vertex of a path.
const POINT: f64 = 176.0;
/// Parts of a surface's guide.
const PARTS: f64 = 1024.0;
/// Hidden points that the quadrature handles at once, and wall points of a pixel or a spot.
const CHUNK: f64 = 4096.0;
const WALL: f64 = 16.0 * 128.0;
/// Cells of an element past what stands in the way.
const CELLS: f64 = 1024.0;

/// The numbers of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    pub(super) pixels: f64,
    pub(super) spots: f64,
    pub(super) elements: f64,
    pub(super) orders: f64,
    /// Surfaces, cells of their textures, and facets of meshes.
    surfaces: f64,
    cells: f64,
    wide: bool,
    /// Whether something stands in the way of the model's light.
    obstructed: bool,
    pub(super) threads: f64,
}

/// A need of memory as a function of the numbers.
type Bytes<'a> = &'a dyn Fn(&Need) -> f64;

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
    pub(super) fn of_model(scene: &Scene, elements: Option<[usize; 2]>) -> Self {
        Self {
            obstructed: is_obstructed(scene),
            ..Self::of(scene, elements)
        }
    }

    /// Refuses what needs more than there is. `what` is what is to be done.
    pub(super) fn refuse(&self, what: &str, bytes: Bytes<'_>) -> Result<(), NoRoom> {
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
    pub(super) fn entries(&self) -> f64 {
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
    pub(super) fn part(&self, n: f64) -> f64 {
        8.0 * self.pixels * n * (self.orders + 4.0)
    }

    /// Parts that are held at once: those of the blocks that are there, one for each digit of their
    /// number; what is being added; and what becomes of it.
    pub(super) fn parts(plan: &Plan) -> f64 {
        f64::from(plan.budget.blocks.max(1).ilog2()) + 3.0
    }

    /// A render, `n` spots at a time: the parts, as bytes once more where they are kept on disk; a
    /// frame for each thread on its way to disk; every finished column, and in the end Φcam by the
    /// number of surfaces met besides.
    pub(super) fn render(&self, plan: &Plan, n: f64) -> f64 {
        let kept = 8.0 * self.entries() * (self.orders + 2.0);
        let together = 8.0 * self.entries() * (self.orders + 4.0);
        let batch = self.tracing(plan, n).max(self.writing(n));
        BASE + kept + batch.max(together)
    }

    /// The blocks of `n` spots, and what of them goes to disk.
    pub(super) fn tracing(&self, plan: &Plan, n: f64) -> f64 {
        let kept = f64::from(plan.budget.blocks.max(1).ilog2());
        self.part(n) * (Self::parts(plan) + kept) + self.context(plan, n)
    }

    /// Sums, columns and frames of `n` spots on their way to disk.
    pub(super) fn writing(&self, n: f64) -> f64 {
        let frame = 4.0 * self.pixels * (self.orders + 2.0);
        2.0 * self.part(n) + self.threads.min(n) * 4.0 * frame + 64.0 * self.pixels
    }

    /// The matrix model, its product and one on the way.
    pub(super) fn model(&self) -> f64 {
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
    pub(super) fn quadrature(&self) -> f64 {
        let ends = self.pixels + self.spots;
        let chunk = 8.0 * CHUNK * (self.pixels.min(CHUNK) + self.spots);
        BASE + ends * WALL + chunk + 8.0 * 8.0 * self.entries() + self.past(0.0)
    }

    /// A verdict beside what is tested: the quadrature, then z, derivatives and their scores.
    pub(super) fn verdict(&self) -> f64 {
        self.quadrature() + 8.0 * 24.0 * self.entries()
    }
}
