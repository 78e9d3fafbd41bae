//! All photographs of a set as Φcam.

use std::path::Path;

use super::account::{ImportAccount, Imported};
use super::columns::Columns;
use super::error::{PhotographError, refused};
use super::footprints::Evenness;
use super::left_out::LeftOut;
use super::list::{positions, tables};
use super::noise::PhotonTransferFit;
use super::placing::Placing;
use super::read::Reader;
use super::set::{ChannelName, Set};
use super::shots::Shots;
use super::takes::Take;
use crate::matrix::Matrix;
use crate::num::digits::figure;
use crate::scene::Scene;

/// Probability of the photon transfer line below which it is said not to fit.
const FITS: f64 = 1e-3;
/// How far from square the pixels of a view without marks may be.
const STRETCH: f64 = 0.02;

/// The scene with the spots whose positions the set lists, if it does.
///
/// # Errors
/// [`PhotographError`] for spots that are not on the wall.
pub fn scene_of(set: &Set, scene: Scene, folder: &Path) -> Result<Scene, PhotographError> {
    let mut reader = Reader::new(folder, None, None);
    let tables = tables(set, &mut reader, folder)?;
    Ok(match positions(&tables)? {
        Some(places) => scene.with_listed_spots(&places)?,
        None => scene,
    })
}

/// Φcam of `scene` ([`scene_of`]) from the photographs of `set` in `folder`, of one channel where
/// they are in colour. Files are read once, or twice where the noise is found from repeats; of all
/// photographs those of one file and the average of its spot are held at a time.
///
/// # Errors
/// [`PhotographError`].
pub fn import(
    set: &Set,
    scene: &Scene,
    folder: &Path,
    channel: Option<ChannelName>,
) -> Result<Imported, PhotographError> {
    if set.halo.is_some() && scene.laser.is_shining() {
        return Err(refused(
            "a halo about the laser's spot, and the scene has no laser: its hidden surface shines",
            "remove `halo`",
        ));
    }
    let mut reader = Reader::new(folder, set.variable.as_deref(), set.axes);
    let listed = tables(set, &mut reader, folder)?;
    let spots = scene.laser.spots.len();
    let shots = Shots::new(set, spots, folder, channel, &mut reader, &listed)?;
    let placing = Placing::new(set, &scene.camera, shots.size)?;
    let unit = unit(set.watts, &shots.takes)?;
    let given = set.camera_noise()?;
    let line = match given {
        Some(_) => None,
        None => shots.photon_transfer(&mut reader)?,
    };
    let noise = given.or(line.map(|l| l.noise));
    let columns = Columns::of(set, scene, (&shots, &placing), noise, &mut reader)?;
    let left_out = LeftOut::of(&columns.left_out);
    let mut warnings = unsaid(set, &placing);
    warnings.extend(little_left(&left_out));
    warnings.extend(no_light(&columns.phi));
    let view = &scene.camera.view;
    if placing.fitted.is_none() {
        let extent = set.crop.map(|c| [c.width, c.height]);
        let extent = extent.unwrap_or(shots.size.map(|n| n as f64));
        warnings.extend(stretched(extent, [view.u().length(), view.v().length()]));
    }
    warnings.extend(line.and_then(|line| bent(&line)));
    if noise.is_some_and(|n| n.has_offset) {
        warnings.push("without dark frames the repeats do not tell the read noise: the photon transfer line is over light with the camera's offset in it, and its value at 0 is σ² − g·offset; give `dark`".to_owned());
    }
    if noise.is_none() {
        warnings.push("the noise is not known (one photograph a spot, and no `noise`): there is no standard error; recover weighs all entries alike, or with --noise".to_owned());
    }
    if reader.is_lossy && set.gamma.is_none() && set.response.is_none() {
        warnings.push("JPEG is neither linear nor without loss: give `gamma` or `response`, or photographs that the camera saves as they are".to_owned());
    }
    if columns.zeros > 0.0 {
        let all = columns.photographs * shots.size[0] * shots.size[1];
        warnings.push(format!(
            "{:.2} % of the stored values are 0: what would be below is cut off, so that dark pixels are too bright on average; raise the camera's offset",
            100.0 * columns.zeros / all as f64
        ));
    }
    warnings.extend(
        columns
            .highest
            .clipped()
            .filter(|_| set.saturation.is_none()),
    );
    let Placing {
        fitted, mapping, ..
    } = placing;
    let account = ImportAccount {
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        set: set.clone(),
        channel,
        unit,
        photograph: shots.size,
        photographs: columns.photographs,
        noise,
        photon_transfer: line,
        mark_rms: fitted.as_ref().map(|f| f.rms),
        mark_error: fitted.as_ref().and_then(|f| f.mark_error),
        mark_residuals: fitted.map_or(Vec::new(), |f| f.residuals),
        gains: columns.gains,
        common: columns.common,
        of_flat: columns.of_flat,
        left_out,
        warnings,
        files: reader.sources(),
    };
    Ok(Imported {
        phi: columns.phi,
        stderr: noise.map(|_| columns.stderr),
        left_out: columns.left_out,
        mean: (columns.mean, shots.size),
        mapping,
        account,
    })
}

