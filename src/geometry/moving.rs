//! Corners that move, for the rates of what stays in sight.
//!
//! > w = a + (b − a) t,  t = h_a/(h_a − h_b),  h = n·w − d:   ḣ = ṅ·w + n·ẇ − ḋ,  ṫ = (h_a ḣ_b − h_b ḣ_a)/(h_a − h_b)²

use super::DVec3;
use super::corner::Corner;

/// Parameters by which rates are taken at once.
pub const AT_ONCE: usize = 4;

/// (ṅ, ḋ) of a plane n·w = d, per unit of each parameter.
pub type PlaneRate = [(DVec3, f64); AT_ONCE];

/// A point that moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Where it is.
    pub at: DVec3,
    /// Its velocity per unit of each parameter.
    pub rate: [DVec3; AT_ONCE],
}

impl Moving {
    /// One that stands still.
    pub fn still(at: DVec3) -> Self {
        Self {
            at,
            rate: [DVec3::ZERO; AT_ONCE],
        }
    }

    /// [Area and centroid](super::area_and_middle) of a figure, the latter as it moves, and per
    /// unit of each parameter the rate of the area.
    pub fn area_and_middle(figure: &[Self]) -> (f64, Self, [f64; AT_ONCE]) {
        let Some(first) = figure.first() else {
            return (0.0, Self::still(DVec3::ZERO), [0.0; AT_ONCE]);
        };
        let mut sum = (0.0, DVec3::ZERO);
        let mut rates = [(0.0, DVec3::ZERO); AT_ONCE];
        for pair in figure[1..].windows(2) {
            let (a, b) = (pair[0].at - first.at, pair[1].at - first.at);
            let cross = a.cross(b);
            let area = 0.5 * cross.length();
            if area == 0.0 {
                continue;
            }
            sum = (sum.0 + area, sum.1 + (a + b) * (area / 3.0));
            for (k, rate) in rates.iter_mut().enumerate() {
                let [da, db] = [0, 1].map(|i| pair[i].rate[k] - first.rate[k]);
                let grown = cross.dot(da.cross(b) + a.cross(db)) / (4.0 * area);
                *rate = (
                    rate.0 + grown,
                    rate.1 + ((a + b) * grown + (da + db) * area) / 3.0,
                );
            }
        }
        let (area, moment) = sum;
        if area == 0.0 {
            return (0.0, *first, [0.0; AT_ONCE]);
        }
        let away = moment / area;
        let middle = Self {
            at: first.at + away,
            rate: std::array::from_fn(|k| first.rate[k] + (rates[k].1 - away * rates[k].0) / area),
        };
        (area, middle, rates.map(|(grown, _)| grown))
    }
}

impl Corner for Moving {
    type Plane = PlaneRate;

    #[inline]
    fn at(&self) -> DVec3 {
        self.at
    }

    fn crossing(
        a: &Self,
        b: &Self,
        [h, k]: [f64; 2],
        (n, _, plane): &(DVec3, f64, PlaneRate),
    ) -> Self {
        let t = h / (h - k);
        let rate = |lane: usize| {
            let (dn, dd) = plane[lane];
            let [dh, dk] = [a, b].map(|w| dn.dot(w.at) + n.dot(w.rate[lane]) - dd);
            let dt = (h * dk - k * dh) / ((h - k) * (h - k));
            a.rate[lane] + (b.rate[lane] - a.rate[lane]) * t + (b.at - a.at) * dt
        };
        Self {
            at: a.at + (b.at - a.at) * t,
            rate: std::array::from_fn(rate),
        }
    }
}

#[cfg(test)]
mod tests;
