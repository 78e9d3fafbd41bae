//! `phicam expose`: what a camera makes of the clean flux of a finished run; its files are those of
//! [`ExposedFolder`].

use std::fmt::Write as _;

use serde::Serialize;

use crate::cli::Outcome;
use crate::cli::args::{ExposeArgs, StatedBy};
use crate::cli::console::Console;
use crate::cli::exposed_folder::ExposedFolder;
use crate::cli::failure::Failure;
use crate::cli::load_run::{read_matrix, read_run, read_stderr};
use crate::cli::output;
use crate::cli::process::version;
use crate::cli::run_folder::{EXPOSED, PHI, RunFolder, SATURATED, STDERR};
use crate::jobs::need;
use crate::lab::{Errors, describe_exposure};
use crate::matrix::Matrix;
use crate::num::digits::figure;
use crate::report;
use crate::scene::{Glare, Quantity, Scene, SensorModel, SensorSettings, Spread};
use crate::sensor::{
    Exposed, Exposure, Figures, Light, PhotonTransfer, Sensor, Stated, Summary, builtin_summary,
    glare, glare_to_signal,
};
use crate::transport::Estimator;

/// Matrices of Φcam's size that are held at once, beside one for each exposure.
const EXPOSING: f64 = 12.0;

/// What photographs are exposed with.
#[derive(Debug, Serialize)]
struct ExposedWith {
    version: String,
    scene: String,
    scene_hash: String,
    seed: u64,
    sensor: Figures,
    wavelength: f64,
    /// s, the longest first.
    times: Vec<f64>,
    frames: u32,
    dark_frames: u32,
    /// W into each pixel.
    ambient: f64,
    glare_fraction: f64,
    /// Sum of the glare over that of the signal.
    glare_to_signal: f64,
    /// Where the standard deviation comes from.
    stderr: StatedBy,
}

/// exposure.json.
#[derive(Debug, Serialize)]
struct ExposureRecord {
    #[serde(flatten)]
    with: ExposedWith,
    /// What the sensor's calibration found, where it was used.
    photon_transfer: Option<PhotonTransfer>,
    result: Summary,
}

pub(in crate::cli) fn execute(args: &ExposeArgs, console: Console) -> Result<Outcome, Failure> {
    let dir = match &args.dir {
        Some(dir) if !args.list => dir,
        _ => return output::print(&list()).map(|()| Outcome::Done),
    };
    let (scene, record) = read_run(dir, console)?;
    let plan = *record.origin.plan().ok_or_else(|| {
        let cause = format!("{} holds photographs of a real camera", dir.display());
        Failure::new(cause, "give the folder of a rendered run")
    })?;
    if let (Some(name), Some((key, _))) = (&args.sensor, console.define.first()) {
        let cause =
            format!("--sensor replaces all figures of the scene's sensor, -D {key} one of them");
        let cure =
            format!("leave one out, or give -D sensor.model='\"{name}\"' for --sensor {name}");
        return Err(Failure::usage(cause, cure));
    }
    let settings = settings(args, &console.defined(scene.clone())?)?;
    let sensor = Sensor::from_settings(&settings)?;
    need::photographs(
        &scene,
        EXPOSING + settings.brackets.as_ref().map_or(1, Vec::len) as f64,
    )?;
    let exposure = Exposure::from_settings(&settings)?;
    let phi = read_matrix(&dir.join(PHI), &scene)?;
    let scattered = match settings.glare {
        Some(g) => glare(&scene, checked(g)?),
        None => Matrix::zeros(phi.nrows(), phi.ncols()),
    };
    let render_error = read_stderr(&dir.join(STDERR), None, &scene)?;
    let ambient = settings.ambient.unwrap_or(0.0);
    let light = Light::new(&phi, scene.laser.wavelength)?
        .with_glare(&scattered)?
        .with_render_error(&render_error, plan.budget.blocks)?
        .with_ambient(ambient)?;
    if phi.max() <= 0.0 {
        let cause = format!("{} is dark in every pixel", dir.join(PHI).display());
        return Err(Failure::new(
            cause,
            "render a scene whose light reaches the camera",
        ));
    }
    let out = args.output.clone().unwrap_or_else(|| dir.join(EXPOSED));
    let folder = ExposedFolder::at(&out);
    folder.refuse_obstacles()?;
    let lock = |folder| RunFolder::lock(folder, "phicam expose");
    let _run = args.output.is_none().then(|| lock(dir)).transpose()?;
    let with = ExposedWith {
        version: version().to_owned(),
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        seed: args.seed,
        sensor: *sensor.figures(),
        wavelength: scene.laser.wavelength,
        times: exposure.times().to_vec(),
        frames: exposure.frames(),
        dark_frames: exposure.dark_frames(),
        ambient,
        glare_fraction: settings.glare.map_or(0.0, |g| g.fraction),
        glare_to_signal: glare_to_signal(&scattered, &phi),
        stderr: args.stderr,
    };
    if !args.replace {
        folder.refuse_other_settings(&with)?;
    }
    let photon_transfer = match args.stderr {
        StatedBy::Counts => Some(sensor.photon_transfer(args.seed)),
        StatedBy::Oracle => None,
    };
    let stated = photon_transfer.map_or(Stated::Oracle, Stated::Counts);
    let exposed = sensor.expose(&light, &exposure, stated, args.seed)?;
    let result = Summary::new(&sensor, &light, &exposure, &exposed);
    remark(&result, args.strict, console)?;
    remark_dark(&result, &exposed, console);
    remark_render(&result, plan.estimator, console);
    let exposure_record = ExposureRecord {
        with,
        photon_transfer,
        result,
    };
    let json = output::json(&exposure_record)?;
    let _own = args.output.as_deref().map(lock).transpose()?;
    let vouch = || match args.output {
        None => ExposedFolder::vouch(dir),
        Some(_) => Ok(()),
    };
    if folder.finish_replacement()? {
        vouch()?;
    }
    if !args.replace {
        folder.refuse_other(&json)?;
    }
    folder.write(&exposed, (&scene, &record), &sensor, &json)?;
    vouch()?;
    output::print(&if args.json {
        json
    } else {
        report::finding_text(&describe_exposure(
            &exposure_record.result,
            &exposure_record.with.times,
        ))
    })?;
    Ok(Outcome::Done)
}

