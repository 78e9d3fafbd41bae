//! `phicam recover`: the hidden reflectance from Φcam.

mod request;

use std::path::{Path, PathBuf};

use super::beside::certainty;
use super::recover_memory::{self, Held};
use super::recover_options;
use super::recover_own;
use super::recovered::{collect, tell, write};
use crate::cli::Outcome;
use crate::cli::args::RecoverArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{is_calibrated, read_run_or_scene};
use crate::cli::run_folder::{PHI, RECOVERED, RunFolder, STDERR, is_of_recovered};
use crate::folder::{Origin, Record};
use crate::lab::{Certainty, RecoveredObject, by_trust, unmodelled};
use crate::num::repetition::first_repeated;
use crate::recovery::Method;
use crate::store::digest;
use request::RecoveryRequest;

pub(in crate::cli) fn execute(args: &RecoverArgs, console: Console) -> Result<Outcome, Failure> {
    let named: Vec<Method> = args
        .method
        .iter()
        .map(|name| name.parse())
        .collect::<Result<_, _>>()?;
    let methods = |elements: usize| {
        if named.is_empty() {
            Method::tried(elements)
        } else {
            named.clone()
        }
    };
    let options = recover_options::checked(args, &methods(0), 0)?;
    refuse_repetition(&named)?;
    if let Some(camera_side) = &args.camera_side {
        return recover_own::execute(args, camera_side, &named, options, console);
    }
    let Some(dir) = &args.dir else {
        let cure = "give the folder of a run, or --camera-side and --phi";
        return Err(Failure::usage("nothing says what is to be recovered", cure));
    };
    let (scene, record) = read_run_or_scene(dir, args.phi.as_deref(), console)?;
    if let Some(record) = record
        .as_ref()
        .filter(|_| is_own(args.phi.as_deref(), dir, PHI))
    {
        refuse_unscaled(args, record, &methods(0), console)?;
    }
    if record.is_none() && is_calibrated(dir)?.is_some() {
        console.say(format!(
            "warning: the geometry of {0} was estimated from photographs by `phicam calibrate`, and its errors are not in \
             those of the pictures: {0}/{1}.npy is one with them in {1}.stderr.npy",
            dir.display(),
            Method::JointGp
        ));
    }
    let lock = |folder| RunFolder::lock(folder, "phicam recover");
    let _run = args.output.is_none().then(|| lock(dir)).transpose()?;
    let modelled = if args.joint.occluder_light {
        scene.with_occluders_as_elements()?
    } else {
        scene.clone()
    };
    // A scene of fewer than three bounces has no light of the model.
    let beside = unmodelled(&modelled);
    if !beside.is_empty() && scene.max_bounces >= 3 {
        console.say(format!(
            "warning: the model of a recovery does not know: {}. Where the photographs hold it, and it is not estimated \
             beside (--background and the like), it is taken for the picture's",
            beside.join("; ")
        ));
    }
    let elements = recover_memory::elements(args, &modelled);
    let methods = methods(elements);
    let own = record.as_ref().filter(|_| has_own_errors(args, dir));
    let gains = own.map(|record| with_gains(args, &record.origin, &methods, console));
    let args = gains.as_ref().unwrap_or(args);
    recover_options::checked(args, &methods, elements)?;
    let held = recover_memory::plan(args, &modelled, &methods, &options, console)?;
    let request = RecoveryRequest {
        args,
        dir,
        scene: &modelled,
        methods: &methods,
        options,
        certainty: certainty_of(args, dir, record.as_ref()),
        is_imported: record.as_ref().is_some_and(Record::is_imported),
        phi: args.phi.clone().unwrap_or_else(|| dir.join(PHI)),
        console,
    };
    let (attempts, picards) = match held {
        Held::Whole => request.whole()?,
        Held::Strips(pixels) => (request.strips(pixels)?, Vec::new()),
    };
    let mut objects = collect(attempts, &named, console)?;
    // Methods that are named keep their order.
    if named.is_empty() {
        by_trust(&mut objects);
    }
    let (out, place) = results(args, dir, record.is_some())?;
    let _own = args.output.as_deref().map(lock).transpose()?;
    let hidden = |object: &&RecoveredObject| scene.hidden().any(|(_, s)| s.name == object.surface);
    let pictured: Vec<RecoveredObject> = objects.iter().filter(hidden).cloned().collect();
    write(&out, Some(&scene), &pictured, &picards)?;
    if place == Place::Run {
        Record::vouch_anew(dir, RECOVERED, is_of_recovered)?;
    } else {
        console.say(format!("{}: written", out.display()));
    }
    tell(&objects, args.json)
}

