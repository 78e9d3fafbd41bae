//! A viewpoint that shows much of a scene.

use super::model::Model;
use super::viewpoint::{Lens, PreviewError, Viewpoint};
use crate::geometry::{Basis, DVec3};
use crate::scene::{Role, Scene, Surface};

/// Surfaces more than so many times as long as what the light is about need not be in the picture
/// whole.
const HUGE: f64 = 3.0;
/// Part of the picture that the scene fills.
const FILLED: f64 = 0.92;
/// Places that are tried: heights, and ways around, degrees.
const HEIGHTS: [i32; 7] = [-50, -30, -10, 10, 25, 40, 55];
const AROUND: i32 = 15;
/// Rays of a trial.
const GRID: [usize; 2] = [45, 30];
/// What the back of a hidden surface is worth, its front 1; and a place below the scene, above 1.
const BACK: f64 = 0.01;
const BELOW: f64 = 0.9;
/// Degrees between the left and the right edge, unless asked for.
const FIELD: f64 = 40.0;

/// What is given of the viewpoint; the rest is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewOptions {
    /// The viewer's eye.
    pub from: Option<DVec3>,
    /// What is in the middle.
    pub to: Option<DVec3>,
    /// What is up; +y unless given.
    pub up: Option<DVec3>,
    /// Angle between the left and the right edge, degrees; 40 unless given.
    pub field: Option<f64>,
}

/// The viewpoint of `options`. Without a place in them it is chosen so that much is seen of the
/// fronts of hidden and of relay surfaces: of 168 directions the one with the largest √(H·R), H and
/// R the parts of the picture that they take (a hidden surface's back counts a hundredth), as near
/// as leaves all surfaces in the picture but those more than three times as long as hidden
/// surfaces, spots and view together.
///
/// # Errors
/// [`PreviewError`] for options that give no picture.
pub fn auto_viewpoint(
    scene: &Scene,
    size: [usize; 2],
    options: &ViewOptions,
) -> Result<Viewpoint, PreviewError> {
    let corners = corners(scene);
    let (low, high) = bounds(&corners);
    let middle = 0.5 * (low + high);
    let up = options.up.unwrap_or(DVec3::Y);
    let field = options.field.unwrap_or(FIELD);
    let whole = |from: DVec3, to: DVec3| Viewpoint {
        from,
        to,
        up,
        field,
    };
    if let Some(from) = options.from {
        let viewpoint = whole(from, options.to.unwrap_or(middle));
        Lens::new(&viewpoint, size)?;
        return Ok(viewpoint);
    }
    let reach = (high - low).length().max(f64::MIN_POSITIVE);
    let first = whole(
        middle + reach * Basis::around(up.normalize_or(DVec3::Y)).s,
        middle,
    );
    Lens::new(&first, size)?;
    let model = Model::new(scene);
    let upright = Basis::around(up.normalize());
    let mut best = (f64::NEG_INFINITY, first);
    for height in HEIGHTS {
        for turn in (0..360).step_by(AROUND as usize) {
            let [h, a] = [height, turn].map(|d| f64::from(d).to_radians());
            let (level, raised) = (libm::cos(h), libm::sin(h));
            let away = upright.to_world([level * libm::cos(a), level * libm::sin(a), raised]);
            let to = options.to.unwrap_or(middle);
            let start = whole(to + reach * away, to);
            let viewpoint = fitted(start, size, &corners, options.to)?;
            let worth = worth(&model, &viewpoint, size)? * if height < 0 { BELOW } else { 1.0 };
            if worth > best.0 {
                best = (worth, viewpoint);
            }
        }
    }
    Ok(best.1)
}

/// Corners of boxes around what should be in the picture.
fn corners(scene: &Scene) -> Vec<DVec3> {
    let of = |s: &Surface| s.shape.box_corners();
    let hidden = scene.hidden().flat_map(|(_, s)| of(s));
    let spots = scene.laser.spots.iter().map(|s| s.target.position);
    let core: Vec<DVec3> = hidden
        .chain(spots)
        .chain(scene.camera.view.corners())
        .collect();
    let length = |points: &[DVec3]| {
        let (low, high) = bounds(points);
        (high - low).length()
    };
    let most = HUGE * length(&core);
    let others = scene.surfaces.iter().map(of);
    let others = others.filter(|c| length(c) <= most).flatten();
    core.iter().copied().chain(others).collect()
}

fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points.iter().fold(none, |(l, h), p| (l.min(*p), h.max(*p)))
}

/// The viewpoint moved along and (unless `to` is given) across its line of sight until `corners`
/// just fill the picture.
fn fitted(
    start: Viewpoint,
    size: [usize; 2],
    corners: &[DVec3],
    to: Option<DVec3>,
) -> Result<Viewpoint, PreviewError> {
    let mut viewpoint = start;
    let half = size.map(|n| 0.5 * n as f64);
    let tangent = libm::tan(0.5 * start.field.to_radians());
    for _ in 0..12 {
        let lens = Lens::new(&viewpoint, size)?;
        let [right, up, ahead] = lens.axes();
        let distance = (viewpoint.to - viewpoint.from).length();
        // How far back the eye must go so that each corner is inside, were the picture centred
        // where it is.
        let mut edges = [
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        let mut needed = f64::NEG_INFINITY;
        for corner in corners {
            let way = *corner - viewpoint.to;
            let [x, y] = [way.dot(right), way.dot(up)];
            let limit = [tangent, tangent * half[1] / half[0]].map(|t| FILLED * t);
            needed = needed.max((x.abs() / limit[0]).max(y.abs() / limit[1]) - way.dot(ahead));
            let depth = (way.dot(ahead) + distance).max(1e-3 * distance);
            edges = [
                edges[0].min(x / depth),
                edges[1].max(x / depth),
                edges[2].min(y / depth),
                edges[3].max(y / depth),
            ];
        }
        let shift = match to {
            Some(_) => DVec3::ZERO,
            None => 0.5 * distance * (right * (edges[0] + edges[1]) + up * (edges[2] + edges[3])),
        };
        viewpoint.to += shift;
        viewpoint.from = viewpoint.to - ahead * needed.max(1e-3 * distance);
    }
    Ok(viewpoint)
}

/// How much is seen of what matters.
fn worth(model: &Model<'_>, viewpoint: &Viewpoint, size: [usize; 2]) -> Result<f64, PreviewError> {
    let lens = Lens::new(viewpoint, size)?;
    let (mut hidden, mut relay) = (0.0, 0.0);
    let cell = [0, 1].map(|k| size[k] as f64 / GRID[k] as f64);
    for (i, j) in (0..GRID[0]).flat_map(|i| (0..GRID[1]).map(move |j| (i, j))) {
        let at = [(i as f64 + 0.5) * cell[0], (j as f64 + 0.5) * cell[1]];
        let Some(seen) = model.look(&lens.ray(at)) else {
            continue;
        };
        match (model.surface(seen.shape).role, seen.is_front) {
            (Role::Hidden, true) => hidden += 1.0,
            (Role::Hidden, false) => hidden += BACK,
            (Role::Relay, true) => relay += 1.0,
            _ => {}
        }
    }
    Ok(match model.scene.hidden().next() {
        Some(_) => (hidden * relay).sqrt(),
        None => relay,
    })
}