/// That most entries are left out, or all.
fn little_left(found: &LeftOut) -> Option<String> {
    let reasons = found.reasons().into_iter().filter(|(_, count)| *count > 0);
    let reasons: Vec<String> = reasons.map(|(why, n)| format!("{n} {why}")).collect();
    let nothing = if found.left_out == found.entries {
        ", so that nothing can be recovered"
    } else {
        ""
    };
    (2 * found.left_out > found.entries).then(|| {
        format!(
            "{} of {} entries are left out ({}){nothing}: check `saturation`, `full_scale`, `dead`, `flat`, `halo` and `crop`",
            found.left_out,
            found.entries,
            reasons.join(", ")
        )
    })
}

/// That the light adds up to nothing, but for rounding, or to less.
fn no_light(phi: &Matrix) -> Option<String> {
    let all: f64 = phi.iter().map(|x| x.abs()).sum();
    (phi.sum() <= 1e-9 * all).then(|| {
        "the light of all photographs adds up to nothing, or less: check the dark frames, and whether the response fits".to_owned()
    })
}

/// The unit of Φ.
fn unit(watts: Option<f64>, takes: &[Take]) -> Result<&'static str, PhotographError> {
    let timed = takes.iter().filter(|t| t.exposure.is_some()).count();
    if timed != 0 && timed != takes.len() {
        return Err(refused(
            "some photographs have an exposure time and others not",
            "give every one, or one `exposure` for all",
        ));
    }
    match (watts, timed) {
        (Some(_), 0) => Err(refused(
            "`watts` is for each count per second, and no exposure time is known",
            "give `exposure`, s",
        )),
        (Some(_), _) => Ok("W"),
        (None, 0) => Ok("counts"),
        (None, _) => Ok("counts/s"),
    }
}

/// What the settings leave unsaid.
fn unsaid(set: &Set, placing: &Placing) -> Vec<String> {
    let checked = placing
        .fitted
        .as_ref()
        .is_none_or(|f| f.mark_error.is_some());
    let even = placing.evenness == Evenness::Even && set.flat.is_none();
    let all = [
        (
            set.dark.is_none(),
            "no dark frames: the camera's offset and other light stay in every entry; give `dark`, or recover with --background",
        ),
        (
            set.flat.is_some() && set.flat_dark.is_none(),
            "the flat field has no dark frames of its own (`flat_dark`): its offset stays in it",
        ),
        (
            even,
            "neither a flat field nor a camera matrix says how the photograph falls off to its corners: it is taken as even",
        ),
        (
            !checked,
            "four marks leave nothing to check the mapping by; give more",
        ),
        (
            set.watts.is_none(),
            "no factor to watts is known (`watts`): fluxes have an arbitrary unit; recover with --free-scale",
        ),
    ];
    let said = all.into_iter().filter(|(holds, _)| *holds);
    said.map(|(_, words)| words.to_owned()).collect()
}

/// That a view of these sides fills a rectangle of `extent`, px, of another shape.
fn stretched([columns, rows]: [f64; 2], [u, v]: [f64; 2]) -> Option<String> {
    let ratio = (u / columns) / (v / rows);
    (libm::log(ratio).abs() > libm::log(1.0 + STRETCH)).then(|| {
        format!(
            "without marks the scene's view, {u} wide and {v} high, fills {columns} × {rows} px: its pixels are {} times as wide as high; if the camera's are square, mend camera.view or give `crop` or marks",
            figure(ratio, 3)
        )
    })
}

/// That the variance of repeats is no line.
fn bent(line: &PhotonTransferFit) -> Option<String> {
    let why = if line.noise.has_offset {
        "without dark frames it is not told why; give `dark`"
    } else {
        "the laser flickers, or the response is not linear"
    };
    (line.p < FITS).then(|| {
        format!(
            "the variance of repeated photographs is no line over their light (probability {:.1e}, off by up to {:.0} %): {why}; the standard errors are those of the line",
            line.p,
            100.0 * line.largest_deviation
        )
    })
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

    use super::*;

    /// Pixels of a view of 3 × 2 that fills 300 × 200 px are square, of 4 × 2 a third wider.
    #[test]
    fn a_stretched_view_is_told() {
        assert_eq!(stretched([300.0, 200.0], [3.0, 2.0]), None);
        let told = stretched([300.0, 200.0], [4.0, 2.0]).unwrap();
        assert!(told.contains("1.33 times as wide as high"), "{told}");
    }

    #[test]
    fn watts_need_seconds() {
        let take = |exposure| Take {
            path: "a".into(),
            spot: None,
            exposure,
            gain: 1.0,
            gain_error: 0.0,
        };
        let (timed, untimed) = (take(Some(0.5)), take(None));
        let error = unit(Some(2.0), from_ref(&untimed)).unwrap_err().to_string();
        assert!(
            error.contains("exposure") && error.contains("watts"),
            "{error}"
        );
        assert_eq!(unit(Some(2.0), from_ref(&timed)).unwrap(), "W");
        assert_eq!(unit(None, from_ref(&timed)).unwrap(), "counts/s");
        assert_eq!(unit(None, from_ref(&untimed)).unwrap(), "counts");
        assert!(unit(None, &[timed, untimed]).is_err());
    }
}
