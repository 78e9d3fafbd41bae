//! The light of the spots themselves, one surface met.

use std::ops::Range;

use super::beam::{Beams, LitPoint};
use super::eye::Sighting;
use super::lit::Lit;
use super::pinhole;
use super::walk::Vertex;
use crate::scene::Scene;

/// What the pixels see of a range of spots.
#[derive(Debug)]
pub(super) struct Direct<'a> {
    scene: &'a Scene,
    beams: &'a Beams<'a>,
    /// Spots with width that a pixel may see: column and index.
    wide: Vec<(usize, usize)>,
    /// Spots without width that a pixel sees: column, pixel and flux per watt of laser power.
    ideal: Vec<(usize, usize, f64)>,
}

impl<'a> Direct<'a> {
    pub(super) fn new(scene: &'a Scene, beams: &'a Beams<'a>, spots: Range<usize>) -> Self {
        let seen = spots
            .enumerate()
            .filter(|(_, spot)| beams.may_be_seen(*spot));
        let mut found = Self {
            scene,
            beams,
            wide: Vec::new(),
            ideal: Vec::new(),
        };
        if beams.has_width() {
            found.wide = seen.collect();
        } else {
            let point = |(column, spot)| {
                let (pixel, flux) = pinhole::direct(scene, &beams.point_in_view(spot)?)?;
                Some((column, pixel, flux))
            };
            found.ideal = seen.filter_map(point).collect();
        }
        found
    }

    /// Adds a pixel's row for the columns of `lit`: the mean over places in its footprint and, where they have width, in the beams, each place counting `share`.
    pub(super) fn add(
        &self,
        sighting: &Sighting,
        places: &[[f64; 2]],
        lit: &Lit<'_>,
        share: f64,
        row: &mut [f64],
    ) {
        let columns = &lit.columns;
        let power = self.scene.laser.power;
        for &(column, pixel, flux) in &self.ideal {
            if pixel == sighting.pixel() && columns.contains(&column) {
                row[column - columns.start] += power * share * places.len() as f64 * flux;
            }
        }
        let wide = || {
            self.wide
                .iter()
                .filter(|(column, _)| columns.contains(column))
        };
        if wide().next().is_none() {
            return;
        }
        for (k, place) in places.iter().enumerate() {
            let first = sighting.vertex(self.scene, *place);
            for &(column, spot) in wide() {
                let column = column - columns.start;
                let lit = lit.at(k)[column].as_ref();
                let flux = direct(
                    self.scene,
                    self.beams,
                    (spot, sighting.pixel()),
                    first.as_ref(),
                    lit,
                );
                row[column] += power * share * flux;
            }
        }
    }
}

/// Light of the spot itself, one surface met, per watt of power. A spot without width is a point. A wide one is found in two
/// ways, weighted against each other by their densities at the point found (the balance heuristic): where the line of
/// sight meets it, which finds the faintest tail, and from the beam, which finds a spot however small.
pub(super) fn direct(
    scene: &Scene,
    beams: &Beams<'_>,
    (spot, pixel): (usize, usize),
    first: Option<&Vertex>,
    lit: Option<&LitPoint>,
) -> f64 {
    if !beams.has_width() {
        let point = beams.point_in_view(spot);
        let seen = point.and_then(|point| pinhole::direct(scene, &point));
        return seen
            .filter(|(by, _)| *by == pixel)
            .map_or(0.0, |(_, flux)| flux);
    }
    let by_sight = first.map_or(0.0, |x| {
        let at = (x.position, x.normal);
        let irradiance = beams.irradiance(spot, at, x.shape);
        if irradiance <= 0.0 {
            return 0.0;
        }
        let seen = pinhole::density(scene, at);
        let to_laser = (scene.laser.position - x.position).normalize_or_zero();
        x.throughput * x.brdf(scene, to_laser) * irradiance * seen / (seen + irradiance)
    });
    let by_beam = lit.and_then(|point| {
        // Which pixel it would be comes before the ray that says whether.
        scene
            .camera
            .pixel_of(point.position)
            .filter(|p| *p == pixel)?;
        let (by, flux) = pinhole::direct(scene, point)?;
        let at = (point.position, point.normal);
        let irradiance = beams.irradiance(spot, at, point.shape);
        let seen = pinhole::density(scene, at);
        (by == pixel && irradiance > 0.0).then(|| flux * irradiance / (seen + irradiance))
    });
    by_sight + by_beam.unwrap_or(0.0)
}
