//! A picture of a scene from a viewpoint.

use rayon::prelude::*;

use super::light::{Colour, Light};
use super::model::Model;
use super::overlay::Overlay;
use super::viewpoint::{Lens, PreviewError, Viewpoint};
use crate::num::stream::LARGEST_NET;
use crate::scene::Scene;
use crate::transport::Control;

/// How a preview is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreviewPlan {
    /// Where the viewer stands.
    pub viewpoint: Viewpoint,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Rays through each pixel, 1 to 2¹⁶.
    pub samples: u32,
    /// Whether spots, view, beams and devices are drawn into the picture.
    pub overlay: bool,
}

/// A picture for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Row by row from the top, not yet clipped at 1.
    pub colours: Vec<Colour>,
}

/// Renders a preview of `scene`; a pure function of its arguments. Progress counts rays through
/// pixels.
///
/// # Errors
/// [`PreviewError`] for a viewpoint without a picture, a picture without pixels, or if stopped.
pub fn preview(
    scene: &Scene,
    plan: &PreviewPlan,
    control: Control<'_>,
) -> Result<Preview, PreviewError> {
    let lens = Lens::new(&plan.viewpoint, plan.size)?;
    let samples = plan.samples.clamp(1, LARGEST_NET);
    let overlay = if plan.overlay {
        Overlay::of(scene, &lens)
    } else {
        Overlay::default()
    };
    let model = Model::new(scene);
    let light = Light::beside(&lens);
    let [width, height] = plan.size;
    let row = |y: usize| {
        control.check()?;
        let near = overlay.of_row(y);
        let pixel = |x: usize| model.pixel(&lens, &light, &near, [x, y], samples);
        let colours: Vec<Colour> = (0..width).map(pixel).collect();
        (control.progress)(u64::from(samples) * width as u64);
        Ok(colours)
    };
    let rows: Result<Vec<Vec<Colour>>, PreviewError> =
        (0..height).into_par_iter().map(row).collect();
    Ok(Preview {
        size: plan.size,
        colours: rows?.concat(),
    })
}
