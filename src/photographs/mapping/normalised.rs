//! Coordinates in which the equations of marks are well conditioned.

/// A shift and a scale that bring points to a mean of 0 and a mean distance of √2 from it.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    centre: [f64; 2],
    scale: f64,
}

impl Frame {
    pub(super) fn of(points: &[[f64; 2]]) -> Self {
        let n = points.len() as f64;
        let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n;
        let centre = [mean(0), mean(1)];
        let distance = |p: &[f64; 2]| libm::hypot(p[0] - centre[0], p[1] - centre[1]);
        let spread = points.iter().map(distance).sum::<f64>() / n;
        Self {
            centre,
            scale: std::f64::consts::SQRT_2 / spread.max(f64::MIN_POSITIVE),
        }
    }

    pub(super) fn to(self, p: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| (p[k] - self.centre[k]) * self.scale)
    }

    /// As a matrix.
    pub(super) fn matrix(self) -> [[f64; 3]; 3] {
        let Self { centre, scale } = self;
        [
            [scale, 0.0, -scale * centre[0]],
            [0.0, scale, -scale * centre[1]],
            [0.0, 0.0, 1.0],
        ]
    }

    /// The inverse of that matrix.
    pub(super) fn back(self) -> [[f64; 3]; 3] {
        let Self { centre, scale } = self;
        [
            [1.0 / scale, 0.0, centre[0]],
            [0.0, 1.0 / scale, centre[1]],
            [0.0, 0.0, 1.0],
        ]
    }
}

/// The product of two matrices.
pub(super) fn times(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}
