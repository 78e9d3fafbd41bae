//! The lens: distortion after Brown and Conrady, with the names of OpenCV.
//!
//! From normalised coordinates x = X/Z, y = Y/Z, r² = x² + y², to distorted ones:
//!
//! > x′ = x·(1 + k₁r² + k₂r⁴ + k₃r⁶) + 2p₁xy + p₂(r² + 2x²)
//! > y′ = y·(1 + k₁r² + k₂r⁴ + k₃r⁶) + p₁(r² + 2y²) + 2p₂xy
//!
//! and to pixels u = fx·x′ + cx, v = fy·y′ + cy; (0, 0) is the centre of the first pixel, u runs to
//! the right and v down. Source: OpenCV, `calib3d`, "Camera Calibration and 3D Reconstruction".

use serde::{Deserialize, Serialize};

/// Camera matrix and distortion.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Lens {
    /// Focal length along the columns, px.
    pub fx: f64,
    /// Focal length along the rows, px.
    pub fy: f64,
    /// Principal point, column, px.
    pub cx: f64,
    /// Principal point, row, px.
    pub cy: f64,
    /// Radial distortion, r².
    #[serde(default)]
    pub k1: f64,
    /// Radial distortion, r⁴.
    #[serde(default)]
    pub k2: f64,
    /// Tangential distortion.
    #[serde(default)]
    pub p1: f64,
    /// Tangential distortion.
    #[serde(default)]
    pub p2: f64,
    /// Radial distortion, r⁶.
    #[serde(default)]
    pub k3: f64,
}

/// Steps of Newton's method, and how near it has to come.
const STEPS: usize = 50;
const NEAR: f64 = 1e-13;

impl Lens {
    /// Whether it has a focal length and finite figures.
    pub fn is_valid(&self) -> bool {
        let all = [
            self.fx, self.fy, self.cx, self.cy, self.k1, self.k2, self.p1, self.p2, self.k3,
        ];
        self.fx > 0.0 && self.fy > 0.0 && all.iter().all(|x| x.is_finite())
    }

    /// Distorted normalised coordinates, and the Jacobian \[∂x′/∂x, ∂x′/∂y, ∂y′/∂x, ∂y′/∂y\].
    pub fn distorted(&self, [x, y]: [f64; 2]) -> ([f64; 2], [f64; 4]) {
        let Self {
            k1, k2, k3, p1, p2, ..
        } = *self;
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let rise = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
        let to = [
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ];
        let mixed = 2.0 * x * y * rise + 2.0 * p1 * x + 2.0 * p2 * y;
        let own = [
            radial + 2.0 * x * x * rise + 2.0 * p1 * y + 6.0 * p2 * x,
            radial + 2.0 * y * y * rise + 6.0 * p1 * y + 2.0 * p2 * x,
        ];
        (to, [own[0], mixed, mixed, own[1]])
    }

    /// The normalised coordinates of distorted ones, by Newton's method from the same place; `None`
    /// where it does not converge, or the distortion folds the picture over.
    pub fn undistorted(&self, to: [f64; 2]) -> Option<[f64; 2]> {
        let mut at = to;
        for _ in 0..STEPS {
            let (found, [a, b, c, d]) = self.distorted(at);
            let off = [found[0] - to[0], found[1] - to[1]];
            let determinant = a * d - b * c;
            if determinant <= 0.0 || !determinant.is_finite() {
                return None;
            }
            if off[0].abs().max(off[1].abs()) <= NEAR * (1.0 + to[0].abs().max(to[1].abs())) {
                return Some(at);
            }
            at[0] -= (d * off[0] - b * off[1]) / determinant;
            at[1] -= (a * off[1] - c * off[0]) / determinant;
        }
        None
    }

    /// Normalised coordinates of a pixel as it would be without distortion.
    pub fn normalised(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [(u - self.cx) / self.fx, (v - self.cy) / self.fy]
    }

    /// The pixel at distorted normalised coordinates.
    pub fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.fx * x + self.cx, self.fy * y + self.cy]
    }

    /// Étendue of a pixel relative to one on the axis: cos⁴θ of its direction, times the normalised
    /// area of an undistorted pixel in it, relative to 1/(fx·fy). `None` as for
    /// [`Self::undistorted`].
    pub fn etendue(&self, pixel: [f64; 2]) -> Option<f64> {
        let at = self.undistorted(self.normalised(pixel))?;
        let (_, [a, b, c, d]) = self.distorted(at);
        let cosine2 = 1.0 / (1.0 + at[0] * at[0] + at[1] * at[1]);
        Some(cosine2 * cosine2 / (a * d - b * c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENS: Lens = Lens {
        fx: 900.0,
        fy: 950.0,
        cx: 310.0,
        cy: 245.0,
        k1: -0.21,
        k2: 0.05,
        p1: 1.5e-3,
        p2: -8e-4,
        k3: -0.01,
    };

    /// cv2.projectPoints of (0.31, −0.22, 1) with the camera matrix and distortion above, worked
    /// out by hand: r² = 0.1445, radial = 0.9706688..., and the tangential terms.
    #[test]
    fn distortion_is_that_of_the_definition() {
        let (x, y) = (0.31, -0.22);
        let r2: f64 = 0.0961 + 0.0484;
        let radial = 1.0 - 0.21 * r2 + 0.05 * r2 * r2 - 0.01 * r2 * r2 * r2;
        let due = [
            x * radial + 2.0 * 1.5e-3 * x * y - 8e-4 * (r2 + 2.0 * x * x),
            y * radial + 1.5e-3 * (r2 + 2.0 * y * y) - 2.0 * 8e-4 * x * y,
        ];
        let (found, jacobian) = LENS.distorted([x, y]);
        assert!((found[0] - due[0]).abs() < 1e-15 && (found[1] - due[1]).abs() < 1e-15);
        // The Jacobian by differences.
        let h = 1e-6;
        for (axis, step) in [[h, 0.0], [0.0, h]].into_iter().enumerate() {
            let (more, _) = LENS.distorted([x + step[0], y + step[1]]);
            let (less, _) = LENS.distorted([x - step[0], y - step[1]]);
            for row in 0..2 {
                let slope = (more[row] - less[row]) / (2.0 * h);
                assert!((slope - jacobian[2 * row + axis]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn undistortion_is_the_inverse_and_a_fold_is_refused() {
        for at in [[0.0, 0.0], [0.4, -0.3], [-0.5, 0.5], [0.01, 0.6]] {
            let (to, _) = LENS.distorted(at);
            let back = LENS.undistorted(to).unwrap();
            assert!((back[0] - at[0]).abs() < 1e-12 && (back[1] - at[1]).abs() < 1e-12);
        }
        let folded = Lens { k1: -1.0, ..LENS };
        assert_eq!(folded.undistorted([0.9, 0.0]), None);
        // Without distortion a pixel at 45° has cos⁴ = 1/4 of the axis' étendue.
        let plain = Lens {
            k1: 0.0,
            k2: 0.0,
            k3: 0.0,
            p1: 0.0,
            p2: 0.0,
            ..LENS
        };
        let corner = plain.pixel([1.0, 0.0]);
        assert!((plain.etendue(corner).unwrap() - 0.25).abs() < 1e-12);
    }
}
