//! `phicam import`: photographs of a real camera → Φcam in a run folder.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::cli::Outcome;
use crate::cli::args::ImportArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::process::version;
use crate::cli::run_folder::RunFolder;
use crate::folder::Record;
use crate::folder::names::{IMPORT, IMPORT_PNG, LEFT_OUT, PHI, STDERR};
use crate::folder::{Origin, Photographs};
use crate::jobs::need;
use crate::lab::Errors;
use crate::matrix::npy;
use crate::num::digits::figure;
use crate::photographs::set::{ChannelName, DarkTable, Files, Set};
use crate::photographs::{ImportAccount, Imported, import, scene_of};
use crate::report;
use crate::scene::Scene;
use crate::store::{self, digest_of};

/// Most bytes of a list.
const LIST_MAX: u64 = 16 << 20;
/// Matrices of Φcam's size that are held at once.
const HELD: f64 = 6.0;

/// import.json.
#[derive(Debug, Serialize)]
struct Written<'a> {
    version: &'a str,
    #[serde(flatten)]
    account: &'a ImportAccount,
}

pub(in crate::cli) fn execute(args: &ImportArgs, console: Console) -> Result<Outcome, Failure> {
    let (set, folder, scene) = given(args, console)?;
    let scene = scene_of(&set, scene, &folder)?;
    need::photographs(&scene, HELD)?;
    let mut printed = Vec::new();
    if set.channel == Some(ChannelName::All) {
        use ChannelName::{Blue, Green, Red};
        for (channel, name) in [(Red, "red"), (Green, "green"), (Blue, "blue")] {
            let dir = args.output.join(name);
            printed.push(one(
                args,
                (&set, &scene, &folder),
                Some(channel),
                &dir,
                console,
            )?);
        }
    } else {
        let channel = set.channel;
        printed.push(one(
            args,
            (&set, &scene, &folder),
            channel,
            &args.output,
            console,
        )?);
    }
    output::print(&if args.json && printed.len() > 1 {
        format!("[\n{}]\n", printed.join(",\n"))
    } else {
        printed.concat()
    })?;
    Ok(Outcome::Done)
}

/// The list with the arguments in its place, the folder of its files, and the scene.
fn given(args: &ImportArgs, console: Console) -> Result<(Set, PathBuf, Scene), Failure> {
    let (mut set, beside) = match &args.set {
        None => (Set::default(), PathBuf::from(".")),
        Some(path) => {
            let bytes = store::read(path, LIST_MAX)?;
            let name = path.to_string_lossy();
            let text = String::from_utf8(bytes).map_err(|_| {
                let cause = format!("{name} is no text in UTF-8");
                Failure::new(cause, "give a list of photographs in TOML")
            })?;
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
            let folder = folder.unwrap_or(Path::new(".")).to_owned();
            (Set::parse(&name, &text)?, folder)
        }
    };
    let one = |name: &String| Files::One(name.clone());
    if let Some(frames) = &args.frames {
        set.frames = Some(one(frames));
        set.list = None;
        set.frame.clear();
    }
    if let Some(dark) = &args.dark {
        set.dark = Some(DarkTable::Files(one(dark)));
    }
    set.flat = args.flat.as_ref().map(one).or(set.flat);
    set.repeats = args.repeats.or(set.repeats);
    set.channel = args.channel.or(set.channel);
    set.exposure = args.exposure.or(set.exposure);
    set.halo = args.halo.or(set.halo);
    if args.gamma.is_some() {
        set.gamma = args.gamma;
        set.response = None;
    }
    let scene = match &args.scene {
        Some(scene) => {
            set.scene.clone_from(scene);
            console.load_any_scene(scene)?
        }
        None if set.scene.is_empty() => {
            let cause = "nothing says of which scene the photographs are";
            return Err(Failure::usage(
                cause,
                "give --scene SCENE, or `scene` in the list",
            ));
        }
        // A built-in one has no file beside the list.
        None if beside.join(&set.scene).exists() => {
            console.load_any_scene(&beside.join(&set.scene).to_string_lossy())?
        }
        None => console.load_any_scene(&set.scene)?,
    };
    let set = set.checked()?;
    let folder = args.from.clone().unwrap_or(beside);
    Ok((set, folder, scene))
}