/// The scene's settings with those of the command line in their place.
fn settings(args: &ExposeArgs, scene: &Scene) -> Result<SensorSettings, Failure> {
    let of_scene = scene.sensor.clone();
    if of_scene.is_none() && args.sensor.is_none() {
        let cause = format!("scene `{}` has no [sensor] table", scene.name);
        return Err(Failure::new(
            cause,
            "add one to scene.toml, or name a built-in sensor with --sensor (see phicam expose --list)",
        ));
    }
    let given = of_scene.unwrap_or_default();
    let base = match &args.sensor {
        None => given,
        Some(name) => SensorSettings {
            model: Some(name.parse().map_err(Failure::Error)?),
            exposure: given.exposure,
            frames: given.frames,
            dark_frames: given.dark_frames,
            brackets: given.brackets,
            ambient: given.ambient,
            glare: given.glare,
            ..SensorSettings::default()
        },
    };
    let spread = base.glare.map_or(Spread::Uniform, |g| g.spread);
    let of_line = |fraction| Glare { fraction, spread };
    let brackets = match (args.brackets.as_slice(), args.exposure) {
        ([], None) => base.brackets,
        ([], Some(_)) => None,
        (times, _) => Some(times.to_vec()),
    };
    Ok(SensorSettings {
        exposure: args.exposure.or(base.exposure),
        frames: args.frames.or(base.frames),
        dark_frames: args.dark_frames.or(base.dark_frames),
        relative_noise: args.noise.or(base.relative_noise),
        ambient: args.ambient.or(base.ambient),
        glare: args.glare.map(of_line).or(base.glare),
        brackets,
        ..base
    })
}

/// A glare whose fraction may come from the command line.
fn checked(glare: Glare) -> Result<Glare, Failure> {
    match Quantity::GlareFraction.refuses(glare.fraction) {
        None => Ok(glare),
        Some(range) => Err(Failure::new(
            format!("--glare {} has no meaning", glare.fraction),
            format!("use {range}"),
        )),
    }
}

/// What is wrong with the photographs.
fn remark(result: &Summary, strict: bool, console: Console) -> Result<(), Failure> {
    let (entries, saturated, floored) = (result.entries, result.saturated, result.floored);
    let near = result.near;
    let cause = format!(
        "{saturated} of {entries} entries are saturated, {floored} cut off below, {near} so near to either that they are off on average"
    );
    let cure = "expose for a shorter time or in --brackets; a larger `offset` keeps counts above 0";
    if saturated + near + floored > 0 {
        if strict {
            return Err(Failure::new(cause, cure));
        }
        console.say(format!("warning: {cause}, see {SATURATED}; {cure}"));
    }
    if result.snr_max.is_some_and(|snr| snr < 1.0) {
        console
            .say("warning: no entry rises above its noise; expose longer or average more frames");
    }
    Ok(())
}

/// What of the frames without laser a recovery has to know.
fn remark_dark(result: &Summary, exposed: &Exposed, console: Console) {
    if result.pedestal > 0.1 * exposed.stderr.mean() {
        console.say(format!(
            "warning: {} W of dark current and ambient light stay in every entry; subtract --dark-frames, \
             or recover with --background",
            figure(result.pedestal, 3)
        ));
    }
    if Errors::of_common(result.common, exposed.flux.ncols()) != Errors::Independent {
        console.say(format!(
            "warning: {:.2} % of the variance is that of the dark frames, which all spots of a pixel share, and recover takes entries as independent; \
             take more --dark-frames, or recover with --background",
            100.0 * result.common
        ));
    }
}

/// What of the render's own error a recovery has to know. Where entries share it, it adds up over
/// them.
fn remark_render(result: &Summary, estimator: Estimator, console: Console) {
    let shared = Errors::of(estimator).shared();
    if result.render <= shared.map_or(0.1, |_| 1e-3) {
        return;
    }
    let words = shared.map_or(String::new(), |which| {
        format!(
            "; {which}, so that it does not average out, and recover takes entries as independent: its errors come out too small"
        )
    });
    console.say(format!(
        "warning: {:.2} % of the variance is that of the render itself{words}; render with more --samples{}",
        100.0 * result.render,
        if shared.is_some() { ", or by --estimator independent" } else { "" }
    ));
}

fn list() -> String {
    SensorModel::ALL.iter().fold(String::new(), |mut text, m| {
        let f = *Sensor::builtin(*m).figures();
        let _ = writeln!(text, "{:<15} {}", m.name(), builtin_summary(*m));
        let bits = f.bits.map_or("no converter".to_owned(), |b| format!("{b} bits"));
        let _ = writeln!(
            text,
            "{:<15} QE {}, {} e-/s dark, full well {} e-, read noise {:.1} e-, {} e- per count, {bits}",
            "", f.quantum_efficiency, f.dark_current, f.full_well, f.read_noise, f.gain
        );
        text
    })
}
