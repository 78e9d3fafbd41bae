//! `phicam expose`: what a camera makes of the clean flux of a finished run.
//!
//! | file | content |
//! | --- | --- |
//! | phi.npy, phi.stderr.npy | linearised flux and its standard deviation, pixels × spots, W |
//! | saturated.npy | 1 where an entry is saturated in every exposure, 0.5 where it is only near that, −1 where the converter cut it off below, else 0 |
//! | counts/spot-NNNN.exr, .png | mean counts, a channel for each exposure time; the longest as 16-bit grey |
//! | exposure.json | sensor, exposure, what came of it |

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::Outcome;
use super::args::{ExposeArgs, StatedBy};
use super::cleanup::remove_abandoned;
use super::console::Console;
use super::failure::Failure;
use super::load_run::{read_matrix, read_run, read_stderr};
use super::need;
use super::output;
use super::process::version;
use super::record::Record;
use super::run_folder::{
    self, COUNTS, EXPOSED, EXPOSURE, PHI, RunFolder, SATURATED, STDERR, remove_exposed,
};
use crate::film::{self, Channel, Frame, frame_name};
use crate::lab::{Errors, describe_exposure};
use crate::matrix::{Matrix, npy};
use crate::report;
use crate::scene::{Glare, Quantity, Scene, SensorModel, SensorSettings, Spread};
use crate::sensor::{
    Exposed, Exposure, Figures, Light, PhotonTransfer, Range, Sensor, Stated, Summary,
    builtin_summary, glare, glare_to_signal,
};
use crate::store::{ensure_writable, flush};

/// Matrices of Φcam's size that are held at once, beside one for each exposure.
const EXPOSING: f64 = 12.0;

/// exposure.json.
#[derive(Debug, Serialize)]
struct Account {
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
    /// What the sensor's calibration found, where it was used.
    photon_transfer: Option<PhotonTransfer>,
    result: Summary,
}

