//! `phicam model`: the matrices of the model.

use std::path::Path;

use serde_json::json;

use super::args::ModelArgs;
use super::failure::Failure;
use super::folder::Folder;
use super::output::{self, Talk};
use super::stale::remove_named;
use super::trust;
use super::{Outcome, settings};
use crate::matrix::{Matrix, npy};
use crate::model::{Extent, MatrixModel, converged};
use crate::store::ensure_writable;
use crate::study::Integration;

pub(super) fn execute(args: &ModelArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let kernel = settings::kernel(args.kernel);
    let mut model = MatrixModel::new(&scene, kernel, args.elements)?;
    if args.occlusion {
        if settings::integration(args.integration) == Integration::Quadrature {
            let cause = "--occlusion is asked at the middles of elements, pixels and spots only";
            return Err(Failure::new(cause, "leave --integration at centres"));
        }
        model = model.with_occlusion(&scene);
    }
    let folder = Folder {
        path: args.output.clone(),
    };
    folder.refuse_foreign(&scene)?;
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let (phi, change, how) = match settings::integration(args.integration) {
        Integration::Centres => (model.phi(), None, "by centres".to_owned()),
        Integration::Quadrature => {
            let integral = converged(&scene, kernel, Extent::FULL)?;
            let how = format!("by quadrature, last refinement {:.1e}", integral.change);
            (integral.phi, Some(integral.change), how)
        }
    };
    // Which scene the matrices are of: nothing else in the folder says so if nothing is rendered into it.
    folder.write_scene(&scene)?;
    write(&args.output, &model, &phi)?;
    if args.json {
        let shape = |m: &Matrix| [m.nrows(), m.ncols()];
        let text = output::json(&json!({
            "folder": args.output.join("model").to_string_lossy(),
            "kernel": kernel.name(),
            "g12": shape(&model.g12),
            "g23": shape(&model.g23),
            "phi": shape(&phi),
            "last_refinement": change,
        }))?;
        output::print(&text)?;
        return Ok(Outcome::Done);
    }
    let text = format!(
        "{}: g12.npy {} × {}, g23.npy {} × {}, phi.npy {} × {} ({} kernel, {how})\n",
        args.output.join("model").display(),
        model.g12.nrows(),
        model.g12.ncols(),
        model.g23.nrows(),
        model.g23.ncols(),
        phi.nrows(),
        phi.ncols(),
        kernel.name(),
    );
    output::print(&text)?;
    Ok(Outcome::Done)
}

/// Deviations of traced from modelled entries, in DIR/model.
pub(super) const Z: &str = "z.npy";

/// Writes DIR/model/z.npy, the deviate of every traced entry from the model that lies there.
pub(super) fn write_z(dir: &Path, z: &Matrix) -> Result<(), Failure> {
    Ok(npy::write(&dir.join("model").join(Z), z)?)
}

/// Writes DIR/model/g12.npy, g23.npy and phi.npy; and with the walls' BRDFs and the scale of the light, entry by entry, laser_side.npy (D, W) and
/// camera_side.npy (C): Φcam = C·diag(ρ)·D.
pub(super) fn write(dir: &Path, model: &MatrixModel, phi: &Matrix) -> Result<(), Failure> {
    let folder = dir.join("model");
    ensure_writable(&folder)?;
    // Deviations from another model are none from this one.
    remove_named(&folder, &[Z])?;
    for (name, matrix) in [
        ("g12.npy", &model.g12),
        ("g23.npy", &model.g23),
        ("laser_side.npy", &model.laser_side),
        ("camera_side.npy", &model.camera_side),
        ("phi.npy", phi),
    ] {
        npy::write(&folder.join(name), matrix)?;
    }
    Ok(())
}
