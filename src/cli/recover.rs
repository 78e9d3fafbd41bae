//! `phicam recover`: the hidden reflectance from Φcam.

use std::path::Path;

use super::args::RecoverArgs;
use super::expose::SATURATED;
use super::failure::Failure;
use super::finished::{read_matrix, read_run, read_stderr};
use super::folder::{PHI, SCENE, STDERR};
use super::output::{self, Talk};
use super::record::Record;
use super::recover_memory::{self, Errors, Held};
use super::stale::remove_named;
use super::trust;
use super::{Outcome, recover_options, settings};
use crate::matrix::{Matrix, npy};
use crate::model::MatrixModel;
use crate::recovery::{Directions, Method, Nuisance, Options, Picard, Uncertainty};
use crate::report::{self, Panel};
use crate::scene::{Division, Scene, Surface};
use crate::store::{ensure_writable, write_whole};
use crate::study::{Attempt, Noise, RecoveredObject, picards, recover_objects};

/// Elements whose covariance and resolution are still written: 32 MiB each.
const MOST_CORRELATED: usize = 2048;
/// Pixels of a mask that are looked at together.
const MASK_ROWS: usize = 256;

pub(super) fn execute(args: &RecoverArgs, talk: Talk) -> Result<Outcome, Failure> {
    let methods: Vec<Method> = match args.method.as_slice() {
        [] => Method::USUAL.to_vec(),
        names => names.iter().map(|n| n.parse()).collect::<Result<_, _>>()?,
    };
    let mut options = recover_options::checked(args, &methods)?;
    refuse_repetition(&methods)?;
    // Measured photographs come without a run: a scene.toml is enough for them.
    let measured = args.phi.is_some() && !args.dir.join(Record::FILE).exists();
    let scene = match measured {
        true => trust::load(&args.dir.join(SCENE).to_string_lossy())?,
        false => read_run(&args.dir)?.0,
    };
    if let Held::Strips(pixels) = recover_memory::plan(args, &scene, &methods, &options, talk)? {
        return in_strips(args, &scene, pixels, &methods, &options, talk);
    }
    let phi = read_matrix(args.phi.as_ref().unwrap_or(&args.dir.join(PHI)), &scene)?;
    if let (Some(file), false) = (&args.phi, args.keep_clipped) {
        refuse_clipped(file, &scene)?;
    }
    let stderr = match (&args.stderr, args.noise) {
        (_, Some(noise)) => Some(phi.map(|x| x.abs() * noise)),
        (Some(file), None) => Some(read_stderr(file, &scene)?),
        (None, None) if args.phi.is_none() => Some(read_stderr(&args.dir.join(STDERR), &scene)?),
        // Of a foreign Φcam nothing is known but what is said.
        (None, None) => {
            talk.say(
                "no noise model is given (--noise or --stderr): joint weights all entries alike",
            );
            None
        }
    };
    let mut model = MatrixModel::new(&scene, settings::kernel(args.kernel), args.elements)?;
    if args.occlusion {
        model = model.with_occlusion(&scene);
    }
    let noise = stderr.as_ref().map_or(Noise::Unknown, Noise::StandardError);
    let glare = match &args.joint.glare_pattern {
        Some(file) => Some(read_matrix(file, &scene)?),
        None => None,
    };
    let nuisance = Nuisance {
        frame_constant: args.joint.frame_constant,
        background: args.joint.background,
        glare: glare.as_ref(),
        free_scale: args.joint.free_scale,
    };
    options.uncertainty = uncertainty(&model, talk);
    let attempts = recover_objects(&model, &phi, noise, nuisance, &methods, &options);
    let single = methods.len() == 1;
    let objects = collect(attempts, single, talk)?;
    let picards = picards(&model, &phi, noise, nuisance, &methods, &options)?;
    deliver(args, &scene, &objects, &picards)
}

/// The same from photographs that are never held at once.
fn in_strips(
    args: &RecoverArgs,
    scene: &Scene,
    pixels: usize,
    methods: &[Method],
    options: &Options,
    talk: Talk,
) -> Result<Outcome, Failure> {
    let mut phi = recover_memory::open(args.phi.as_ref().unwrap_or(&args.dir.join(PHI)), scene)?;
    if let (Some(file), false) = (&args.phi, args.keep_clipped) {
        refuse_clipped(file, scene)?;
    }
    let mut errors = match (&args.stderr, args.noise) {
        (_, Some(noise)) => Errors::Relative(noise),
        (Some(file), None) => Errors::File(Box::new(recover_memory::open(file, scene)?)),
        (None, None) if args.phi.is_none() => Errors::File(Box::new(recover_memory::open(
            &args.dir.join(STDERR),
            scene,
        )?)),
        (None, None) => Errors::Unknown,
    };
    let kernel = settings::kernel(args.kernel);
    let mut model = MatrixModel::without_photographs(scene, kernel, args.elements)?;
    if args.occlusion {
        model = model.with_occlusion(scene);
    }
    talk.say("Φcam is read by rows: no covariance, no resolution, no Picard plot");
    let attempts =
        recover_memory::recover(&model, &mut phi, &mut errors, pixels, methods, options)?;
    let objects = collect(attempts, methods.len() == 1, talk)?;
    deliver(args, scene, &objects, &[])
}

