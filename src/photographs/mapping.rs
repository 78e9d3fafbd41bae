//! Where a point of the wall stands in the photograph.
//!
//! A pinhole maps a plane by a homography: with view coordinates (a, b) of the scene, each from 0
//! to 1 across its view, (u, v) = (w₁/w₃, w₂/w₃), w = H·(a, b, 1)ᵀ. Then the lens distorts. Pixels
//! are OpenCV's: (0, 0) is the centre of the first, u runs to the right and v down.

mod normalised;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use normalised::{Frame, times};

use super::error::{PhotographError, refused};
use super::lens::Lens;
use crate::geometry::DVec3;
use crate::num::linalg::{Tolerance, least_squares, svd};

/// A marked point of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mark {
    /// Where it was found in the photograph, (u, v), px.
    pub pixel: [f64; 2],
    /// Where it is on the wall, in view coordinates.
    pub wall: [f64; 2],
}

/// From the wall to the photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    /// Rows of H.
    h: [[f64; 3]; 3],
    lens: Option<Lens>,
}

/// How a camera of known matrix looks at the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    /// cos θ between its axis and the wall's normal; 0 or less where the axis never meets the wall.
    pub cosine: f64,
    /// Distance from the wall's plane, for a view of unit area.
    pub height: f64,
}

/// A mapping with what its marks say of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The mapping.
    pub mapping: Mapping,
    /// Distance of each mark from where the mapping has it, px.
    pub residuals: Vec<f64>,
    /// Their root mean square, px.
    pub rms: f64,
    /// Error of a mark along each axis that explains them, px: √(Σd²/(2n − 8)); none of four marks.
    pub mark_error: Option<f64>,
}

/// A mark without which the others lie nearest to a mapping of theirs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OddMark {
    /// Its number among the marks, from 0.
    pub at: usize,
    /// How far from it the others' mapping has it, px.
    pub off: f64,
    /// The error of the others, as [`Fitted::mark_error`].
    pub others: f64,
}

/// Fewest marks.
const FEWEST: usize = 4;
/// Relative size of the eighth singular value of the marks' equations below which they determine no
/// mapping: three of four on one line.
const DEGENERATE: f64 = 1e-4;
/// Steps of Gauss–Newton.
const STEPS: usize = 100;

impl Mapping {
    /// The scene's view is an upright rectangle of the photograph: its left and upper border and
    /// its extent, px, counted from the photograph's border.
    pub fn upright([left, top]: [f64; 2], [width, height]: [f64; 2]) -> Self {
        let h = [
            [width, 0.0, left - 0.5],
            [0.0, -height, top + height - 0.5],
            [0.0, 0.0, 1.0],
        ];
        Self { h, lens: None }
    }

    /// The mapping of the least squared distance of the marks, in the photograph: a direct linear
    /// transform in normalised coordinates (Hartley, *IEEE TPAMI* 19, 1997) after undistortion,
    /// then Gauss–Newton steps on the distances of the distorted marks.
    ///
    /// # Errors
    /// [`PhotographError`] for fewer than four marks, marks that determine no mapping, and a lens
    /// that cannot be undistorted at one of them.
    pub fn from_marks(marks: &[Mark], lens: Option<Lens>) -> Result<Fitted, PhotographError> {
        if marks.len() < FEWEST {
            return Err(refused(
                format!("{} marks determine no mapping of the wall", marks.len()),
                "give four or more, no three of them on one line",
            ));
        }
        let mut flat = Vec::with_capacity(marks.len());
        for mark in marks {
            flat.push(match &lens {
                None => mark.pixel,
                Some(lens) => {
                    let at = lens.undistorted(lens.normalised(mark.pixel));
                    lens.pixel(at.ok_or_else(|| folded(mark.pixel))?)
                }
            });
        }
        let walls: Vec<[f64; 2]> = marks.iter().map(|m| m.wall).collect();
        let (near, far) = (Frame::of(&walls), Frame::of(&flat));
        let start = direct(&walls, &flat, near, far)?;
        let found = refined(start, marks, lens, near, far)?;
        let residuals: Vec<f64> = marks.iter().map(|mark| found.off(mark)).collect();
        let sum: f64 = residuals.iter().map(|d| d * d).sum();
        if !sum.is_finite() {
            return Err(degenerate());
        }
        let n = marks.len() as f64;
        Ok(Fitted {
            mapping: found,
            rms: (sum / n).sqrt(),
            mark_error: (marks.len() > FEWEST).then(|| (sum / (2.0 * n - 8.0)).sqrt()),
            residuals,
        })
    }

