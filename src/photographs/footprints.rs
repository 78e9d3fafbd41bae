//! From the pixels of a photograph to those of the scene's camera.
//!
//! A pixel q of the photograph collects y_q = κ·∫_q L(x)·e′ du counts: L the radiance of the wall,
//! e′ the étendue of the photograph's camera for each area u of the picture. The scene's camera
//! collects Φ_p = ∫_p L(x)·e dA over its footprint on the wall, with e = A_lens·h²/r⁴ the étendue
//! for each area of the wall, h and r the camera's distances from the wall's plane and from x. With
//! L·e′ linear within q, its slope that between the pixels beside q,
//!
//! > Φ_p = (1/κ)·Σ_q a_pq·(y_q + ∇y_q·(x_pq − x_q))·ρ_pq,   ρ = e·|∂A/∂u|/e′
//!
//! a_pq the fraction of q's area that lies in the footprint of p, seen in the photograph, x_pq its
//! centroid, x_q the middle of q, and ρ the ratio of the étendues at x_pq. A photograph without
//! marks is that of the scene's own camera: ρ = 1, and Φ is a sum of pixels.
//!
//! With a camera matrix ρ is absolute. A pixel has e′ = A′·η/(fx·fy), A′ the area of the lens and η
//! [`Lens::etendue`](super::Lens::etendue), or 1 after a flat field that is 1 on the axis. The
//! scene's opening, parallel to the wall, is A_lens = A′/cosθ, θ between the axis and the wall's
//! normal: on the axis both collect the same. So ρ = fx·fy·h²·|∂A/∂u|/(r⁴·η·cosθ), which is 1 on
//! the axis of a camera that stands where the scene's does.
//!
//! Without one e′ is taken as even, and ρ is known up to a factor, such that of a wall of even
//! radiance the sum of Φ is that of the photograph's pixels in the view: Σ a·ρ = Σ a.
//!
//! The footprint is a polygon in the photograph, cut exactly at the borders of pixels. With a lens
//! each of its edges is drawn by eight chords: an edge of n pixels whose curve leaves the chord by
//! k·n² px is then off by k·n²/64 px, which is 1e-3 of a pixel for the strongest lenses and n = 10.
//! Pixels of the photograph are independent; those at a border of footprints belong to two, which
//! then share their noise ([`Footprints::shared`]).

mod polygon;

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::error::{PhotographError, refused};
use super::mapping::Mapping;
use crate::num::digits::figure;
use crate::scene::Camera;
use polygon::{area_and_centroid, between};

/// Chords of an edge with a lens.
const CHORDS: usize = 8;
/// Part of a footprint that may lie outside the photograph by rounding.
const OUTSIDE: f64 = 1e-6;
/// Distance from the middle of a pixel, px, below which it is rounding.
const MIDDLE: f64 = 1e-9;
/// Fewest pixels of the photograph in a footprint, on average, and how many are to be aimed at.
const COARSEST: f64 = 1.0;
const FINE: f64 = 4.0;

/// How the étendue of the photograph's camera goes with the place in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evenness {
    /// The photograph is that of the scene's own camera: fluxes are added up.
    Same,
    /// It is even: of a flat-fielded photograph, or where nothing is known.
    Even,
    /// It falls to the corners as the camera matrix says.
    ByLens,
}

/// What each pixel of the scene's camera takes from the photograph: Φ_p = Σ weight·y.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprints {
    /// For each pixel of the scene, the pixels of the photograph with their weights, in order; none
    /// where the footprint is not wholly in the photograph.
    rows: Vec<Vec<(u32, f64)>>,
}

