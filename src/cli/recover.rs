//! `phicam recover`: the hidden reflectance from Φcam.

use std::path::{Path, PathBuf};

use super::args::RecoverArgs;
use super::console::Console;
use super::failure::Failure;
use super::load_run::{read_bare_scene, read_matrix, read_run, read_stderr};
use super::recover_beside::{Beside, Photographs, mask};
use super::recover_memory::{self, Errors, Held, Strips};
use super::recover_options::{self, uncertainty};
use super::recovered::{collect, recovering, tell, write};
use super::run_folder::{PHI, RECOVERED, RunFolder, SATURATED, STDERR, is_of_recovered};
use super::{Outcome, recover_own};
use crate::folder::Record;
use crate::lab::{
    Attempt, Certainty, Noise, RecoveredObject, by_trust, inverted, recover_with_picards,
};
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, Picard};
use crate::scene::Scene;
use crate::store::digest;

/// Pixels of a mask that are looked at together.
const MASK_ROWS: usize = 256;

pub(super) fn execute(args: &RecoverArgs, console: Console) -> Result<Outcome, Failure> {
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
    let options = recover_options::checked(args, &methods(0))?;
    refuse_repetition(&named)?;
    if let Some(camera_side) = &args.camera_side {
        return recover_own::execute(args, camera_side, &named, options, console);
    }
    let Some(dir) = &args.dir else {
        let cure = "give the folder of a run, or --camera-side and --phi";
        return Err(Failure::usage("nothing says what is to be recovered", cure));
    };
    // Measured photographs come without a run: a scene.toml is enough for them.
    let measured = args.phi.is_some() && !dir.join(Record::FILE).exists();
    let (scene, record) = if measured {
        (read_bare_scene(dir, console)?, None)
    } else {
        let (scene, record) = read_run(dir, console)?;
        (scene, Some(record))
    };
    if let Some(record) = record
        .as_ref()
        .filter(|_| is_own(args.phi.as_deref(), dir, PHI))
    {
        refuse_unscaled(args, record, &methods(0), console)?;
    }
    let lock = |folder| RunFolder::lock(folder, "phicam recover");
    let _run = args.output.is_none().then(|| lock(dir)).transpose()?;
    let modelled = if args.joint.occluder_light {
        scene.with_occluders_as_elements()?
    } else {
        scene.clone()
    };
    let methods = methods(recover_memory::elements(args, &modelled));
    recover_options::checked(args, &methods)?;
    let held = recover_memory::plan(args, &modelled, &methods, &options, console)?;
    let request = RecoveryRequest {
        args,
        dir,
        scene: &modelled,
        methods: &methods,
        options,
        certainty: certainty(args, dir, record.as_ref()),
        is_imported: record.as_ref().is_some_and(Record::is_imported),
        phi: args.phi.clone().unwrap_or_else(|| dir.join(PHI)),
        console,
    };
    let (attempts, picards) = match held {
        Held::Whole => request.whole()?,
        Held::Strips(pixels) => (request.strips(pixels)?, Vec::new()),
    };
    let mut objects = collect(attempts, methods.len() == 1, console)?;
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
fn certainty(args: &RecoverArgs, dir: &Path, record: Option<&Record>) -> Certainty {
    let own = match record.filter(|_| has_own_errors(args, dir)) {
        None => Certainty::STATED,
        Some(record) => match record.origin.plan() {
            Some(plan) => Certainty::of(plan),
            // A background takes what all spots of a pixel share.
            None => {
                let shared = record.origin.shares_by_pixel() && !args.joint.background;
                Certainty {
                    errors: crate::lab::Errors::of_photographs(shared),
                    ..Certainty::STATED
                }
            }
        },
    };
    Certainty {
        replicates: args.replicates.or(own.replicates),
        ..own
    }
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

/// A recovery that was asked for.
struct RecoveryRequest<'a> {
    args: &'a RecoverArgs,
    /// Folder of the run.
    dir: &'a Path,
    scene: &'a Scene,
    methods: &'a [Method],
    options: Options,
    certainty: Certainty,
    /// Whether the run's photographs were imported: their noise may be unknown.
    is_imported: bool,
    /// File of Φcam.
    phi: PathBuf,
    console: Console<'a>,
}

impl RecoveryRequest<'_> {
    /// From all of Φcam at once, with Picard plots.
    fn whole(&self) -> Result<(Vec<Attempt>, Vec<Picard>), Failure> {
        let Self { args, scene, .. } = *self;
        let phi = read_matrix(&self.phi, scene)?;
        self.refuse_clipped()?;
        let stderr = match self.errors() {
            Errors::Relative(noise) => Some(phi.map(|x| x.abs() * noise)),
            Errors::File(file) => Some(read_stderr(&file, scene)?),
            Errors::Unknown => {
                self.console.say(
                    "no noise model is given (--noise or --stderr): joint weights all entries alike",
                );
                None
            }
        };
        let occlusion = args.occlusion.occlusion();
        let model = inverted(
            scene,
            args.kernel,
            args.elements,
            occlusion,
            args.integration,
        )?;
        let noise = stderr.as_ref().map_or(Noise::Unknown, |stderr| {
            Noise::StandardError(stderr, self.certainty)
        });
        let of = Photographs {
            name: format!("scene `{}`", scene.name),
            grid: Some([scene.camera.columns, scene.camera.rows]),
            pixels: scene.camera.pixels(),
            spots: scene.laser.spots.len(),
        };
        let beside = Beside::read(args, &self.phi, &of, self.console)?;
        let nuisance = beside.nuisance(args);
        let options = Options {
            uncertainty: uncertainty(&model, self.console),
            frame: of.grid,
            ..self.options
        };
        let what = format!("recover {}", scene.name);
        let (attempts, picards) = recovering(self.console, &what, self.methods, |control| {
            recover_with_picards(
                &model,
                &phi,
                noise,
                nuisance,
                self.methods,
                &options,
                control,
            )
        });
        Ok((attempts, picards?))
    }

    /// From so many pixels of Φcam at a time.
    fn strips(&self, pixels: usize) -> Result<Vec<Attempt>, Failure> {
        let Self { args, scene, .. } = *self;
        let phi = recover_memory::open(&self.phi, scene)?;
        self.refuse_clipped()?;
        if let Some(mask) = mask(args, &self.phi) {
            let cause = format!(
                "{} says which entries do not count, and no method that reads Φcam by rows can leave them out",
                mask.display()
            );
            let cure = "use a joint method, with enough --memory for all of Φcam";
            return Err(Failure::new(cause, cure));
        }
        let errors = match self.errors() {
            Errors::Relative(noise) => Errors::Relative(noise),
            Errors::File(file) => Errors::File(Box::new(recover_memory::open(&file, scene)?)),
            Errors::Unknown => Errors::Unknown,
        };
        let occlusion = args.occlusion.occlusion();
        let model = MatrixModel::without_photographs(scene, args.kernel, args.elements, occlusion)?;
        self.console
            .say("Φcam is read by rows: no covariance, no resolution, no Picard plot");
        let mut strips = Strips {
            model: &model,
            phi,
            errors,
            certainty: self.certainty,
            pixels,
        };
        strips.recover(self.methods, &self.options)
    }

    /// Of a foreign Φcam nothing is known but what is given.
    fn errors(&self) -> Errors<PathBuf> {
        match (&self.args.stderr, self.args.noise) {
            (_, Some(noise)) => Errors::Relative(noise),
            (Some(file), None) => Errors::File(file.clone()),
            (None, None) if is_own(self.args.phi.as_deref(), self.dir, PHI) => {
                let file = self.dir.join(STDERR);
                if self.is_imported && !file.exists() {
                    return Errors::Unknown;
                }
                Errors::File(file)
            }
            (None, None) => Errors::Unknown,
        }
    }

    /// Refuses photographs of `phicam expose` whose values mean nothing in places: they are too low
    /// or too high by an unknown amount, and no standard error says so.
    fn refuse_clipped(&self) -> Result<(), Failure> {
        let mask = self.phi.with_file_name(SATURATED);
        let asked = self.args.keep_clipped || self.args.left_out.is_some();
        if self.args.phi.is_none() || asked || !mask.exists() {
            return Ok(());
        }
        let mut rows = recover_memory::open(&mask, self.scene)?;
        let (pixels, spots) = rows.shape();
        let mut marked = 0;
        for first in (0..pixels).step_by(MASK_ROWS) {
            let part = rows.read(first, MASK_ROWS)?;
            marked += part.iter().filter(|x| x.abs() >= 1.0).count();
        }
        if marked == 0 {
            return Ok(());
        }
        Err(Failure::new(
            format!(
                "{marked} of {} entries of {} are saturated or cut off, says {}: neither their values nor their standard errors mean anything",
                pixels * spots,
                self.phi.display(),
                mask.display()
            ),
            format!(
                "expose for a shorter time or in --brackets; --left-out {} leaves them out of the joint methods; --keep-clipped takes them as they are",
                mask.display()
            ),
        ))
    }
}

/// Refuses photographs in counts whose scale is taken for that of W.
fn refuse_unscaled(
    args: &RecoverArgs,
    record: &Record,
    methods: &[Method],
    console: Console,
) -> Result<(), Failure> {
    let joint = methods.iter().any(|method| method.is_joint());
    if !record.is_imported() || args.joint.free_scale || !joint {
        return Ok(());
    }
    let Some(unit) = record.origin.unscaled() else {
        if args.joint.scale_error.is_none() {
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
    let repeated = (1..methods.len()).find(|k| methods[..*k].contains(&methods[*k]));
    match repeated {
        None => Ok(()),
        Some(k) => Err(Failure::new(
            format!("--method names {} twice", methods[k]),
            "name each once: their files would overwrite each other",
        )),
    }
}