    /// The odd one of marks: least squares draws the mapping to a mark that is far off, so that
    /// others lie further from it. None of five and fewer, and where no four of the others
    /// determine a mapping: without any one of five, four fit exactly.
    pub(super) fn odd_mark(marks: &[Mark], lens: Option<Lens>) -> Option<OddMark> {
        let without = |at: usize| {
            let mut others = marks.to_vec();
            let mark = others.remove(at);
            let fitted = Self::from_marks(&others, lens).ok()?;
            Some(OddMark {
                at,
                off: fitted.mapping.off(&mark),
                others: fitted.mark_error?,
            })
        };
        let each = (0..marks.len()).filter_map(without);
        each.min_by(|a, b| a.others.total_cmp(&b.others))
    }

    /// How far from a mark the mapping has it, px; infinite where it has no pixel.
    fn off(&self, mark: &Mark) -> f64 {
        let at = self.pixel(mark.wall).unwrap_or([f64::INFINITY; 2]);
        libm::hypot(at[0] - mark.pixel[0], at[1] - mark.pixel[1])
    }

    /// H·(a, b, 1)ᵀ.
    fn homogeneous(&self, [a, b]: [f64; 2]) -> [f64; 3] {
        self.h.map(|row| row[0] * a + row[1] * b + row[2])
    }

    /// The pixel of a point of the wall; `None` behind the camera, or where the lens folds over.
    pub fn pixel(&self, wall: [f64; 2]) -> Option<[f64; 2]> {
        let [u, v, w] = self.homogeneous(wall);
        if w <= 0.0 || !w.is_finite() {
            return None;
        }
        let flat = [u / w, v / w];
        let Some(lens) = &self.lens else {
            return Some(flat);
        };
        let (to, [p, q, r, s]) = lens.distorted(lens.normalised(flat));
        (p * s - q * r > 0.0).then(|| lens.pixel(to))
    }

    /// The point of the wall at a pixel, and the area of the wall (in view coordinates) for each
    /// area of the photograph there; `None` where the lens folds over, or above the horizon.
    pub fn wall(&self, pixel: [f64; 2]) -> Option<([f64; 2], f64)> {
        let (flat, straightened) = match &self.lens {
            None => (pixel, 1.0),
            Some(lens) => {
                let at = lens.undistorted(lens.normalised(pixel))?;
                let (_, [p, q, r, s]) = lens.distorted(at);
                (lens.pixel(at), 1.0 / (p * s - q * r))
            }
        };
        let [[h0, h1, h2], [h3, h4, h5], [h6, h7, h8]] = self.h;
        // (a, b) solve (h0 − u h6) a + (h1 − u h7) b = u h8 − h2, and the same for v.
        let [u, v] = flat;
        let [p, q, r, s] = [h0 - u * h6, h1 - u * h7, h3 - v * h6, h4 - v * h7];
        let determinant = p * s - q * r;
        if determinant == 0.0 {
            return None;
        }
        let [e, f] = [u * h8 - h2, v * h8 - h5];
        let at = [(e * s - q * f) / determinant, (p * f - e * r) / determinant];
        let w = h6 * at[0] + h7 * at[1] + h8;
        // ∂(u, v)/∂(a, b) = determinant/w².
        (w > 0.0).then(|| (at, straightened * w * w / determinant.abs()))
    }

    /// How the camera looks at the wall, where its matrix K is known: the columns of K⁻¹H are
    /// λ·(u, v, c) in its axes, u and v the sides of the view and c its corner, seen from the eye.
    pub(super) fn pose(&self) -> Option<Pose> {
        let lens = self.lens?;
        let [p, q, c] = [0, 1, 2].map(|k| {
            let [u, v, w] = self.h.map(|row| row[k]);
            DVec3::new((u - lens.cx * w) / lens.fx, (v - lens.cy * w) / lens.fy, w)
        });
        let normal = p.cross(q);
        let (area, away) = (normal.length(), normal.dot(c));
        Some(Pose {
            cosine: normal.z * away.signum() / area,
            height: away.abs() / libm::pow(area, 1.5),
        })
    }

    /// The lens, if one is known.
    pub fn lens(&self) -> Option<&Lens> {
        self.lens.as_ref()
    }
}