/// Writes and prints.
fn deliver(
    args: &RecoverArgs,
    scene: &Scene,
    objects: &[RecoveredObject],
    picards: &[Picard],
) -> Result<Outcome, Failure> {
    write(&args.dir, scene, objects, picards)?;
    let text = if args.json {
        output::json(&objects)?
    } else {
        report::recovery_table(objects)
    };
    output::print(&text)?;
    Ok(Outcome::Done)
}

fn refuse_repetition(methods: &[Method]) -> Result<(), Failure> {
    let repeated = (1..methods.len()).find(|k| methods[..*k].contains(&methods[*k]));
    match repeated {
        None => Ok(()),
        Some(k) => Err(Failure::new(
            format!("--method names {} twice", methods[k]),
            "name each once: their files would overwrite each other",
        )),
    }
}

/// Refuses photographs of `phicam expose` whose values mean nothing in places: they are too low or too high by nobody knows how much, and no standard
/// error says so.
fn refuse_clipped(phi: &Path, scene: &Scene) -> Result<(), Failure> {
    let mask = phi.with_file_name(SATURATED);
    if !mask.exists() {
        return Ok(());
    }
    let mut rows = recover_memory::open(&mask, scene)?;
    let (pixels, spots) = rows.shape();
    let mut marked = 0;
    for first in (0..pixels).step_by(MASK_ROWS) {
        let part = rows.read(first, MASK_ROWS)?;
        marked += part.iter().filter(|x| **x != 0.0).count();
    }
    match marked {
        0 => Ok(()),
        n => Err(Failure::new(
            format!(
                "{n} of {} entries of {} are saturated or cut off, says {}: neither their values nor their standard errors mean anything",
                pixels * spots,
                phi.display(),
                mask.display()
            ),
            "expose for a shorter time or in --brackets; --keep-clipped takes them as they are",
        )),
    }
}

/// How much of the uncertainty fits the elements of the model.
pub(super) fn uncertainty(model: &MatrixModel, talk: Talk) -> Uncertainty {
    if model.laser_side.nrows() <= MOST_CORRELATED {
        return Uncertainty::Full;
    }
    talk.say(format!(
        "more than {MOST_CORRELATED} elements: no covariance and no resolution of the methods that work pixel by pixel"
    ));
    Uncertainty::StandardError
}

/// The objects that were recovered. A method that cannot work is reported; if none can, or the only one asked for, that is
/// the command's failure.
pub(super) fn collect(
    attempts: Vec<Attempt>,
    strict: bool,
    talk: Talk,
) -> Result<Vec<RecoveredObject>, Failure> {
    let mut objects = Vec::new();
    let mut reasons = Vec::new();
    for attempt in attempts {
        match attempt.outcome {
            Ok(found) => objects.extend(found),
            Err(e) if strict => return Err(e.into()),
            Err(e) => reasons.push(format!("{}: {e}", attempt.method)),
        }
    }
    if objects.is_empty() {
        let cause = format!(
            "no method could recover anything\n  {}",
            reasons.join("\n  ")
        );
        return Err(Failure::new(
            cause,
            "see the reason of each, or choose one with --method",
        ));
    }
    for reason in reasons {
        talk.say(reason);
    }
    Ok(objects)
}