impl Footprints {
    /// Those of `camera` in a photograph of `size` (columns, rows) under `mapping`.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] where no footprint lies in the photograph, or the photograph
    /// has fewer pixels than the scene's camera.
    pub fn new(
        camera: &Camera,
        mapping: &Mapping,
        size: [usize; 2],
        evenness: Evenness,
    ) -> Result<Self, PhotographError> {
        let row = |pixel: usize| row(camera, mapping, size, evenness, pixel);
        let rows: Vec<Pieces> = (0..camera.pixels()).into_par_iter().map(row).collect();
        let pieces = || rows.iter().flatten();
        let area: f64 = pieces().map(|p| p.fraction * p.own).sum();
        let weighed: f64 = pieces().map(|p| p.fraction * p.own * p.ratio).sum();
        if area <= 0.0 || weighed <= 0.0 {
            return Err(refused(
                format!(
                    "no pixel of the scene's view lies in the photograph of {} × {} pixels",
                    size[0], size[1]
                ),
                "check the marks or the crop, and which of their axes is which",
            ));
        }
        let whole: f64 = pieces().map(|p| p.fraction).sum();
        let seen = rows.iter().filter(|row| !row.is_empty()).count();
        let each = whole / seen as f64;
        if each < COARSEST * (1.0 - OUTSIDE) {
            let fewer = (each / FINE).sqrt();
            let [columns, rows] =
                [camera.columns, camera.rows].map(|n| (n as f64 * fewer).floor().max(1.0));
            return Err(refused(
                format!(
                    "the photograph has {} pixels for each of the scene's, which would share them",
                    figure(each, 2)
                ),
                format!(
                    "give the scene fewer, as `camera.pixels = [{columns}, {rows}]`, or finer photographs"
                ),
            ));
        }
        let unit = match evenness {
            Evenness::Same => 1.0,
            _ => absolute(camera, mapping).unwrap_or(area / weighed),
        };
        let weights = |pieces: &Pieces| weights(pieces, size, unit);
        let rows = rows.iter().map(weights).collect();
        Ok(Self { rows })
    }

    /// How many times as large the error of the sum of all footprints is as if each had pixels of
    /// the photograph of its own: √(Σ_q (Σ_p w_pq)²/Σ_pq w_pq²).
    pub fn shared(&self) -> f64 {
        let all = || self.rows.iter().flatten();
        let last = all().map(|(q, _)| *q as usize).max();
        let mut together = vec![0.0; last.map_or(0, |last| last + 1)];
        let mut apart = 0.0;
        for (q, weight) in all() {
            together[*q as usize] += weight;
            apart += weight * weight;
        }
        (together.iter().map(|w| w * w).sum::<f64>() / apart).sqrt()
    }

    /// The photograph's pixels with their weights for a pixel of the scene; empty where its
    /// footprint is not wholly in the photograph.
    pub fn of(&self, pixel: usize) -> &[(u32, f64)] {
        &self.rows[pixel]
    }

    /// Whether the footprint of `pixel` is not wholly in the photograph.
    pub fn is_outside(&self, pixel: usize) -> bool {
        self.rows[pixel].is_empty()
    }

    /// Σ weight·values for each pixel of the scene.
    pub fn gathered(&self, values: &[f64]) -> Vec<f64> {
        let sum = |row: &Vec<(u32, f64)>| row.iter().map(|(q, w)| w * values[*q as usize]).sum();
        self.rows.par_iter().map(sum).collect()
    }

    /// Σ weight²·variances for each pixel of the scene.
    pub fn gathered_variance(&self, variances: &[f64]) -> Vec<f64> {
        let sum = |row: &Vec<(u32, f64)>| {
            row.iter()
                .map(|(q, w)| w * w * variances[*q as usize])
                .sum()
        };
        self.rows.par_iter().map(sum).collect()
    }

    /// Whether one of the photograph's pixels that `marked` names is in the footprint.
    pub fn touches(&self, pixel: usize, marked: &[bool]) -> bool {
        self.rows[pixel].iter().any(|(q, _)| marked[*q as usize])
    }
}

/// What a footprint has of one pixel of the photograph.
struct Piece {
    pixel: [usize; 2],
    /// Centroid of it, from the middle of the pixel, px.
    off: [f64; 2],
    /// Of the photograph's pixel.
    fraction: f64,
    /// ρ up to a factor.
    ratio: f64,
    /// e′ up to a factor.
    own: f64,
}

type Pieces = Vec<Piece>;

/// The weights of the photograph's pixels in a footprint: fraction times ρ of each, and those that
/// make its slope of the pixels beside it, or of itself at the border of the photograph.
fn weights(pieces: &Pieces, size: [usize; 2], unit: f64) -> Vec<(u32, f64)> {
    let mut all = BTreeMap::<u32, f64>::new();
    let mut add = |[u, v]: [usize; 2], weight: f64| {
        *all.entry((u + v * size[0]) as u32).or_default() += weight;
    };
    for piece in pieces {
        let weight = piece.fraction * piece.ratio * unit;
        add(piece.pixel, weight);
        for axis in 0..2 {
            if piece.off[axis].abs() < MIDDLE {
                continue;
            }
            let at = piece.pixel[axis];
            let [low, high] = [at.saturating_sub(1), (at + 1).min(size[axis] - 1)];
            let slope = weight * piece.off[axis] / (high - low).max(1) as f64;
            for (to, sign) in [(high, 1.0), (low, -1.0)] {
                let mut beside = piece.pixel;
                beside[axis] = to;
                add(beside, sign * slope);
            }
        }
    }
    all.into_iter().collect()
}

