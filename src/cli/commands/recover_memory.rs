//! How much memory a recovery takes, and Φcam by rows where it would be more than there is.

use std::path::Path;

use crate::cli::args::RecoverArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{refuse_damaged, refuse_shape};
use crate::lab::{Attempt, Certainty, Judged, MOST_INTEGRATED, Residuals, measured};
use crate::matrix::npy::Rows;
use crate::model::MatrixModel;
use crate::recovery::{
    Method, Options, Problem, Recovered, Strip, recover_strips, two_valued_bytes,
};
use crate::scene::Scene;
use crate::store::memory::{GIB, room};

/// What the program takes besides.
const BASE: f64 = 64.0 * 1024.0 * 1024.0;
/// Pixels of the largest strip.
const MOST_PIXELS: f64 = 4096.0;

/// How Φcam is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    Whole,
    /// So many pixels at a time.
    Strips(usize),
}

/// The numbers of a problem.
#[derive(Clone, Copy, Debug)]
struct Size {
    pixels: f64,
    spots: f64,
    elements: f64,
}

impl Size {
    /// The four matrices of the model.
    fn model(self) -> f64 {
        8.0 * 2.0 * self.elements * (self.pixels + self.spots)
    }

    /// Everything at once, an upper bound: Φcam, its errors and three matrices of their size on the
    /// way, four of D's; of a joint method weighted copies of both sides and three of its product
    /// besides, and the normal equations six times over; of few elements their terms, four each and
    /// twice.
    fn whole(self, joint: bool, budget: usize) -> f64 {
        let phi = self.pixels * self.spots;
        let sides = self.elements * (self.pixels + self.spots);
        let more = if joint {
            let normal = 6.0 * self.elements * self.elements;
            2.0 * phi + 3.0 * sides + 3.0 * budget as f64 + normal
        } else {
            0.0
        };
        let terms = if self.elements <= MOST_INTEGRATED as f64 {
            8.0 * sides
        } else {
            0.0
        };
        BASE + self.model() + 8.0 * (5.0 * phi + 4.0 * self.elements * self.spots + more + terms)
    }

    /// What strips need however low they are: the model, D decomposed, a matrix of spots × elements
    /// and another on the way.
    fn beside(self) -> f64 {
        BASE + self.model() + 8.0 * 6.0 * self.elements * self.spots
    }

    /// One pixel of a strip: Φcam and its errors as they are read and on the way, C and what is
    /// divided by it.
    fn pixel(self) -> f64 {
        8.0 * (6.0 * self.spots + 5.0 * self.elements)
    }
}

/// Elements of all hidden surfaces.
pub(super) fn elements(args: &RecoverArgs, scene: &Scene) -> usize {
    let of = |[nu, nv]: [usize; 2]| nu.saturating_mul(nv);
    let each = scene
        .hidden()
        .map(|(_, s)| of(args.elements.unwrap_or(s.elements)));
    each.fold(0, usize::saturating_add)
}

/// How the photographs are to be held within the memory allowed; says what will be taken where that
/// is much.
pub(super) fn plan(
    args: &RecoverArgs,
    scene: &Scene,
    methods: &[Method],
    options: &Options,
    console: Console,
) -> Result<Held, Failure> {
    let size = Size {
        pixels: scene.camera.pixels() as f64,
        spots: scene.laser.spots.len() as f64,
        elements: elements(args, scene) as f64,
    };
    let allowed = args
        .memory
        .map(|m| m * GIB)
        .or_else(|| room().map(|room| room.bytes));
    let joint = methods.iter().any(|m| m.is_joint());
    let lattices = if methods.contains(&Method::JointTwoValued) {
        two_valued_bytes(elements(args, scene))
    } else {
        0.0
    };
    let whole = size.whole(joint, options.budget) + lattices;
    if allowed.is_none_or(|allowed| whole <= allowed) {
        if whole > GIB {
            console.say(format!("memory: up to {:.1} GiB", whole / GIB));
        }
        return Ok(Held::Whole);
    }
    let allowed = allowed.unwrap_or(whole);
    let pixels = ((allowed - size.beside()) / size.pixel()).floor();
    if pixels < 1.0 {
        let cause = format!(
            "the model alone needs {:.2} GiB of memory, and {:.2} may be taken",
            (size.beside() + size.pixel()) / GIB,
            allowed / GIB
        );
        return Err(Failure::new(
            cause,
            "use fewer --elements, or allow more (--memory)",
        ));
    }
    let pixels = pixels.min(MOST_PIXELS).min(size.pixels);
    console.say(format!(
        "memory: up to {:.2} GiB (all of Φcam at once would take {:.2}, and {:.2} may be taken): Φcam is read by {pixels} pixels at a time",
        (size.beside() + pixels * size.pixel()) / GIB,
        whole / GIB,
        allowed / GIB
    ));
    Ok(Held::Strips(pixels as usize))
}

