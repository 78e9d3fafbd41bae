//! What does an occluder between object and wall do for the picture, and where should it stand?
//!
//! Past an edge c_p(x), what pixel p sees of the point x, jumps where x comes into its sight. The
//! singular values of the operator Φ\[p,l\] = Σ_j ρ_j A_j\[p,l\] then fall no longer like those of
//! a smooth kernel. Of each occluder the place and the size are searched for which the photographs
//! leave least of the variance of the reflectances,
//!
//! > R = (1/n) Σ_j var(ρ_j | Φ)/τ² = 1 − (1/n) Σ_j R_jj,
//!
//! the Bayes risk of a Gaussian prior about ½ with a standard deviation τ of ½
//! ([`determined`](determined())). Then boards are recovered from draws of the noise.

mod found;
mod kinds;
mod photographed;
mod search;
mod tasks;

use super::registered::{Registered, prepared};
use crate::lab::options::{Opt, OptionError, Values};
use crate::lab::studies::subject::{PICTURES, Subject};
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::num::named::Named;
use crate::scene::SensorModel;
use kinds::{Kind, Place};
use photographed::Camera;
use tasks::{OccluderTasks, Plan};

/// `phicam study occluder`.
pub(super) const STUDY: Registered = Registered {
    name: "occluder",
    about: "What an occluder between object and wall does for the picture, and its best place: table, JSON, CSV, figure",
    scene: Some("thesis"),
    files: "occluder.csv, traced.csv, misplaced.csv, occluder.svg",
    options: &[
        Opt::choice("kinds", "Occluders, separated by commas", Kind::NAMES)
            .list()
            .or("none,plate,disc,rod,pinhole,slit,random,mura"),
        Opt::whole("spots", "Numbers of spots, separated by commas, evenly among those of the scene; all unless given")
            .list()
            .within(1, 1_000_000),
        Opt::choice("noise", "How the noise goes with the light", NoiseLaw::NAMES).or("relative"),
        Opt::number("level", "Noise for which the place is searched, relative to the light")
            .or("0.01")
            .rule(
                |x| x > 0.0 && x <= 1.0,
                "is not a noise level",
                "use a number above 0, up to 1",
            ),
        Opt::number("size", "Size with which the search begins, in the scene's unit")
            .or("1")
            .rule(|x| x > 0.0 && x.is_finite(), "is not a size", "use a length above 0"),
        Opt::number("height", "Share of the way from the view to the object with which it begins")
            .or("0.36")
            .rule(
                |x| x > 0.0 && x < 1.0,
                "is not between view and object",
                "use a number between 0 and 1",
            ),
        Opt::whole("search", "Places and sizes that are tried; 0 stays where it begins").or("24"),
        Opt::whole("boards", "Checks a side of the boards that are recovered, separated by commas")
            .list()
            .within(2, 64)
            .or("2,4,8,16"),
        Opt::choice("pictures", "Pictures that are recovered besides, separated by commas", PICTURES).list(),
        Opt::whole("cells", "Cells a side of the random mask").or("6").within(2, 64),
        Opt::whole("draws", "Draws of the noise at each level").within(1, 1000).or("3"),
        Opt::number("misplaced", "Distances along the view by which the model is wrong, separated by commas")
            .list()
            .or("0.01,0.03,0.1"),
        Opt::whole("elements", "Elements a side, in place of the scene's; finer boards have as many as checks")
            .within(1, 64),
        Opt::whole("samples", "Points of the light that is traced for photographs through the sensor; 0 traces none")
            .or("65536")
            .within(0, 1 << 32),
        Opt::text("sensor", "Built-in sensor (ideal, ccd, dslr, machine-vision)").or("machine-vision"),
        Opt::number("exposure", "Seconds that a frame takes, or half of what saturates its brightest pixel, if that is less")
            .or("0.1")
            .rule(|x| x > 0.0 && x.is_finite(), "is no exposure", "use a time above 0"),
        Opt::whole("frames", "Most frames of a spot that are averaged").or("16").within(1, 65_536),
        Opt::seed("Seed of the first draw"),
    ],
    prepare: |scene, values| {
        let kinds: Vec<String> = values.list("kinds")?;
        refuse_idle(values, &kinds)?;
        let spots: Vec<usize> = values.list("spots")?;
        let all = scene.laser.spots.len();
        if let Some(more) = spots.iter().find(|n| **n > all) {
            let cause = format!("--spots {more}: the scene has {all}");
            return Err(OptionError::new(cause, format!("use at most {all}")).into());
        }
        let boards: Vec<usize> = values.list("boards")?;
        let pictures: Vec<Subject> = values.list("pictures")?;
        let subjects = boards.into_iter().map(Subject::Board).chain(pictures);
        let (seed, sensor): (u64, SensorModel) = (values.one("seed")?, values.one("sensor")?);
        let plan = Plan {
            kinds: kinds.iter().filter_map(|name| Kind::by_name(name)).collect(),
            spots,
            noise: values.one("noise")?,
            level: values.one("level")?,
            start: Place {
                height: values.one("height")?,
                offset: [0.0; 2],
                size: values.one("size")?,
            },
            search: values.one("search")?,
            subjects: subjects.collect(),
            mask: kinds::random(values.one("cells")?, seed),
            camera: Camera {
                sensor,
                exposure: values.one("exposure")?,
                frames: values.one("frames")?,
                samples: values.one("samples")?,
                seed,
            },
            draws: values.one("draws")?,
            misplaced: values.list("misplaced")?,
            elements: values.maybe("elements")?,
            seed,
        };
        Ok(prepared(OccluderTasks::new(scene, plan)?))
    },
};

/// Refuses what changes nothing of these `kinds`.
fn refuse_idle(values: &Values, kinds: &[String]) -> Result<(), OptionError> {
    if values.one::<u64>("samples")? == 0 {
        let why = "--samples 0 takes no photographs through a sensor";
        values.refuse_idle(&["sensor", "exposure", "frames"], why)?;
    }
    if !kinds.iter().any(|kind| kind == Kind::Random.name()) {
        let why = "there is no random mask among --kinds";
        values.refuse_idle(&["cells"], why)?;
    }
    if kinds.iter().all(|kind| kind == Kind::None.name()) {
        let why = "there is no occluder among --kinds";
        values.refuse_idle(&["size", "height", "search", "misplaced"], why)?;
    }
    Ok(())
}