/// The pieces of the footprint of `pixel`.
fn row(
    camera: &Camera,
    mapping: &Mapping,
    [width, height]: [usize; 2],
    evenness: Evenness,
    pixel: usize,
) -> Pieces {
    let Some(polygon) = outline(camera, mapping, pixel) else {
        return Vec::new();
    };
    let whole = area_and_centroid(&polygon).0;
    let bounds = |k: usize, most: usize| {
        let low = polygon.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let high = polygon
            .iter()
            .map(|p| p[k])
            .fold(f64::NEG_INFINITY, f64::max);
        let first = (low + 0.5).floor().clamp(0.0, most as f64) as usize;
        let end = (high + 0.5).ceil().clamp(0.0, most as f64) as usize;
        first..end
    };
    let mut pieces = Vec::new();
    let mut covered = 0.0;
    for v in bounds(1, height) {
        let middle = v as f64;
        let strip = between(&polygon, 1, [middle - 0.5, middle + 0.5]);
        if strip.is_empty() {
            continue;
        }
        for u in bounds(0, width) {
            let centre = u as f64;
            let part = between(&strip, 0, [centre - 0.5, centre + 0.5]);
            let (fraction, centroid) = area_and_centroid(&part);
            if fraction <= 0.0 {
                continue;
            }
            covered += fraction;
            let Some([ratio, own]) = ratio(camera, mapping, evenness, centroid) else {
                return Vec::new();
            };
            pieces.push(Piece {
                pixel: [u, v],
                off: [centroid[0] - centre, centroid[1] - middle],
                fraction,
                ratio,
                own,
            });
        }
    }
    if covered < whole * (1.0 - OUTSIDE) {
        pieces.clear();
    }
    pieces
}

/// The footprint of a scene's pixel in the photograph; `None` where it has none.
fn outline(camera: &Camera, mapping: &Mapping, pixel: usize) -> Option<Vec<[f64; 2]>> {
    let chords = mapping.lens().map_or(1, |_| CHORDS);
    let [column, row] = [pixel % camera.columns, pixel / camera.columns].map(|n| n as f64);
    let count = [camera.columns, camera.rows].map(|n| n as f64);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut polygon = Vec::with_capacity(4 * chords);
    for side in 0..4 {
        let (from, to): ([f64; 2], [f64; 2]) = (corners[side], corners[(side + 1) % 4]);
        for k in 0..chords {
            let t = k as f64 / chords as f64;
            let [x, y] = [0, 1].map(|i| from[i] + t * (to[i] - from[i]));
            polygon.push(mapping.pixel([(column + x) / count[0], (row + y) / count[1]])?);
        }
    }
    Some(polygon)
}

/// ρ and e′, each up to a factor, at a place of the photograph.
fn ratio(camera: &Camera, mapping: &Mapping, evenness: Evenness, at: [f64; 2]) -> Option<[f64; 2]> {
    let own = match evenness {
        Evenness::Same => return Some([1.0; 2]),
        Evenness::Even => 1.0,
        Evenness::ByLens => mapping.lens()?.etendue(at)?,
    };
    let ([a, b], area) = mapping.wall(at)?;
    let view = &camera.view;
    let point = view.corner() + view.u() * a + view.v() * b;
    let r2 = (point - camera.position).length_squared();
    // h² is the same for all pixels.
    Some([area / (r2 * r2) / own, own])
}

/// What makes ρ absolute, with the area of the view for view coordinates; `None` without a camera
/// matrix, or where the axis never meets the wall.
fn absolute(camera: &Camera, mapping: &Mapping) -> Option<f64> {
    let (lens, pose) = (mapping.lens()?, mapping.pose()?);
    let view = &camera.view;
    let height = view.normal().dot(camera.position - view.corner());
    let area = view.u().cross(view.v()).length();
    (pose.cosine > 0.0).then(|| lens.fx * lens.fy * height * height * area / pose.cosine)
}

#[cfg(test)]
mod tests;
