//! Surfaces that shine: monitors, lamps.

use serde::{Deserialize, Serialize};

use crate::geometry::DVec3;

/// Exponents of a fall-off beyond this are taken for a mistake: cos¹⁰⁰⁰ is 7° wide.
pub(super) const MOST_FALLOFF: f64 = 1000.0;

/// A surface that shines by itself and reflects nothing. Its radiance at the picture's value x in
/// the direction ω is
///
/// > L(ω) = x · M/π · cosⁿʰ(θ_h) · cosⁿᵛ(θ_v),   W length⁻² sr⁻¹
///
/// θ_h, θ_v the angles between the normal and the projections of ω on the planes of (normal, u) and
/// (normal, v). M is π times the radiance of a white point along the normal: the exitance of a
/// Lambertian surface (n = 0) of that radiance. With a fall-off the surface emits less than M.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shining {
    /// M, W length⁻².
    pub exitance: f64,
    /// n_h and n_v.
    pub falloff: [f64; 2],
}

impl Shining {
    /// Whether its radiance is the same in all directions.
    pub fn is_lambertian(&self) -> bool {
        self.falloff == [0.0, 0.0]
    }
}

/// What is photographed of a surface that shines.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Shown {
    /// The picture, in one photograph.
    #[default]
    Picture,
    /// Every element alone and at its brightest, each in a photograph of its own.
    Elements,
}

/// The fall-off of a surface with its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FallOff {
    /// Unit vectors along u and v.
    pub axes: [DVec3; 2],
    /// n_h and n_v.
    pub exponents: [f64; 2],
}

impl FallOff {
    /// f = cosⁿʰ(θ_h) · cosⁿᵛ(θ_v) in a direction of any length that is above the surface; 0 below.
    /// With a the direction's part along the normal and h that along the axis, cos²θ_h = a²/(a² +
    /// h²).
    // Called, it took half of a calibration: its arguments went through memory.
    #[inline(always)]
    pub fn towards(&self, normal: DVec3, direction: DVec3) -> f64 {
        let a = direction.dot(normal);
        if a <= 0.0 {
            return 0.0;
        }
        let power = |axis: &DVec3, n: f64| {
            if n == 0.0 {
                return 1.0;
            }
            let h = direction.dot(*axis);
            let square = a * a / (a * a + h * h);
            // Most exponents are whole: powers took two fifths of a model's time.
            let whole = n.min(MOST_WHOLE) as u32;
            if f64::from(whole) == n {
                let even = whole_power(square, whole / 2);
                return if whole % 2 == 1 {
                    even * square.sqrt()
                } else {
                    even
                };
            }
            libm::pow(square, 0.5 * n)
        };
        power(&self.axes[0], self.exponents[0]) * power(&self.axes[1], self.exponents[1])
    }
}

/// Whole exponents up to this one are multiplied out.
const MOST_WHOLE: f64 = 64.0;

/// xⁿ by squaring, so that every machine has the same bits.
#[inline]
fn whole_power(x: f64, mut n: u32) -> f64 {
    let (mut power, mut square) = (1.0, x);
    while n > 0 {
        if n % 2 == 1 {
            power *= square;
        }
        square *= square;
        n /= 2;
    }
    power
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exponents whole or not, even or odd, few or many.
    #[test]
    fn powers_are_those_of_the_cosine() {
        let direction = DVec3::new(0.3, -0.8, 1.1);
        for n in [0.0, 1.0, 2.0, 2.5, 3.0, 17.0, 18.0, 63.0, 64.0, 65.0, 200.3] {
            let falloff = FallOff {
                axes: [DVec3::X, DVec3::Y],
                exponents: [n, 0.0],
            };
            let cos = 1.1 / (1.1f64 * 1.1 + 0.3 * 0.3).sqrt();
            let (got, want) = (falloff.towards(DVec3::Z, direction), cos.powf(n));
            assert!((got - want).abs() <= 1e-13 * want, "{n}: {got} for {want}");
        }
    }

    /// At 60° to the side cosθ_h = ½; above at 60° cosθ_v = ½; along (1, 1, 1) both are √½; below
    /// nothing shines.
    #[test]
    fn falls_off_by_each_angle_alone() {
        let falloff = FallOff {
            axes: [DVec3::X, DVec3::Y],
            exponents: [1.0, 18.0],
        };
        let f = |d: [f64; 3]| falloff.towards(DVec3::Z, DVec3::from_array(d));
        let tilted = 3f64.sqrt();
        for (direction, want) in [
            ([0.0, 0.0, 2.0], 1.0),
            ([tilted, 0.0, 1.0], 0.5),
            ([0.0, -tilted, 1.0], 0.5f64.powi(18)),
            ([1.0, 1.0, 1.0], 0.5f64.powf(9.5)),
            ([0.3, 0.2, -1.0], 0.0),
        ] {
            let got = f(direction);
            assert!(
                (got - want).abs() <= 1e-14 * want,
                "{direction:?}: {got} for {want}"
            );
        }
    }
}