/// The arguments for photographs whose gains may be known roughly. Methods that work pixel by pixel
/// know nothing of them.
fn with_gains(
    args: &RecoverArgs,
    origin: &Origin,
    methods: &[Method],
    console: Console,
) -> RecoverArgs {
    let joint = methods.iter().any(|method| method.is_joint());
    let apart: Vec<&str> = methods
        .iter()
        .filter(|method| !method.is_joint())
        .map(|method| method.name())
        .collect();
    if let (Some(own), false) = (origin.frame_gain(), apart.is_empty()) {
        console.say(format!(
            "warning: the gains of these photographs are known to {own}, of which {} know nothing: their \
             errors are too small",
            apart.join(", ")
        ));
    }
    let beside = if joint {
        args.beside.of_photographs(origin, console)
    } else {
        args.beside.clone()
    };
    RecoverArgs {
        beside,
        ..args.clone()
    }
}

/// To what the results of a recovery belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// To the run, whose Φcam was inverted.
    Run,
    /// To another Φcam.
    Other,
}

/// The folder of the results. Those of a Φcam that is not the run's have one of their own, named
/// after it and its bytes, so that what lies in the run's belongs together.
fn results(args: &RecoverArgs, dir: &Path, of_run: bool) -> Result<(PathBuf, Place), Failure> {
    let usual = dir.join(RECOVERED);
    let other = args.phi.as_ref();
    let other = other.filter(|phi| !is_same_file(phi, &dir.join(PHI)));
    Ok(match (&args.output, other) {
        (Some(output), _) => (output.clone(), Place::Other),
        (None, Some(phi)) if of_run => {
            let digest = digest(phi)?;
            let full = std::path::absolute(phi)?;
            let folder = full.parent().and_then(Path::file_stem);
            let own = full.file_stem().filter(|stem| *stem != "phi");
            let name = own.or(folder).unwrap_or_default().to_string_lossy();
            let name = format!("{RECOVERED}-{name}-{}", &digest[..8]);
            (dir.join(name), Place::Other)
        }
        (None, Some(_)) => (usual, Place::Other),
        (None, None) => (usual, Place::Run),
    })
}

/// What is known of the errors: of the run's own more than of those that are given.
fn certainty_of(args: &RecoverArgs, dir: &Path, record: Option<&Record>) -> Certainty {
    let own = record.filter(|_| has_own_errors(args, dir));
    let own = own.map(|record| certainty(&record.origin, args.beside.background));
    own.unwrap_or(Certainty::STATED).or(args.replicates)
}

/// Whether Φcam and its errors are those of the run, named or not.
fn has_own_errors(args: &RecoverArgs, dir: &Path) -> bool {
    is_own(args.phi.as_deref(), dir, PHI)
        && is_own(args.stderr.as_deref(), dir, STDERR)
        && args.noise.is_none()
}

/// Whether a file that may have been named is the one of that name in the folder of the run.
fn is_own(given: Option<&Path>, dir: &Path, name: &str) -> bool {
    given.is_none_or(|file| is_same_file(file, &dir.join(name)))
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Refuses photographs in counts whose scale is taken for that of W.
fn refuse_unscaled(
    args: &RecoverArgs,
    record: &Record,
    methods: &[Method],
    console: Console,
) -> Result<(), Failure> {
    let joint = methods.iter().any(|method| method.is_joint());
    if !record.is_imported() || args.beside.free_scale || !joint {
        return Ok(());
    }
    let Some(unit) = record.origin.unscaled() else {
        if args.beside.scale_error.is_none() {
            console.say(
                "the scale of these photographs in W is taken as exact; --scale-error RELATIVE says how well it is known",
            );
        }
        return Ok(());
    };
    Err(Failure::new(
        format!(
            "the photographs are in {unit}, not in W, so their size says nothing of reflectances"
        ),
        "add --free-scale, or import them with `watts`, what one of these is in W",
    ))
}

fn refuse_repetition(methods: &[Method]) -> Result<(), Failure> {
    match first_repeated(methods.iter().map(|method| method.name())) {
        None => Ok(()),
        Some(name) => Err(Failure::new(
            format!("--method names {name} twice"),
            "name each once: their files would overwrite each other",
        )),
    }
}
