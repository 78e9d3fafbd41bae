//! Where should the laser spots be?
//!
//! Photographs φ_s = C diag(d_s) ρ of spots s, at noise Σ_s, leave of a picture ρ ~ N(½, K) a share
//!
//! > risk(w) = tr (K⁻¹ + Σ_s w_s H_s)⁻¹/tr K,   H_s = diag(d_s) Cᵀ Σ_s⁻¹ C diag(d_s),   w_s = 0, 1,
//!
//! of its variance (Bayesian A-optimality, Chaloner and Verdinelli 1995). N of many candidates on
//! the wall are to make it least. With weights between 0 and 1 that is convex: its minimum is
//! found, and a bound for every layout with it ([`relaxed`](relaxed::relaxed)). A layout comes of
//! the weights by rounding and exchanges ([`exchange`]), then its spots move off the grid
//! ([`refine`]). The noise Σ_s is that of a grey surface.
//!
//! For scale: with 32 × 32 pixels, relative noise of 1e-6 and a smooth prior of deviation 0.22 and
//! length 1.25 in. the staggered squares of 100 spots leave 0.102 (3 in.) and 0.068 (6 in.) of the
//! variance of 8 × 8 elements.

mod design;
mod exchange;
mod found;
mod photographs;
mod places;
mod plan;
mod prior;
mod refine;
mod relaxed;
mod search;
mod tasks;
#[cfg(test)]
mod tests;
mod unsure;

use super::registered::{Registered, prepared};
use crate::lab::options::{Opt, OptionError};
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::num::named::Named;
use plan::Plan;
use prior::{PRIORS, Prior};
use tasks::LayoutTasks;
use unsure::Unsure;

/// What a number above 0 must be.
const fn positive(name: &'static str, help: &'static str) -> Opt {
    Opt::number(name, help).rule(
        |x| x > 0.0 && x.is_finite(),
        "is not above 0",
        "use a number above 0",
    )
}

/// What a length of 0 or more must be.
const fn distance(name: &'static str, help: &'static str) -> Opt {
    Opt::number(name, help).rule(
        |x| x >= 0.0 && x.is_finite(),
        "is no distance",
        "use 0 or a length in the scene's unit",
    )
}

/// Views that rows are made of.
const VIEWS: &[(&str, &str)] = &[
    ("own", "The camera's own view alone"),
    (
        "wall",
        "Also a row of the same spots with the whole wall in view, on as many pixels",
    ),
];

/// `phicam study layout`.
pub(super) const STUDY: Registered = Registered {
    name: "layout",
    about: "Where the laser spots should be, how much that gains, and how good any layout can be: table, JSON, CSV, drawing, scene",
    scene: Some("thesis"),
    files: "layout.csv, places.csv, candidates.csv, layout.svg, layout.toml",
    options: &[
        Opt::whole("count", "Spots; as many as the scene has unless given").within(1, 10_000),
        Opt::whole(
            "candidates",
            "Candidates along the longer side of the wall, on a square grid",
        )
        .within(2, 400)
        .or("40"),
        Opt::choice(
            "noise",
            "How the noise goes with the light",
            NoiseLaw::NAMES,
        )
        .or("relative"),
        Opt::number(
            "level",
            "Noise for which the spots are placed, relative to the light",
        )
        .or("1e-6")
        .rule(
            |x| (1e-9..=1.0).contains(&x),
            "is not a noise level",
            "use a number from 1e-9, below which rounding tells, to 1",
        ),
        Opt::choice("prior", "What is known of the picture beforehand", PRIORS).or("smooth"),
        positive(
            "length",
            "Length of the smooth prior, in the scene's unit; a quarter of the hidden surface's diagonal unless given",
        ),
        positive("deviation", "Standard deviation of the prior, about ½").or("0.5"),
        distance(
            "margin",
            "Least distance of spots from the camera's view; a tenth of its longer side unless given",
        ),
        distance("apart", "Least distance of two spots").or("0"),
        Opt::whole(
            "refine",
            "Rounds of small moves off the grid, each of half the step",
        )
        .or("3")
        .within(0, 20),
        distance("wall", "By how much the wall reaches further on all sides").or("0"),
        Opt::choice("view", "Views that are compared", VIEWS).or("wall"),
        Opt::whole("pixels", "Pixels a side, in place of the camera's").within(1, 1024),
        Opt::whole("elements", "Elements a side, in place of the scene's").within(1, 64),
        Opt::whole(
            "boards",
            "Checks a side of the boards that are recovered, separated by commas",
        )
        .list()
        .within(2, 64)
        .or("2,4,8"),
        Opt::whole("draws", "Draws of the noise at each level")
            .within(1, 1000)
            .or("20"),
        distance(
            "hinge",
            "Standard deviation of the hinge's angle, degrees, as an unknown beside the picture",
        )
        .or("0"),
        distance(
            "offset",
            "The same of the hidden surface along its normal, a length",
        )
        .or("0"),
        distance(
            "aim",
            "The same of all spots together along x and along y, a length",
        )
        .or("0"),
        Opt::seed("Seed of the first draw"),
    ],
    prepare: |scene, values| {
        let mut scene = scene.clone();
        if scene.laser.is_shining() {
            let cause = "the scene has no laser: its hidden surface shines";
            return Err(OptionError::new(cause, "use a scene with a [laser] table").into());
        }
        let wall: f64 = values.one("wall")?;
        if wall > 0.0 {
            scene = scene.with_extended_relay(wall)?;
        }
        if let Some(pixels) = values.maybe("pixels")? {
            (scene.camera.columns, scene.camera.rows) = (pixels, pixels);
        }
        let view = &scene.camera.view;
        let margin = 0.1 * view.u().length().max(view.v().length());
        let diagonal = scene.hidden().next().map(|(_, s)| {
            let [from, to] = [[0.0; 2], [1.0; 2]].map(|uv| s.shape.at(uv).position);
            (to - from).length()
        });
        let prior: String = values.one("prior")?;
        if prior != "smooth" {
            values.refuse_idle(&["length"], "only --prior smooth has one")?;
        }
        let length = values.maybe("length")?.or(diagonal.map(|d| 0.25 * d));
        let mut unsure = Vec::new();
        for name in ["hinge", "offset", "aim"] {
            let deviation: f64 = values.one(name)?;
            if deviation > 0.0 {
                unsure.extend(Unsure::of(name, deviation));
            }
        }
        let view: String = values.one("view")?;
        let plan = Plan {
            count: values.maybe("count")?.unwrap_or(scene.laser.spots.len()),
            candidates: values.one("candidates")?,
            noise: values.one("noise")?,
            level: values.one("level")?,
            prior: Prior {
                deviation: values.one("deviation")?,
                length: length.filter(|_| prior == "smooth"),
            },
            margin: values.maybe("margin")?.unwrap_or(margin),
            apart: values.one("apart")?,
            refine: values.one("refine")?,
            boards: values.sides("boards")?,
            draws: values.one("draws")?,
            elements: values.maybe("elements")?,
            seed: values.one("seed")?,
            unsure,
            wall_in_view: view == "wall",
        };
        Ok(prepared(LayoutTasks::new(&scene, plan)?))
    },
};
