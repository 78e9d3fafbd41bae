//! Columns of Φcam, block by block, by any of the estimators.

use std::ops::{ControlFlow, Range};

use rayon::prelude::*;

use super::context::Context;
use super::factored::Factored;
use super::plan::{Estimator, Plan, RenderError, Traced};
use super::points::PixelPoints;
use super::shared::PixelRow;
use super::tally::{Moments, Tally};
use super::{independent, shared};
use crate::num::control::{Control, Stopped};

use crate::num::tree::Tree;
use crate::scene::{Scene, Surface};

/// Paths, or points, that a block really has: more than `plan` asks for where the surfaces between
/// the walls are divided into texture cells, each of which gets its share rounded up.
pub fn block_size(scene: &Scene, plan: &Plan) -> usize {
    let context = Context::new(scene, plan, 0..1);
    let by_points = || (0..scene.camera.pixels()).any(|p| PixelPoints::fits(&context, p));
    if plan.estimator == Estimator::Factored || by_points() {
        return context.strata.block_size();
    }
    plan.budget.size as usize
}

/// The surface for which `plan` has no estimator, by name: where light may meet more than three
/// surfaces [`Estimator::Factored`] needs all of them between the first and the last wall to be
/// Lambertian, for its paths go on from points that are the same for all pixels.
pub fn unsupported_surface<'a>(scene: &'a Scene, plan: &Plan) -> Option<&'a str> {
    let all_matt = || scene.surfaces.iter().all(Surface::is_lambertian);
    if plan.estimator != Estimator::Factored || scene.max_bounces <= 3 || all_matt() {
        return None;
    }
    Context::new(scene, plan, 0..1).unfactored()
}

/// Version of the bits that a plan leads to: raised whenever a change of the tracer, of the random
/// streams or of the order of sums changes any of them. What was traced under different versions is
/// never added.
pub const NUMERICS: u32 = 4;

/// Traces the columns `spots` of Φcam. The same plan gives the same bits for every number of
/// threads and every range that a spot is part of.
///
/// # Errors
/// [`RenderError`] if it was stopped, if the scene does not have these spots, or if there is an
/// [`unsupported_surface`].
pub fn render(
    scene: &Scene,
    plan: &Plan,
    spots: Range<usize>,
    control: Control<'_>,
) -> Result<Traced, RenderError> {
    let tally = Tally::new(scene, plan, spots.len(), 0);
    if spots.is_empty() {
        return Ok(tally.zeros());
    }
    let go_on = &mut |_: &Tally| ControlFlow::Continue(u32::MAX);
    trace(
        scene,
        plan,
        spots.clone(),
        tally,
        plan.budget.blocks,
        control,
        go_on,
    )?
    .traced(scene, spots)
    .ok_or(RenderError::Stopped(Stopped))
}

/// Traces the columns `spots` from where `tally` ends up to block `end` (exclusive).
///
/// After the first few blocks (one, if they are long) `after` sees the tally; it ends the work, or
/// says how many blocks to trace before it looks again. Under [`Estimator::Factored`] it sees every
/// block. The tally returned is shorter than asked for if `after` ended the work or `control`
/// stopped it; it is whole in any case, and tracing can go on from it.
///
/// # Errors
/// [`RenderError`] if the scene does not have these spots, if `tally` is not of these columns, or
/// if there is an [`unsupported_surface`].
pub fn trace(
    scene: &Scene,
    plan: &Plan,
    spots: Range<usize>,
    tally: Tally,
    end: u32,
    control: Control<'_>,
    after: &mut dyn FnMut(&Tally) -> ControlFlow<(), u32>,
) -> Result<Tally, RenderError> {
    let count = scene.laser.spots.len();
    if spots.end > count {
        return Err(RenderError::NoSuchSpots {
            range: spots,
            count,
        });
    }
    if !tally.is_of(scene, plan, spots.len()) {
        return Err(RenderError::ForeignTally);
    }
    if spots.is_empty() || tally.range().end >= end {
        return Ok(tally);
    }
    let context = Context::new(scene, plan, spots);
    if plan.estimator == Estimator::Factored {
        if let Some(surface) = context.unfactored() {
            let surface = surface.to_owned();
            return Err(RenderError::UnsupportedSurface { surface });
        }
        return Ok(Factored::new(&context).trace(tally, end, control, after));
    }
    Ok(trace_rows(&context, tally, end, control, after))
}

/// Paths that are traced before the first look at what is there.
const FIRST_LOOK: u64 = 1 << 18;

/// Every pixel by itself, a few blocks at a time.
fn trace_rows(
    context: &Context<'_>,
    mut tally: Tally,
    end: u32,
    control: Control<'_>,
    after: &mut dyn FnMut(&Tally) -> ControlFlow<(), u32>,
) -> Tally {
    let (plan, pixels) = (&context.plan, context.views.len());
    let sets = if plan.estimator.serves_all_spots() {
        1
    } else {
        context.spots.range.len() as u64
    };
    let paths = u64::from(plan.budget.size) * sets;
    let all = paths.saturating_mul(pixels as u64).max(1);
    let mut together = u32::try_from(FIRST_LOOK / all).unwrap_or(u32::MAX).max(1);
    while tally.range().end < end {
        let first = tally.range().end;
        let blocks = first..end.min(first.saturating_add(together));
        let row = |pixel| {
            if control.stopped() {
                return None;
            }
            let row = trace_row(context, pixel, blocks.clone());
            (control.progress)(paths * u64::from(blocks.end - blocks.start));
            Some(row)
        };
        let rows: Option<Vec<Tree<Moments>>> = (0..pixels).into_par_iter().map(row).collect();
        let Some(rows) = rows else { break };
        tally.add_rows(&rows).expect("blocks follow one another");
        match after(&tally) {
            ControlFlow::Break(()) => break,
            ControlFlow::Continue(blocks) => together = blocks.max(1),
        }
    }
    tally
}

/// One pixel: sums and spread of the estimates of some blocks.
fn trace_row(context: &Context<'_>, pixel: usize, blocks: Range<u32>) -> Tree<Moments> {
    let block_of = match context.plan.estimator {
        Estimator::Independent => independent::block,
        Estimator::Shared | Estimator::Factored => shared::block,
    };
    let mut row = PixelRow::new(context, pixel);
    let mut tree = Tree::new(context.plan.budget.blocks, blocks.start);
    for block in blocks {
        let sums = block_of(&mut row, block);
        let moments = Moments::of_block(sums, context.scene.max_bounces as usize);
        tree.push(block..block + 1, moments, Moments::join)
            .expect("blocks follow one another");
    }
    tree
}