/// A file of Φcam's shape, opened.
pub(super) fn open(path: &Path, scene: &Scene) -> Result<Rows, Failure> {
    let rows = Rows::open(path)?;
    refuse_shape(path, rows.shape(), scene)?;
    refuse_damaged(path)?;
    Ok(rows)
}

/// Where the standard errors of Φcam come from.
pub(super) enum Errors<F> {
    Unknown,
    /// Relative to each entry.
    Relative(f64),
    File(F),
}

/// Φcam, read by rows.
pub(super) struct Strips<'a> {
    pub model: &'a MatrixModel,
    pub phi: Rows,
    pub errors: Errors<Box<Rows>>,
    pub certainty: Certainty,
    /// Of one strip.
    pub pixels: usize,
}

impl Strips<'_> {
    /// The hidden objects by each method.
    pub(super) fn recover(
        &mut self,
        methods: &[Method],
        options: &Options,
    ) -> Result<Vec<Attempt>, Failure> {
        let model = self.model;
        let mut attempts = Vec::new();
        for &method in methods {
            // What the files refuse is not the method's failure.
            let mut broken = None;
            let strip = |first: usize| {
                let strip = self.read(first);
                Ok(strip.unwrap_or_else(|failure| {
                    broken = Some(failure);
                    None
                }))
            };
            let found = recover_strips(method, &model.laser_side, options, strip);
            if let Some(failure) = broken {
                return Err(failure);
            }
            let outcome = match found {
                Ok(found) => {
                    let judged = self.judged(&found)?;
                    Ok(measured(model, &found, &judged))
                }
                Err(e) => Err(e),
            };
            attempts.push(Attempt { method, outcome });
        }
        Ok(attempts)
    }

    /// The fit, from all photographs once more; what the best picture could do is not known.
    fn judged(&mut self, found: &Recovered) -> Result<Judged, Failure> {
        let mut residuals = Residuals::default();
        let mut first = 0;
        while let Some(Strip { phi, c, stderr }) = self.read(first)? {
            first += phi.nrows();
            if let Some(stderr) = &stderr {
                let problem = Problem::new(&phi, &c, &self.model.laser_side, None)?;
                residuals.add(&phi, &found.photographs(&problem), stderr, self.certainty);
            }
        }
        Ok(Judged {
            fit: residuals.fit(found.freedom_used(), self.certainty),
            certainty: Some(self.certainty),
            sent_on: self.model.sent_on.clone(),
            ..Judged::default()
        })
    }

    /// The strip that begins at pixel `first`; `None` beyond the last.
    fn read(&mut self, first: usize) -> Result<Option<Strip>, Failure> {
        let phi = self.phi.read(first, self.pixels)?;
        let count = phi.nrows();
        if count == 0 {
            return Ok(None);
        }
        let stderr = match &mut self.errors {
            Errors::Unknown => None,
            Errors::Relative(noise) => Some(phi.map(|x| x.abs() * *noise)),
            Errors::File(rows) => Some(rows.read(first, count)?),
        };
        Ok(Some(Strip {
            c: self.model.camera_side.rows(first, count).into_owned(),
            phi,
            stderr,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 64 GiB of photographs, 64 elements: a strip fits 4 GiB with room to spare, the whole does
    /// not.
    #[test]
    fn photographs_of_sixty_four_gib_fit_four() {
        let size = Size {
            pixels: (1u64 << 20) as f64,
            spots: 8192.0,
            elements: 64.0,
        };
        assert!(size.whole(false, 0) > 64.0 * GIB);
        assert!(size.beside() + MOST_PIXELS * size.pixel() < 4.0 * GIB);
    }
}
