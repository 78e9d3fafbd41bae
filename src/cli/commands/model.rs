//! `phicam model`: the matrices of the model.

use std::path::Path;

use serde_json::json;

use crate::cli::Outcome;
use crate::cli::args::ModelArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::progress::clocked;
use crate::cli::run_folder::{MODEL, REPORT, RunFolder, SUMMARY, Z, is_of_model};
use crate::folder::{Record, write_scene};
use crate::jobs::need;
use crate::lab::Integration;
use crate::matrix::{Matrix, npy};
use crate::model::{Extent, MatrixModel, converged};
use crate::store::write_together;

pub(in crate::cli) fn execute(args: &ModelArgs, console: Console) -> Result<Outcome, Failure> {
    let scene = console.load_any_scene(&args.scene)?;
    let unknown = scene.unknown();
    let kernel = args.kernel;
    let quadrature = args.integration == Integration::Quadrature;
    need::model(&scene, args.elements, quadrature)?;
    let occlusion = args.occlusion.occlusion();
    let model = MatrixModel::with(&scene, kernel, args.elements, occlusion)?;
    let folder = RunFolder::at(&args.output);
    folder.refuse_foreign(&scene, console)?;
    let _lock = RunFolder::lock(&args.output, "phicam model")?;
    console.warn(&scene);
    let (phi, change, how) = match args.integration {
        Integration::Centres => {
            let phi = unknown.is_none().then(|| model.phi());
            (phi, None, "by centres".to_owned())
        }
        Integration::Quadrature => {
            // It integrates phi alone.
            let scene = scene.clone().known()?;
            let extent = Extent {
                occlusion,
                ..Extent::FULL
            };
            let what = format!("model of {}", scene.name);
            let integral = clocked(console, &what, || converged(&scene, kernel, extent))?;
            let how = format!("by quadrature, last refinement {:.1e}", integral.change);
            (Some(integral.phi), Some(integral.change), how)
        }
    };
    // Which scene the matrices are of: nothing else in the folder says so if nothing is rendered
    // into it.
    write_scene(&args.output, &scene)?;
    let of_verdict = [MODEL, SUMMARY].map(|name| args.output.join(name).exists()) == [true; 2];
    write(&args.output, &model, phi.as_ref(), None)?;
    Record::vouch_anew(&args.output, MODEL, is_of_model)?;
    let place = args.output.join(MODEL);
    if of_verdict {
        console.say(format!(
            "{}: in the place of the model that {SUMMARY} and {REPORT} tell of; `phicam run` makes it anew",
            place.display()
        ));
    }
    let product_error = model.product_error();
    let shape = |m: &Matrix| [m.nrows(), m.ncols()];
    let [g12, g23] = [&model.g12, &model.g23].map(shape);
    let shown = phi.as_ref().map(shape);
    let value = json!({
        "folder": place.to_string_lossy(),
        "kernel": kernel.name(),
        "g12": g12,
        "g23": g23,
        "phi": shown,
        "last_refinement": change,
        "terms": model.factors.as_ref().map(|f| f.terms.element.len()),
        "product_error": product_error,
    });
    output::result(args.json, &value, || {
        let size = |[rows, columns]: [usize; 2]| format!("{rows} × {columns}");
        let [g12, g23] = [g12, g23].map(size);
        let phi = match (shown, &unknown) {
            (Some(shown), _) => format!("phi.npy {}", size(shown)),
            (None, unknown) => format!(
                "no phi.npy: the albedo of {} is unknown",
                unknown.as_deref().unwrap_or("a surface")
            ),
        };
        let (place, kernel) = (place.display(), kernel.name());
        let past = product_error.map_or(String::new(), |error| {
            format!(
                "what stands in the way is left out by areas; C·diag(ρ)·D of one term an element is off by {error:.1e}\n"
            )
        });
        format!("{place}: g12.npy {g12}, g23.npy {g23}, {phi} ({kernel} kernel, {how})\n{past}")
    })?;
    Ok(Outcome::Done)
}

/// Writes DIR/model/g12.npy, g23.npy and, where it is known, phi.npy; and with the walls' BRDFs and
/// the scale of the light, entry by entry, laser_side.npy (D, W) and camera_side.npy (C): Φcam =
/// C·diag(ρ)·D. Then z.npy, the deviate of every traced entry from that model, where it is known.
pub(super) fn write(
    dir: &Path,
    model: &MatrixModel,
    phi: Option<&Matrix>,
    z: Option<&Matrix>,
) -> Result<(), Failure> {
    write_together(&dir.join(MODEL), |folder| {
        let matrices = [
            ("g12.npy", Some(&model.g12)),
            ("g23.npy", Some(&model.g23)),
            ("laser_side.npy", Some(&model.laser_side)),
            ("camera_side.npy", Some(&model.camera_side)),
            ("phi.npy", phi),
            // Deviations from another model are none from this one.
            (Z, z),
        ];
        let mut stale = Vec::new();
        for (name, matrix) in matrices {
            match matrix {
                Some(matrix) => npy::write(&folder.join(name), matrix)?,
                None => stale.push(name.to_owned()),
            }
        }
        Ok(stale)
    })
}
