//! The light of the spots themselves, which meets one surface.

use std::ops::Range;

use super::beam::Beams;
use super::spots::{LitPoints, LitSpots};
use super::vertex::{Oriented, Vertex};
use crate::geometry::Ray;
use crate::scene::Scene;

/// The light of the spots themselves, one surface met.
#[derive(Debug)]
pub(super) struct DirectLight {
    /// Spots with width that a pixel may see: column and index.
    wide: Vec<(usize, usize)>,
    /// Spots without width that a pixel sees: column, pixel, and flux per watt of laser power.
    ideal: Vec<(usize, usize, f64)>,
}

impl DirectLight {
    /// Of the spots of `range`, a column each.
    pub(super) fn new(beams: &Beams<'_>, range: &Range<usize>) -> Self {
        let (scene, columns) = (beams.scene, range.clone().enumerate());
        let ideal = |(column, spot): (usize, usize)| {
            let lit = beams.ideal.get(spot)?.as_ref()?;
            let (pixel, flux) = flux_of_lit_point(scene, lit)?;
            Some((column, pixel, flux))
        };
        let wide = |(_, spot): &(usize, usize)| beams.has_width() && beams.may_be_seen(*spot);
        Self {
            ideal: columns.clone().filter_map(ideal).collect(),
            wide: columns.filter(wide).collect(),
        }
    }

    /// Whether a pixel may see the spot of a column.
    pub(super) fn may_reach(&self, pixel: usize, column: usize) -> bool {
        let sees = |(lit, by, _): &(usize, usize, f64)| (*lit, *by) == (column, pixel);
        self.ideal.iter().any(sees) || self.wide.iter().any(|(lit, _)| *lit == column)
    }

    /// Adds to a pixel's row, for the columns of `lit`, the light of the spots that it sees through
    /// `samples` points of its footprint, `power` watts for each; `first` gives what it sees
    /// through one.
    pub(super) fn add(
        &self,
        spots: &LitSpots<'_>,
        pixel: usize,
        (samples, power): (usize, f64),
        first: impl Fn(usize) -> Option<Vertex>,
        lit: &LitPoints<'_>,
        row: &mut [f64],
    ) {
        let columns = &lit.columns;
        for (column, by, flux) in &self.ideal {
            if *by == pixel && columns.contains(column) {
                row[column - columns.start] += power * samples as f64 * flux;
            }
        }
        let in_columns = |(column, _): &&(usize, usize)| columns.contains(column);
        let wide: Vec<_> = self.wide.iter().filter(in_columns).collect();
        for k in (0..samples).filter(|_| !wide.is_empty()) {
            let first = first(k);
            for (column, spot) in &wide {
                let column = column - columns.start;
                let ends = (first.as_ref(), lit.at(k)[column].as_ref());
                row[column] += power * flux_of_wide_spot(spots, (*spot, pixel), ends);
            }
        }
    }
}

/// Flux of a wide spot into a pixel per watt of laser power, found in two ways that are weighted
/// against each other by their densities at the point found (the balance heuristic): where the line
/// of sight meets the spot, which finds the faintest tail, and from the beam, which finds a spot
/// however small.
fn flux_of_wide_spot(
    spots: &LitSpots<'_>,
    (spot, pixel): (usize, usize),
    (first, lit): (Option<&Vertex>, Option<&Vertex>),
) -> f64 {
    let (scene, beams) = (spots.scene, &spots.beams);
    let by_sight = first.map_or(0.0, |x| {
        let irradiance = beams.irradiance(spot, x.oriented(), x.shape);
        if irradiance <= 0.0 {
            return 0.0;
        }
        let seen = density(scene, x.oriented());
        let wi = (scene.laser.position - x.position).normalize_or_zero();
        x.throughput * x.brdf(scene, wi) * irradiance * seen / (seen + irradiance)
    });
    let by_beam = lit.and_then(|point| {
        // Which pixel it would be comes before the ray that says whether.
        let by = scene.camera.pixel_of(point.position);
        by.filter(|by| *by == pixel)?;
        let (_, flux) = flux_of_lit_point(scene, point)?;
        let irradiance = beams.irradiance(spot, point.oriented(), point.shape);
        let seen = density(scene, point.oriented());
        (irradiance > 0.0).then(|| flux * irradiance / (seen + irradiance))
    });
    by_sight + by_beam.unwrap_or(0.0)
}

/// The flux of a lit point itself into whichever pixel sees it, per watt of laser power: (pixel,
/// flux).
///
/// A point that scatters Φ has the radiant intensity Φ·f_r·cosθ; the aperture fills
/// A_lens·cosθ_cam/d² of solid angle.
fn flux_of_lit_point(scene: &Scene, lit: &Vertex) -> Option<(usize, f64)> {
    let camera = &scene.camera;
    let pixel = camera.pixel_of(lit.position)?;
    let ray = Ray::between(lit.position, camera.position)?;
    let cos_lit = lit.normal.dot(ray.direction);
    let cos_camera = camera.view.normal().dot(ray.direction);
    if cos_lit <= 0.0 || cos_camera <= 0.0 || scene.bvh().blocked(&ray, [Some(lit.shape), None]) {
        return None;
    }
    let solid_angle = camera.aperture_area * cos_camera / (ray.length * ray.length);
    let brdf = lit.constant_factor(scene) * lit.factor_to(scene, camera.position);
    Some((pixel, brdf * cos_lit * solid_angle))
}

/// Density, per unit area at x, of what a uniform point of a pixel's footprint makes the pinhole
/// see: 1/A_footprint · (cosθ_x/d_x²)·(d_view²/cosθ_view), x seen from its front.
fn density(scene: &Scene, x: Oriented) -> f64 {
    let camera = &scene.camera;
    let normal = camera.view.normal();
    let Some(line) = Ray::between(camera.position, x.0) else {
        return 0.0;
    };
    let (cos_x, cos_view) = (-x.1.dot(line.direction), -normal.dot(line.direction));
    if cos_x <= 0.0 || cos_view <= 0.0 {
        return 0.0;
    }
    let to_view = normal.dot(camera.position - camera.view.corner()) / cos_view;
    let footprint = camera.view.area() / camera.pixels() as f64;
    cos_x * to_view * to_view / (line.length * line.length * cos_view * footprint)
}
