//! Albedo between the centres of texels.

use serde::{Deserialize, Serialize};

/// What a texture is outside \[0, 1\].
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// What it is at the nearest border.
    #[default]
    Clamp,
    /// The same again.
    Repeat,
}

/// Albedo interpolated linearly in u and in v between the centres ((i + ½)/nu, (j + ½)/nv) of nu ×
/// nv texels. Beyond the outermost centres it is level, or goes on with the opposite border's
/// texels if it repeats.
#[derive(Clone, Debug, PartialEq)]
pub struct Bilinear {
    /// Texels along u and v.
    pub count: [usize; 2],
    /// Albedo of texel iu + iv·count\[0\].
    pub albedo: Vec<f64>,
    /// What lies outside.
    pub wrap: Wrap,
}

impl Bilinear {
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let [nu, nv] = self.count;
        let (iu, tu) = self.neighbours(u, nu);
        let (iv, tv) = self.neighbours(v, nv);
        let row = |j: usize| {
            let [a, b] = iu.map(|i| self.albedo[i + j * nu]);
            a + (b - a) * tu
        };
        let [a, b] = iv.map(row);
        a + (b - a) * tv
    }

    /// The texels whose centres lie on both sides, and how far it is from the first to the second,
    /// in \[0, 1\].
    fn neighbours(&self, x: f64, n: usize) -> ([usize; 2], f64) {
        let last = n - 1;
        match self.wrap {
            Wrap::Clamp => {
                let x = (x * n as f64 - 0.5).clamp(0.0, last as f64);
                let i = x as usize;
                ([i, (i + 1).min(last)], x - i as f64)
            }
            Wrap::Repeat => {
                let x = (x - x.floor()) * n as f64 + 0.5;
                // In terms of the texel on the left of the first: 0 is the last one.
                let i = (x as usize).min(n);
                ([(i + last) % n, i % n], (x - i as f64).min(1.0))
            }
        }
    }

    /// Half-texels: in each of them both neighbours along u, and along v, stay the same.
    pub(super) fn smooth_cells(&self) -> [usize; 2] {
        self.count.map(|n| 2 * n)
    }

    /// The mean over a half-texel: bilinear there, so that it is the value at its centre.
    pub(super) fn cell_mean(&self, cell: usize) -> f64 {
        let [nu, nv] = self.smooth_cells();
        let centre = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        self.at([centre(cell % nu, nu), centre(cell / nu, nv)])
    }
}