/// Imports one channel into `dir`; what is to be printed.
fn one(
    args: &ImportArgs,
    (set, scene, folder): (&Set, &Scene, &Path),
    channel: Option<ChannelName>,
    dir: &Path,
    console: Console,
) -> Result<String, Failure> {
    RunFolder::refuse_obstacles(dir)?;
    let imported = import(set, scene, folder, channel)?;
    for warning in &imported.account.warnings {
        console.say(format!("warning: {warning}"));
    }
    let account = &imported.account;
    let errors = Errors::of_common(account.common, scene.laser.spots.len());
    if errors != Errors::Independent {
        console.say(format!(
            "warning: {:.2} % of the variance is that of the dark frames, which all spots of a pixel \
             share, so that recover states no errors; take more dark frames, or recover with \
             --background",
            100.0 * account.common
        ));
    }
    let of_flat = Errors::of_common(account.of_flat, scene.laser.spots.len());
    if of_flat != Errors::Independent {
        console.say(format!(
            "warning: {:.2} % of the variance is that of the flat field, a factor of each pixel that all \
             spots share; recover and validate take it for independent, so that errors of the picture \
             are too small and χ² scatters more than is said; take more photographs of the flat field",
            100.0 * account.of_flat
        ));
    }
    let json = output::json(&Written {
        version: version(),
        account,
    })?;
    let photographs = Photographs {
        settings: digest_of(&serde_json::to_vec(&(set, channel))?),
        flux_unit: account.unit.to_owned(),
        shares_by_pixel: errors != Errors::Independent,
        noise_unknown: imported.stderr.as_ref().map_or(0.0, |_| account.unknown),
        frame_gain: account.frame_gain(),
        sources: account.files.clone(),
    };
    let origin = Origin::Imported {
        imported: photographs,
    };
    let mut record = Record::new(scene, origin, scene.laser.spots.len(), 1, 0.0);
    let _lock = RunFolder::lock(dir, "phicam import")?;
    let run = RunFolder::at(dir);
    if !run.holds_import(&record, args.replace)? {
        let picture = picture(&imported, scene)?;
        run.put(scene, console, args.replace, |staged| {
            let path = |name: &str| staged.join(name);
            npy::write(&path(LEFT_OUT), &imported.left_out)?;
            if let Some(stderr) = &imported.stderr {
                npy::write(&path(STDERR), stderr)?;
            }
            npy::write(&path(PHI), &imported.phi)?;
            output::write(&path(IMPORT), &json)?;
            output::write(&path(IMPORT_PNG), &picture)?;
            record.vouch_for_import(staged, scene)?;
            Ok(record.write(staged)?)
        })?;
    }
    Ok(if args.json {
        json
    } else {
        summary(account, imported.stderr.is_some(), dir)
    })
}

/// The mean photograph with the scene's view, the spots and the marks on it.
fn picture(imported: &Imported, scene: &Scene) -> Result<Vec<u8>, Failure> {
    let (values, size) = &imported.mean;
    let view = &scene.camera.view;
    let mapping = &imported.mapping;
    let sides = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
    let outline = sides.windows(2).flat_map(|w| {
        (0..=16).map(move |k| [0, 1].map(|i| w[0][i] + (w[1][i] - w[0][i]) * f64::from(k) / 16.0))
    });
    let spots = scene
        .laser
        .beams()
        .iter()
        .map(|s| view.coordinates(s.target.position));
    let drawn = report::Marked {
        size: *size,
        values,
        outline: outline.filter_map(|at| mapping.pixel(at)).collect(),
        spots: spots.filter_map(|at| mapping.pixel(at)).collect(),
        marks: imported.account.set.marks.iter().map(|m| m.pixel).collect(),
    };
    Ok(report::photograph_png(&drawn)?)
}

/// What was imported, in a few lines.
fn summary(account: &ImportAccount, has_noise: bool, dir: &Path) -> String {
    let left = account.left_out;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {} photographs of {} × {} pixels as Φcam of scene `{}`, in {}",
        dir.display(),
        account.photographs,
        account.photograph[0],
        account.photograph[1],
        account.scene,
        account.unit
    );
    let reasons = left.reasons().map(|(why, n)| format!("{why} {n}"));
    let _ = writeln!(
        text,
        "  left out: {} of {} entries ({})",
        left.left_out,
        left.entries,
        reasons.join(", ")
    );
    if let Some(rms) = account.mark_rms {
        let error = account
            .mark_error
            .map_or(String::new(), |e| format!("; error of a mark {e:.2} px"));
        let _ = writeln!(text, "  marks: {rms:.2} px off on average{error}");
    }
    match (account.noise, account.photon_transfer) {
        (Some(noise), Some(line)) => {
            let read = if noise.has_offset {
                "read noise not told (no dark frames)".to_owned()
            } else {
                let (read, error) = (noise.read_variance.sqrt(), line.read_variance_error);
                // σ² is what the line tells: near 0 only up to where σ may be is known.
                if noise.read_variance > error {
                    let error = 0.5 * error / read;
                    format!(
                        "read noise {} ± {} counts",
                        figure(read, 4),
                        figure(error, 2)
                    )
                } else {
                    let most = (noise.read_variance + 2.0 * error).sqrt();
                    format!("read noise below {} counts", figure(most, 3))
                }
            };
            let _ = writeln!(
                text,
                "  noise, from repeats: gain {} ± {} counts, {read}; the line fits with probability {:.3}",
                figure(noise.gain, 4),
                figure(line.gain_error, 2),
                line.p
            );
        }
        (Some(noise), None) => {
            // What repeats tell is that of the mean, whatever its channels share.
            let of = if account.channel == Some(ChannelName::Mean) {
                ", of one channel; that of the three is taken for independent, and repeats tell whether it is"
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "  noise, as given: gain {} counts, read noise {} counts{of}",
                noise.gain,
                noise.read_variance.sqrt()
            );
        }
        (None, _) => text.push_str("  noise: not known\n"),
    }
    let stderr = if has_noise { "phi.stderr.npy, " } else { "" };
    let _ = writeln!(
        text,
        "  phi.npy, {stderr}left_out.npy, import.json and import.png"
    );
    text
}