/// Writes DIR/recovered/METHOD.npy (nv × nu) and METHOD.png, truth.npy and truth.png, and overview.png with all of them side
/// by side (no pictures of elements that are the triangles of a mesh); METHOD.texture.png, the reflectance as a texture for a scene, and METHOD.ply, the
/// surface with it as colours; what is known of the uncertainty in METHOD.stderr.npy (nv × nu), METHOD.covariance.npy and METHOD.resolution.npy (own elements ×
/// elements of all surfaces), METHOD.bias.npy (nv × nu), METHOD.lower.npy and METHOD.upper.npy where bands were asked for; NAME.csv and NAME.svg of each of
/// `picards`, and no others. Where several surfaces are hidden the names are METHOD-0, METHOD-1, … in file order.
pub(super) fn write(
    dir: &Path,
    scene: &Scene,
    objects: &[RecoveredObject],
    picards: &[Picard],
) -> Result<(), Failure> {
    let folder = dir.join("recovered");
    ensure_writable(&folder)?;
    remove_named(&folder, &["picard-joint.csv", "picard-joint.svg"])?;
    for picard in picards {
        let name = match picard.directions {
            Directions::LaserSide => "picard",
            Directions::Joint | Directions::JointWeighted => "picard-joint",
        };
        let texts = [
            ("csv", report::picard_csv(picard)),
            ("svg", report::picard_svg(picard)),
        ];
        for (extension, text) in texts {
            let path = folder.join(format!("{name}.{extension}"));
            write_whole(&path, |w| w.write_all(text.as_bytes()))?;
        }
    }
    let mut surfaces: Vec<&str> = Vec::new();
    for object in objects {
        if !surfaces.contains(&object.surface.as_str()) {
            surfaces.push(&object.surface);
        }
    }
    for (i, surface) in surfaces.iter().enumerate() {
        let suffix = if surfaces.len() > 1 {
            format!("-{i}")
        } else {
            String::new()
        };
        let shape = scene.surfaces.iter().find(|s| s.name == **surface);
        let drawn = shape.is_none_or(|s| s.division == Division::Cells);
        let mut panels = Vec::new();
        for object in objects.iter().filter(|o| o.surface == *surface) {
            let [nu, nv] = object.elements;
            let method = (object.method.as_str(), &object.reflectance);
            let truth = panels.is_empty().then_some(("truth", &object.truth));
            for (name, values) in truth.into_iter().chain([method]) {
                let path = folder.join(format!("{name}{suffix}"));
                npy::write(
                    &path.with_extension("npy"),
                    &Matrix::from_row_slice(nv, nu, values),
                )?;
                if drawn {
                    let panel = Panel::elements(name, object.elements, values.clone());
                    write_png(&path, surface, std::slice::from_ref(&panel))?;
                    panels.push(panel);
                }
            }
            if let Some(shape) = shape {
                write_surface(
                    &folder,
                    &format!("{}{suffix}", object.method),
                    shape,
                    object,
                )?;
            }
            write_uncertainty(&folder, &format!("{}{suffix}", object.method), object)?;
        }
        if drawn {
            write_png(&folder.join(format!("overview{suffix}")), surface, &panels)?;
        }
    }
    Ok(())
}

/// Writes `name`.texture.png and `name`.ply.
fn write_surface(
    folder: &Path,
    name: &str,
    surface: &Surface,
    object: &RecoveredObject,
) -> Result<(), Failure> {
    let values = &object.reflectance;
    if surface.division == Division::Cells {
        let png = report::texture_png(object.elements, values)?;
        let path = folder.join(format!("{name}.texture.png"));
        write_whole(&path, |w| w.write_all(&png))?;
    }
    let ply = report::recovered_ply(surface, object.elements, values);
    let path = folder.join(format!("{name}.ply"));
    Ok(write_whole(&path, |w| w.write_all(&ply))?)
}

/// Writes `name`.stderr.npy, `name`.covariance.npy, `name`.resolution.npy, `name`.bias.npy, `name`.lower.npy and `name`.upper.npy, and removes those of an earlier recovery that are not known now.
fn write_uncertainty(folder: &Path, name: &str, object: &RecoveredObject) -> Result<(), Failure> {
    let [nu, nv] = object.elements;
    let picture = |values: &Vec<f64>| Matrix::from_row_slice(nv, nu, values);
    let bands = object.bands.as_ref();
    let matrices = [
        ("stderr", object.standard_error.as_ref().map(picture)),
        ("bias", object.bias.as_ref().map(picture)),
        ("lower", bands.map(|b| picture(&b.lower))),
        ("upper", bands.map(|b| picture(&b.upper))),
        ("covariance", object.covariance.clone()),
        ("resolution", object.resolution.clone()),
    ];
    for (what, matrix) in matrices {
        let path = folder.join(format!("{name}.{what}.npy"));
        match matrix {
            Some(matrix) => npy::write(&path, &matrix)?,
            None if path.exists() => std::fs::remove_file(&path)?,
            None => {}
        }
    }
    Ok(())
}

/// Writes `path`.png: panels on one fixed grey scale.
fn write_png(path: &Path, title: &str, panels: &[Panel]) -> Result<(), Failure> {
    let png = report::grey_png(title, panels)?;
    Ok(write_whole(&path.with_extension("png"), |w| {
        w.write_all(&png)
    })?)
}
