//! What may be set in the study.

use super::axis::NoiseAxis;
use super::named_sensor::NamedSensor;
use super::plan::NoisePlan;
use super::tasks::NoiseTasks;
use crate::lab::comparison::validation::Integration;
use crate::lab::error::StudyError;
use crate::lab::options::{Opt, OptionError, Values};
use crate::lab::studies::registered::{Registered, prepared};
use crate::model::Kernel;
use crate::scene::{Scene, Spread};

/// `phicam study noise`.
pub(in crate::lab) const STUDY: Registered = Registered {
    name: "noise",
    about: "How much noise each recovery bears: table, JSON, CSV, figures; a rerun continues \
         where the last one stopped",
    scene: Some("bench"),
    files: "noise.csv (every trial), noise-curves.csv, the figures, noise.phs (a rerun continues from it)",
    options: &[
        Opt::whole(
            "boards",
            "Checks a side of the boards, separated by commas; the scene's own picture is studied beside them if it is no board",
        )
            .or("2,4,8")
            .list()
            .within(2, 1024),
        Opt::whole(
            "elements",
            "Elements a side, separated by commas; with each board those that it divides",
        )
        .or("2,4,8")
        .list()
        .within(1, 1024),
        Opt::methods(
            "Methods, separated by commas",
            "pinv,tsvd,tikhonov,joint-unbounded,joint",
        ),
        Opt::choice(
            "kernel",
            "Kernel of both the photographs and the inversion",
            &[
                ("physical", "The true cosine at the hidden surface"),
                ("published", "The one in the published simulation"),
            ],
        )
        .or("physical"),
        Opt::choice(
            "integration",
            "How both integrate",
            &[
                ("centres", "Elements, pixels and spots at their centres"),
                (
                    "quadrature",
                    "Over elements, footprints and spots, as recover does; of more than 1024 elements and of the published kernel at their centres",
                ),
            ],
        )
        .or("centres"),
        Opt::choice(
            "axis",
            "What is varied",
            &[
                ("relative", "Noise relative to each entry"),
                ("photons", "Photons per pixel and frame: shot noise alone"),
                (
                    "exposure",
                    "Seconds that a sensor's frame takes; one dark frame is subtracted",
                ),
                (
                    "glare",
                    "Glare over signal, photographed by a sensor and left in",
                ),
                ("bits", "Bits of a converter, nothing else being noisy"),
                (
                    "scale",
                    "Relative error of the absolute scale, told to joint methods; entries have 0.001 of noise beside",
                ),
            ],
        )
        .or("relative"),
        Opt {
            alias: Some("levels"),
            ..Opt::number(
                "noise",
                "Levels on the axis, separated by commas; unless given relative noise 1e-12 to 1 and 1 to 1e20 photons by decades, \
                 exposures over six decades up to what the sensor bears, glare 1e-4 to 100 times the signal by half decades, \
                 4 to 24 bits, errors of the scale 1e-3 to 0.3 by half decades",
            )
            .list()
        },
        Opt::text(
            "sensor",
            "Built-in sensor (ideal, ccd, dslr, machine-vision) of the axes exposure and glare; that of the scene's [sensor] table \
             unless given, or ccd if it has none",
        ),
        Opt::falloff(
            "Distance, in the scene's unit, at which glare has halved, on the axis glare; spread evenly unless given",
        ),
        Opt::whole("seeds", "Draws of the noise at each level")
            .or("20")
            .within(1, 100_000),
        Opt::seed("First seed"),
        Opt::paths(
            "render-samples",
            "Measure the noise of renders with these numbers of paths, separated by commas, and mark it on the axis",
        )
        .list(),
    ],
    prepare: |scene, values| Ok(prepared(NoiseTasks::given(scene, values)?)),
};

impl NoiseTasks {
    /// The study of a scene with these values of the options of the noise study.
    ///
    /// # Errors
    /// [`OptionError`] and [`LabError`](crate::lab::LabError).
    pub fn given(scene: &Scene, values: &Values) -> Result<Self, StudyError> {
        let axis = axis(values, scene)?;
        let levels: Vec<f64> = values.list("noise")?;
        let refused = |level: &f64| Some((*level, axis.refuses(*level)?));
        if let Some((level, cure)) = levels.iter().find_map(refused) {
            let cause = format!("--noise {level} has no meaning on the axis {}", axis.name());
            return Err(OptionError::new(cause, cure).into());
        }
        let renders: Vec<u64> = values.list("render-samples")?;
        if !renders.is_empty() && axis.of_relative(1.0).is_none() {
            let cause = format!(
                "the noise of renders has no place on the axis {}",
                axis.name()
            );
            let cure = "use --axis relative or photons, or leave out --render-samples";
            return Err(OptionError::new(cause, cure).into());
        }
        let mut plan = NoisePlan {
            boards: values.sides("boards")?,
            elements: values.sides("elements")?,
            methods: values.methods()?,
            kernel: match values.one::<String>("kernel")?.as_str() {
                "published" => Kernel::Published,
                _ => Kernel::Physical,
            },
            integration: match values.one::<String>("integration")?.as_str() {
                "centres" => Integration::Centres,
                _ => Integration::Quadrature,
            },
            axis,
            levels,
            seeds: values.one("seeds")?,
            first_seed: values.one("seed")?,
        };
        if plan.levels.is_empty() {
            plan.levels = plan.default_levels(scene)?;
        }
        plan.levels.sort_by(|a, b| plan.axis.quiet_first(*a, *b));
        plan.levels.dedup();
        Ok(Self::new(scene, plan, renders))
    }
}

/// The axis, with its sensor where it has one.
fn axis(values: &Values, scene: &Scene) -> Result<NoiseAxis, StudyError> {
    let (sensor, falloff) = (values.maybe("sensor")?, values.maybe("falloff")?);
    let name: String = values.one("axis")?;
    let unused = [
        (
            "--falloff",
            falloff.is_some() && name != "glare",
            "--axis glare",
        ),
        (
            "--sensor",
            sensor.is_some() && !["exposure", "glare"].contains(&name.as_str()),
            "--axis exposure or glare",
        ),
    ];
    if let Some((option, _, axes)) = unused.iter().find(|(_, unused, _)| *unused) {
        let cause = format!("{option} has no meaning on this axis");
        return Err(OptionError::new(cause, format!("leave it out, or use {axes}")).into());
    }
    Ok(match name.as_str() {
        "photons" => NoiseAxis::Photons,
        "bits" => NoiseAxis::Bits,
        "scale" => NoiseAxis::Scale,
        "exposure" => NoiseAxis::Exposure(NamedSensor::studied(sensor, scene)?),
        "glare" => {
            let spread = falloff.map_or(Spread::Uniform, Spread::Falloff);
            NoiseAxis::Glare(NamedSensor::studied(sensor, scene)?, spread)
        }
        _ => NoiseAxis::Relative,
    })
}
