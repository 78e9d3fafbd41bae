//! A point within the region, its multipliers, and a step of them.

use nalgebra::DVector;

/// x within the region and the multipliers z of x ≥ l, w of u ≥ x (0 without one) and m of
/// g = ½(radius² − ‖e‖²) ≥ 0, e = R x − d.
#[derive(Clone)]
pub(super) struct State {
    pub(super) x: DVector<f64>,
    pub(super) y: DVector<f64>,
    pub(super) s: DVector<f64>,
    pub(super) e: DVector<f64>,
    pub(super) g: f64,
    pub(super) z: DVector<f64>,
    pub(super) w: DVector<f64>,
    pub(super) m: f64,
}

/// A step of them, and R Δx.
pub(super) struct Direction {
    pub(super) x: DVector<f64>,
    pub(super) e: DVector<f64>,
    pub(super) z: DVector<f64>,
    pub(super) w: DVector<f64>,
    pub(super) m: f64,
}

/// What the products y z, s w and g m are to change by.
pub(super) struct Products {
    pub(super) yz: DVector<f64>,
    pub(super) sw: DVector<f64>,
    pub(super) gm: f64,
}

pub(super) fn over(a: f64, s: f64) -> f64 {
    if s.is_finite() { a / s } else { 0.0 }
}

fn times(s: f64, w: f64) -> f64 {
    if s.is_finite() { s * w } else { 0.0 }
}

impl State {
    /// How many products there are.
    pub(super) fn pairs(&self) -> f64 {
        let closed = self.s.iter().filter(|s| s.is_finite()).count();
        (self.y.len() + closed + 1) as f64
    }

    /// Their mean.
    pub(super) fn mean(&self) -> f64 {
        let upper = self.s.zip_map(&self.w, times).sum();
        (self.y.dot(&self.z) + upper + self.g * self.m) / self.pairs()
    }

    /// Their mean after a step.
    pub(super) fn ahead(&self, radius: f64, by: &Direction, (primal, dual): (f64, f64)) -> f64 {
        let (y, s) = (&self.y + &by.x * primal, &self.s - &by.x * primal);
        let (z, w) = (&self.z + &by.z * dual, &self.w + &by.w * dual);
        let e = &self.e + &by.e * primal;
        let g = 0.5 * (radius * radius - e.norm_squared());
        let upper = s.zip_map(&w, times).sum();
        (y.dot(&z) + upper + g * (self.m + by.m * dual)) / self.pairs()
    }

    /// What the products are to change by to become `aim`, less what those of a predicted step add.
    pub(super) fn aim(&self, aim: f64, guess: Option<&Direction>) -> Products {
        let mut c = Products {
            yz: self.y.zip_map(&self.z, |y, z| aim - y * z),
            sw: self.s.zip_map(&self.w, |s, w| aim - times(s, w)),
            gm: aim - self.g * self.m,
        };
        if let Some(by) = guess {
            c.yz -= by.x.component_mul(&by.z);
            c.sw += by.x.component_mul(&by.w);
            // Δg = −eᵀR Δx − ½‖R Δx‖².
            let bent = 0.5 * by.e.norm_squared();
            c.gm += (self.e.dot(&by.e) + bent) * by.m + self.m * bent;
        }
        c
    }
}