/// H in normalised coordinates: the right singular vector of the smallest singular value of the
/// equations of all marks.
fn direct(
    walls: &[[f64; 2]],
    pixels: &[[f64; 2]],
    near: Frame,
    far: Frame,
) -> Result<[f64; 9], PhotographError> {
    // One row of zeros more: of four marks the decomposition has the ninth vector too.
    let mut equations = DMatrix::zeros(2 * walls.len() + 1, 9);
    for (k, (wall, pixel)) in walls.iter().zip(pixels).enumerate() {
        let ([a, b], [u, v]) = (near.to(*wall), far.to(*pixel));
        let rows = [
            [a, b, 1.0, 0.0, 0.0, 0.0, -u * a, -u * b, -u],
            [0.0, 0.0, 0.0, a, b, 1.0, -v * a, -v * b, -v],
        ];
        for (r, row) in rows.iter().enumerate() {
            for (c, x) in row.iter().enumerate() {
                equations[(2 * k + r, c)] = *x;
            }
        }
    }
    let found = svd(&equations)?;
    if found.sigma[7] < DEGENERATE * found.sigma[0] {
        return Err(degenerate());
    }
    let h: Vec<f64> = found.vt.row(8).iter().copied().collect();
    let mut h = <[f64; 9]>::try_from(h).map_err(|_| degenerate())?;
    // The marks are in front of the camera.
    let [a, b] = near.to(walls[0]);
    if h[6] * a + h[7] * b + h[8] < 0.0 {
        h = h.map(|x| -x);
    }
    Ok(h)
}

/// The mapping of normalised H.
fn mapping(h: &[f64; 9], lens: Option<Lens>, near: Frame, far: Frame) -> Mapping {
    let rows = [[h[0], h[1], h[2]], [h[3], h[4], h[5]], [h[6], h[7], h[8]]];
    let h = times(far.back(), times(rows, near.matrix()));
    Mapping { h, lens }
}

/// Gauss–Newton on the distances in the photograph; a step that does not shorten them is halved. Of
/// the nine numbers of H one is a common factor: the least step that does the same is taken.
fn refined(
    start: [f64; 9],
    marks: &[Mark],
    lens: Option<Lens>,
    near: Frame,
    far: Frame,
) -> Result<Mapping, PhotographError> {
    let distances = |h: &[f64; 9]| -> Option<DVector<f64>> {
        let mapping = mapping(h, lens, near, far);
        let mut all = Vec::with_capacity(2 * marks.len());
        for mark in marks {
            let at = mapping.pixel(mark.wall)?;
            all.extend([at[0] - mark.pixel[0], at[1] - mark.pixel[1]]);
        }
        Some(DVector::from_vec(all))
    };
    let mut h = start;
    let mut off = distances(&h).ok_or_else(degenerate)?;
    for _ in 0..STEPS {
        let step = 1e-6;
        let mut slopes = DMatrix::zeros(off.len(), 9);
        for k in 0..9 {
            let moved = |by: f64| {
                let mut other = h;
                other[k] += by;
                distances(&other)
            };
            let (more, less) = (moved(step), moved(-step));
            let (more, less) = (more.ok_or_else(degenerate)?, less.ok_or_else(degenerate)?);
            slopes.set_column(k, &((more - less) / (2.0 * step)));
        }
        let by = least_squares(&slopes, &-&off, Tolerance::Rank(8))?.solution;
        let mut part = 1.0;
        let better = loop {
            let mut next = h;
            for (x, d) in next.iter_mut().zip(by.iter()) {
                *x += part * d;
            }
            match distances(&next) {
                Some(next_off) if next_off.norm() < off.norm() => break Some((next, next_off)),
                _ if part < 1e-3 => break None,
                _ => part *= 0.5,
            }
        };
        let Some((next, next_off)) = better else {
            break;
        };
        let gained = off.norm() - next_off.norm();
        let done = gained <= 1e-12 * off.norm();
        (h, off) = (next, next_off);
        if done {
            break;
        }
    }
    Ok(mapping(&h, lens, near, far))
}

fn degenerate() -> PhotographError {
    refused(
        "the marks determine no mapping of the wall: too many of them lie on one line, or two fall together",
        "give four or more that are the corners of an area",
    )
}

fn folded([u, v]: [f64; 2]) -> PhotographError {
    refused(
        format!(
            "the lens's distortion cannot be undone at pixel ({u}, {v}): it folds the picture over there"
        ),
        "check k1, k2, k3, p1, p2 and the camera matrix, or calibrate with marks out to the corners",
    )
}

#[cfg(test)]
mod tests;
