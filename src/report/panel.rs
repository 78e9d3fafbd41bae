//! A matrix to be shown, and its entries as a bare picture.

use super::colour::Scale;
use super::encode::{PictureError, base64, rgb};

/// A bare matrix is enlarged to at least this on its longer side, px.
const SIDE: usize = 256;

/// A length that is drawn below a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleBar {
    /// Its share of the picture's width.
    pub share: f64,
    /// What it is, with its unit.
    pub text: String,
}

/// A matrix to be shown: the first index runs to the right, the second upwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What it is.
    pub title: String,
    /// Columns and rows (nu, nv).
    pub size: [usize; 2],
    /// Value of column iu, row iv at iu + iv·nu; a value that is missing is shown as not a number.
    pub values: Vec<f64>,
    /// What runs to the right and what upwards.
    pub axes: [String; 2],
    /// A length, where it has one.
    pub scale_bar: Option<ScaleBar>,
}

impl Panel {
    /// A panel of elements: iu to the right, iv upwards.
    pub fn elements(title: impl Into<String>, size: [usize; 2], values: Vec<f64>) -> Self {
        Self {
            title: title.into(),
            size,
            values,
            axes: ["iu", "iv"].map(str::to_owned),
            scale_bar: None,
        }
    }

    /// The value of column `iu`, row `iv`.
    pub(super) fn at(&self, iu: usize, iv: usize) -> f64 {
        self.values
            .get(iu + iv * self.size[0])
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// The entries alone, enlarged by a whole factor, the last row on top, as PNG bytes.
    pub(super) fn plain_png(&self, scale: &Scale) -> Result<Vec<u8>, PictureError> {
        let [nu, nv] = self.entries();
        let factor = SIDE.div_ceil(nu.max(nv));
        let mut pixels = Vec::with_capacity(3 * nu * nv * factor * factor);
        for iv in (0..nv).rev() {
            let entry = |iu| std::iter::repeat_n(scale.colour(self.at(iu, iv)), factor);
            let row: Vec<u8> = (0..nu).flat_map(entry).flatten().collect();
            for _ in 0..factor {
                pixels.extend_from_slice(&row);
            }
        }
        rgb([nu * factor, nv * factor], &pixels, None)
    }

    /// The entries as a picture inside of markup.
    pub(super) fn data_uri(&self, scale: &Scale) -> Result<String, PictureError> {
        let png = self.plain_png(scale)?;
        Ok(format!("data:image/png;base64,{}", base64(&png)))
    }

    fn entries(&self) -> [usize; 2] {
        self.size.map(|n| n.max(1))
    }

    /// Width and height on a sheet: the longer side as near below `most` as whole pixels an entry
    /// allow, but one at least.
    pub(super) fn pixels(&self, most: usize) -> [usize; 2] {
        let [nu, nv] = self.entries();
        let factor = (most / nu.max(nv)).max(1);
        [nu * factor, nv * factor]
    }
}
