//! The files of a recovery.

use std::path::Path;
use std::sync::atomic::Ordering;

use serde_json::json;

use crate::cli::Outcome;
use crate::cli::cleanup::remove_abandoned;
use crate::cli::console::{Console, complain};
use crate::cli::failure::Failure;
use crate::cli::interrupt::{StepGuard, stop_flag};
use crate::cli::{output, progress};
use crate::folder::names::{ESTIMATED, UNCERTAINTIES};
use crate::lab::finding::Describe;
use crate::lab::{Attempt, Beside, RecoveredObject, Work, describe_recovery};
use crate::matrix::{Matrix, npy};
use crate::recovery::{Method, Picard, RecoveryError};
use crate::report::{self, Panel};
use crate::scene::{Division, Scene};
use crate::store::write_together;
use crate::transport::Control;

/// The objects that were recovered. A method that cannot work is reported, one of those `named` in
/// the arguments even where no remarks are wanted; if none can, or the only one asked for, that is
/// the command's failure.
pub(super) fn collect(
    attempts: Vec<Attempt>,
    named: &[Method],
    console: Console,
) -> Result<Vec<RecoveredObject>, Failure> {
    let strict = attempts.len() == 1;
    let mut objects = Vec::new();
    let mut reasons = Vec::new();
    for attempt in attempts {
        match attempt.outcome {
            Ok(found) => objects.extend(found),
            Err(e @ RecoveryError::Stopped(_)) if objects.is_empty() => {
                let kept = format!("{} was not finished: nothing is written", attempt.method);
                return Err(Failure::from(e).if_stopped(kept));
            }
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
        if named.is_empty() {
            console.say(reason);
        } else {
            complain(&format!("warning: {reason}"));
        }
    }
    Ok(objects)
}

/// Recovers by `methods` under a bar. At Ctrl-C the step at hand is finished, so that the methods
/// that are done are not lost.
pub(super) fn recovering<T>(
    console: Console,
    what: &str,
    methods: &[Method],
    act: impl FnOnce(Control<'_>) -> T,
) -> T {
    let _guard = StepGuard::new();
    let work = Work::Methods(methods.len() as u64);
    progress::run(console, what, work, act)
}

/// Prints the objects; the exit code is that of photographs which no picture explains, of a
/// recovery that was stopped, or 0.
pub(super) fn tell(objects: &[RecoveredObject], json: bool) -> Result<Outcome, Failure> {
    output::result(json, &objects, || {
        report::finding_text(&describe_recovery(objects))
    })?;
    if stop_flag().load(Ordering::Relaxed) {
        let kept = "what was found until then is written";
        return Err(Failure::Stopped(kept.to_owned()));
    }
    if objects.iter().any(RecoveredObject::contradicted) {
        return Ok(Outcome::Disagreed);
    }
    Ok(Outcome::Done)
}

/// Writes into `folder` METHOD.npy (nv × nu) and METHOD.png, truth.npy and truth.png where it is
/// known, what the photographs determine of each element in determined.npy and determined.png, and
/// overview.png with all of them side by side (no pictures of elements that are the triangles of a
/// mesh); METHOD.texture.png, the reflectance as a texture for a scene, and METHOD.ply, the surface
/// with it as colours; what is known of the uncertainty in METHOD.stderr.npy (nv × nu, inf where
/// the photographs do not determine an element), METHOD.light.npy (nv × nu, probability to be
/// light), METHOD.alike.npy and METHOD.alike.stderr.npy (nv × nu, the mean where neighbours may be
/// alike), METHOD.covariance.npy and METHOD.resolution.npy (own elements × elements of all
/// surfaces), METHOD.bias.npy (nv × nu), METHOD.lower.npy and METHOD.upper.npy where bands were
/// asked for; what was chosen and found
/// beside it in METHOD.choice.json, METHOD.frame_constant.npy and METHOD.glare.npy (1 × spots),
/// METHOD.frame_gain.npy (2 × spots: ε, its standard errors) and METHOD.background.npy (pixels ×
/// 1); NAME.csv and NAME.svg of each of `picards`, and no others. Where several surfaces are hidden
/// the names are METHOD-0, METHOD-1, … in file order.
pub(super) fn write(
    folder: &Path,
    scene: Option<&Scene>,
    objects: &[RecoveredObject],
    picards: &[Picard],
) -> Result<(), Failure> {
    remove_abandoned(folder)?;
    write_together(folder, |staged| fill(staged, scene, objects, picards))
}

/// Writes into `folder` what [`write`] does; returns the names of the files that an earlier
/// recovery may have left and this one has not.
fn fill(
    folder: &Path,
    scene: Option<&Scene>,
    objects: &[RecoveredObject],
    picards: &[Picard],
) -> Result<Vec<String>, Failure> {
    let mut stale = ["picard-joint.csv", "picard-joint.svg"]
        .map(str::to_owned)
        .to_vec();
    for picard in picards {
        for (name, text) in report::finding_files(&picard.describe()) {
            stale.retain(|old| *old != name);
            output::write(&folder.join(name), text)?;
        }
    }
    let mut surfaces: Vec<&str> = Vec::new();
    for object in objects {
        if !surfaces.contains(&object.surface.as_str()) {
            surfaces.push(&object.surface);
        }
    }
    for (i, surface) in surfaces.iter().enumerate() {
        let suffix = of_surface([i, surfaces.len()]);
        let named = |name: &str, what: &str| format!("{name}{suffix}.{what}");
        let file = |name: &str, what: &str| folder.join(named(name, what));
        let mut surfaces = scene.iter().flat_map(|scene| &scene.surfaces);
        let shape = surfaces.find(|s| s.name == **surface);
        let drawn = shape.is_none_or(|s| s.division == Division::Cells);
        let mut panels = Vec::new();
        let known = objects.iter().find(|o| o.surface == *surface);
        let shares = known.and_then(|o| o.determined_share.as_ref());
        if shares.is_none() {
            stale.extend(["npy", "png"].map(|what| named("determined", what)));
        }
        if known.is_some_and(|o| o.truth.is_none()) {
            stale.extend(["npy", "png"].map(|what| named("truth", what)));
        }
        for object in objects.iter().filter(|o| o.surface == *surface) {
            let [nu, nv] = object.elements;
            let method = object.method.as_str();
            let first = known.is_some_and(|known| std::ptr::eq(known, object));
            let truth = object.truth.as_ref().filter(|_| first);
            let truth = truth.map(|t| ("truth", t));
            let shares = shares.filter(|_| first).map(|s| ("determined", s));
            let own = [(method, &object.reflectance)];
            for (name, values) in truth.into_iter().chain(shares).chain(own) {
                npy::write(&file(name, "npy"), &Matrix::from_row_slice(nv, nu, values))?;
                if drawn {
                    let panel = Panel::elements(name, object.elements, values.clone());
                    let png = report::grey_png(surface, std::slice::from_ref(&panel))?;
                    output::write(&file(name, "png"), png)?;
                    panels.push(panel);
                }
            }
            let told = object.beside_it().into_iter().filter(|_| drawn);
            panels.extend(told.map(|(what, values)| {
                let name = format!("{method}, {what}");
                Panel::elements(&name, object.elements, values.clone())
            }));
            if let (Some(shape), Some(scene)) = (shape, scene) {
                let (elements, values) = (object.elements, &object.reflectance);
                if drawn {
                    let png = report::texture_png(elements, values)?;
                    output::write(&file(method, "texture.png"), png)?;
                }
                let ply = report::recovered_ply(shape, elements, values, &scene.to_file());
                output::write(&file(method, "ply"), ply)?;
            }
            let choice = json!({
                "method": method,
                "choice": object.choice,
                "solver": object.solver,
                "estimated": object.estimated,
            });
            output::write(&file(method, "choice.json"), output::json(&choice)?)?;
            let uncertainties = UNCERTAINTIES.into_iter().zip(uncertainties(object));
            for (what, matrix) in uncertainties.chain(ESTIMATED.into_iter().zip(estimated(object)))
            {
                let name = named(method, &format!("{what}.npy"));
                match matrix {
                    Some(matrix) => npy::write(&folder.join(name), &matrix)?,
                    None => stale.push(name),
                }
            }
        }
        if drawn {
            let png = report::grey_png(surface, &panels)?;
            output::write(&file("overview", "png"), png)?;
        }
    }
    Ok(stale)
}

/// What a name of a file has behind that of its method: the number of the surface, where there are
/// several.
pub(super) fn of_surface([number, count]: [usize; 2]) -> String {
    if count > 1 {
        format!("-{number}")
    } else {
        String::new()
    }
}

/// What is known of the uncertainty of `object`, in the order of [`UNCERTAINTIES`].
fn uncertainties(object: &RecoveredObject) -> [Option<Matrix>; UNCERTAINTIES.len()] {
    let [nu, nv] = object.elements;
    let picture = |values: &Vec<f64>| Matrix::from_row_slice(nv, nu, values);
    let (bands, alike) = (object.bands.as_ref(), object.alike.as_ref());
    [
        object.standard_error.as_ref().map(picture),
        object.light.as_ref().map(picture),
        alike.map(|[mean, _]| picture(mean)),
        alike.map(|[_, error]| picture(error)),
        object.bias.as_ref().map(picture),
        bands.map(|b| picture(&b.lower)),
        bands.map(|b| picture(&b.upper)),
        object.covariance.clone(),
        object.resolution.clone(),
    ]
}

/// What was estimated beside the reflectances of `object`, in the order of [`ESTIMATED`]: b, f and
/// g of a frame as a row, a of a pixel as a column, as they add to Φcam; ε_l of a frame, whose
/// light has the factor 1 + ε_l, above its standard error.
fn estimated(object: &RecoveredObject) -> [Option<Matrix>; ESTIMATED.len()] {
    let found = object.estimated.as_ref();
    let of = |values: fn(&Beside) -> &Option<Vec<f64>>| found.and_then(|b| values(b).as_deref());
    let row = |v: &[f64]| Matrix::from_row_slice(1, v.len(), v);
    let rows = |v: &Vec<Vec<f64>>| Matrix::from_fn(v.len(), v[0].len(), |k, l| v[k][l]);
    let patterns = found.and_then(|b| b.frame_patterns.as_ref());
    let patterns = patterns.filter(|v| !v.is_empty()).map(rows);
    let column = |v: &[f64]| Matrix::from_row_slice(v.len(), 1, v);
    let gains = found.and_then(|b| b.gains.as_ref()?.frames.as_ref());
    let gains =
        gains.map(|g| Matrix::from_fn(2, g.size.len(), |k, l| [&g.size, &g.standard_error][k][l]));
    [
        of(|b| &b.frame_constant).map(row),
        patterns,
        of(|b| &b.background).map(column),
        of(|b| &b.glare).map(row),
        gains,
    ]
}
