//! How stored values stand for light.

use serde::{Deserialize, Serialize};

/// The relation between a stored value e and the linear value x, both 1 for white.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Transfer {
    /// x = e.
    Linear,
    /// That of IEC 61966-2-1 (sRGB): x = e/12.92 up to e = 0.04045, ((e + 0.055)/1.055)^2.4 above.
    Srgb,
}

impl Transfer {
    /// The linear value of a stored one.
    pub fn decode(self, e: f64) -> f64 {
        match self {
            Self::Linear => e,
            Self::Srgb if e <= 0.04045 => e / 12.92,
            Self::Srgb => libm::pow((e + 0.055) / 1.055, 2.4),
        }
    }

    /// The value to store for a linear one.
    pub fn encode(self, x: f64) -> f64 {
        match self {
            Self::Linear => x,
            Self::Srgb if x <= 0.0031308 => x * 12.92,
            Self::Srgb => 1.055 * libm::pow(x, 1.0 / 2.4) - 0.055,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard rounds the slope and the two ends of the straight part so that they meet to
    /// some 1e-7.
    #[test]
    fn the_curve_is_that_of_the_standard() {
        let x = |code: u8| Transfer::Srgb.decode(f64::from(code) / 255.0);
        // Published values of linear light for codes of eight bits: 10 on the straight part, 128
        // and 188 on the curve.
        for (code, linear) in [
            (0, 0.0),
            (10, 0.003_035_3),
            (128, 0.215_860_5),
            (188, 0.502_886_5),
            (255, 1.0),
        ] {
            assert!((x(code) - linear).abs() < 1e-7, "{code}: {}", x(code));
        }
        let kink = 0.04045;
        assert!((kink / 12.92 - libm::pow((kink + 0.055) / 1.055, 2.4)).abs() < 1e-7);
    }

    #[test]
    fn what_is_encoded_is_decoded() {
        for transfer in [Transfer::Srgb, Transfer::Linear] {
            for k in 0..=1000 {
                let x = f64::from(k) / 1000.0;
                assert!(
                    (transfer.decode(transfer.encode(x)) - x).abs() < 1e-7,
                    "{x}"
                );
            }
        }
    }
}