pub(super) fn execute(args: &ExposeArgs, console: Console) -> Result<Outcome, Failure> {
    let dir = match &args.dir {
        Some(dir) if !args.list => dir,
        _ => return output::print(&list()).map(|()| Outcome::Done),
    };
    let (scene, record) = read_run(dir, console)?;
    let settings = settings(args, &scene)?;
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
    let render_error = read_stderr(&dir.join(STDERR), &scene)?;
    let ambient = settings.ambient.unwrap_or(0.0);
    let light = Light::new(&phi, scene.laser.wavelength)?
        .with_glare(&scattered)?
        .with_render_error(&render_error, record.plan.budget.blocks)?
        .with_ambient(ambient)?;
    if phi.max() <= 0.0 {
        let cause = format!("{} is dark in every pixel", dir.join(PHI).display());
        return Err(Failure::new(
            cause,
            "render a scene whose light reaches the camera",
        ));
    }
    let out = args.output.clone().unwrap_or_else(|| dir.join(EXPOSED));
    refuse_obstacles(&out)?;
    let lock = |folder| RunFolder::lock(folder, "phicam expose");
    let _run = args.output.is_none().then(|| lock(dir)).transpose()?;
    let photon_transfer = match args.stderr {
        StatedBy::Counts => Some(sensor.photon_transfer(args.seed)),
        StatedBy::Oracle => None,
    };
    let stated = photon_transfer.map_or(Stated::Oracle, Stated::Counts);
    let exposed = sensor.expose(&light, &exposure, stated, args.seed)?;
    let result = Summary::new(&sensor, &light, &exposure, &exposed);
    remark(&result, args.strict, console)?;
    remark_dark(&result, &exposed, console);
    remark_render(&result, &record, console);
    let account = Account {
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
        photon_transfer,
        result,
    };
    let json = output::json(&account)?;
    let _own = args.output.as_deref().map(lock).transpose()?;
    write(&out, &exposed, (&scene, &record), &sensor, &json)?;
    if args.output.is_none() {
        Record::vouch_anew(dir, &[EXPOSED, &format!("{EXPOSED}/{COUNTS}")])?;
    }
    output::print(&if args.json {
        json
    } else {
        report::finding_text(&describe_exposure(&account.result, &account.times))
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

/// What stands in the way of an output shows before anything is written. The folder of a run is not
/// overwritten.
fn refuse_obstacles(out: &Path) -> Result<(), Failure> {
    if out.join(Record::FILE).exists() {
        let out = out.display();
        let cause = format!("{out} is the folder of a run, with its clean flux");
        return Err(Failure::new(cause, "choose another folder (-o)"));
    }
    let files = [PHI, STDERR, SATURATED, EXPOSURE];
    run_folder::refuse_obstacles(out, &[COUNTS], &files)
}

/// What is wrong with the photographs.
fn remark(result: &Summary, strict: bool, console: Console) -> Result<(), Failure> {
    let (entries, saturated, floored) = (result.entries, result.saturated, result.floored);
    let near = result.near;
    let cause = format!(
        "{saturated} of {entries} entries are saturated, {near} so near to it that they are low on average, {floored} cut off below"
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
            "warning: {:.2e} W of dark current and ambient light stay in every entry; subtract --dark-frames, \
             or recover with --background",
            result.pedestal
        ));
    }
    if result.common * exposed.flux.ncols() as f64 > 0.1 {
        console.say(format!(
            "warning: {:.2} % of the variance is that of the dark frames, which all spots of a pixel share, and recover takes entries as independent; \
             take more --dark-frames, or recover with --background",
            100.0 * result.common
        ));
    }
}

/// What of the render's own error a recovery has to know.
fn remark_render(result: &Summary, record: &Record, console: Console) {
    if result.render <= 0.1 {
        return;
    }
    let shared = match Errors::of(record.plan.estimator) {
        Errors::Independent => "",
        Errors::WithinRows => ", which spots of a pixel share",
        Errors::Everywhere => ", which all entries share",
    };
    console.say(format!(
        "warning: {:.2} % of the variance is that of the render itself{shared}; render with more --samples",
        100.0 * result.render
    ));
}

fn write(
    out: &Path,
    exposed: &Exposed,
    (scene, record): (&Scene, &Record),
    sensor: &Sensor,
    json: &str,
) -> Result<(), Failure> {
    let counts = out.join(COUNTS);
    ensure_writable(&counts)?;
    remove_abandoned(&counts)?;
    remove_abandoned(out)?;
    remove_exposed(out)?;
    ensure_writable(&counts)?;
    let (pixels, spots) = exposed.flux.shape();
    for spot in 0..spots {
        write_counts(&counts, exposed, (scene, record), sensor, spot)?;
    }
    flush(&counts)?;
    let mask = Matrix::from_iterator(
        pixels,
        spots,
        exposed.range.iter().map(|range| match range {
            Range::Within => 0.0,
            Range::Saturated => 1.0,
            Range::Near => 0.5,
            Range::Floored => -1.0,
        }),
    );
    npy::write(&out.join(SATURATED), &mask)?;
    npy::write(&out.join(STDERR), &exposed.stderr)?;
    npy::write(&out.join(PHI), &exposed.flux)?;
    output::write(&out.join(EXPOSURE), json)
}

/// The frame of one spot: its counts at each exposure time as EXR, those of the longest as PNG.
fn write_counts(
    folder: &Path,
    exposed: &Exposed,
    (scene, record): (&Scene, &Record),
    sensor: &Sensor,
    spot: usize,
) -> Result<(), Failure> {
    let single = exposed.counts.len() == 1;
    let channel = |(k, counts): (usize, &Matrix)| Channel {
        name: if single {
            film::frame::COUNTS.to_owned()
        } else {
            format!("{}.{k}", film::frame::COUNTS)
        },
        values: counts.column(spot).iter().map(|x| *x as f32).collect(),
    };
    let frame = Frame {
        columns: scene.camera.columns,
        rows: scene.camera.rows,
        channels: exposed.counts.iter().enumerate().map(channel).collect(),
        meta: run_folder::meta(scene, record, spot),
    };
    let path: PathBuf = folder.join(frame_name(spot as u32));
    film::exr::write(&path, &frame)?;
    let values: Vec<f64> = exposed.counts[0].column(spot).iter().copied().collect();
    let white = match sensor.figures().bits {
        Some(_) => 65535.0,
        None => exposed.counts[0].max(),
    };
    let png = report::counts_png([frame.columns, frame.rows], &values, white)?;
    output::write(&path.with_extension("png"), &png)
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
