//! The two kernels of G12 and G23.

use crate::geometry::DVec3;
use crate::num::lanes::widest;
use crate::num::named::named;
use crate::scene::material::FallOff;
use crate::scene::{Element, Surface};

named! {
    /// Which cosine is taken at S2.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Kernel {
        /// What light does: cosθ_wall · cosθ_S2 / R².
        Physical = "physical": "The true cosine at the hidden surface",
        /// What the published simulation computes: cosθ_wall · √(½·|r⊥|²)/R / R², where r⊥ is the
        /// part of the line that is perpendicular to S2's u axis (on the bench (y1 − y2, z2)) and
        /// √½ the cosine of the hinge angle. Only for reproducing published curves: on the bench it
        /// misses the transport integral by a third.
        Published = "published": "The one in the published simulation",
    }
}

/// A point of the hidden surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HiddenPoint {
    pub position: DVec3,
    pub normal: DVec3,
    /// Unit vector along u.
    pub u_axis: DVec3,
    /// Of a surface whose light falls off with direction.
    pub fall_off: Option<FallOff>,
}

impl HiddenPoint {
    pub(super) fn new(surface: &Surface, element: &Element) -> Self {
        Self {
            fall_off: surface.fall_off(),
            position: element.position,
            normal: element.normal,
            u_axis: element.u_axis,
        }
    }
}

/// Hidden points, coordinate by coordinate, so that a wall point meets many of them at once.
pub(super) struct HiddenPoints<'a> {
    /// Each with its share of area · albedo/π.
    pub all: &'a [(HiddenPoint, f64)],
    position: [Vec<f64>; 3],
    normal: [Vec<f64>; 3],
    /// Whether the light of any falls off with direction.
    falls_off: bool,
}

impl<'a> HiddenPoints<'a> {
    pub(super) fn new(all: &'a [(HiddenPoint, f64)]) -> Self {
        let by_axis = |of: fn(&HiddenPoint) -> DVec3| {
            std::array::from_fn(|axis| all.iter().map(|(point, _)| of(point)[axis]).collect())
        };
        Self {
            all,
            position: by_axis(|point| point.position),
            normal: by_axis(|point| point.normal),
            falls_off: all.iter().any(|(point, _)| point.fall_off.is_some()),
        }
    }

    /// Whether [`HiddenPoints::add_geometry`] holds for them.
    pub(super) fn are_plain(&self, kernel: Kernel) -> bool {
        kernel == Kernel::Physical && !self.falls_off
    }

    /// Adds `factor` · G to the sum of each point, G as [`Kernel::between`] has it for points of
    /// the physical kernel without a fall-off, to the bit.
    pub(super) fn add_geometry(&self, wall: DVec3, facing: DVec3, factor: f64, sums: &mut [f64]) {
        let ([x, y, z], [nx, ny, nz]) = (&self.position, &self.normal);
        widest(
            #[inline(always)]
            || {
                let n = sums.len();
                let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
                let (nx, ny, nz) = (&nx[..n], &ny[..n], &nz[..n]);
                for j in 0..n {
                    let (rx, ry, rz) = (x[j] - wall.x, y[j] - wall.y, z[j] - wall.z);
                    let r2 = rx * rx + ry * ry + rz * rz;
                    let at_wall = (rx * facing.x + ry * facing.y + rz * facing.z).max(0.0);
                    let at_hidden = (-(rx * nx[j] + ry * ny[j] + rz * nz[j])).max(0.0);
                    let g = at_wall * at_hidden / (r2 * r2);
                    sums[j] += if r2 > 0.0 { factor * g } else { 0.0 };
                }
            },
        );
    }
}

impl Kernel {
    /// G between a wall point with its normal and a hidden point, length⁻²; 0 where one sees only
    /// the other's back. Where the hidden surface shines, times its fall-off f in that direction.
    pub(super) fn between(self, wall: DVec3, normal: DVec3, hidden: &HiddenPoint) -> f64 {
        let r = hidden.position - wall;
        let r2 = r.length_squared();
        // An element without area has no normal, and no place.
        if r2 == 0.0 || hidden.normal == DVec3::ZERO {
            return 0.0;
        }
        let at_wall = r.dot(normal).max(0.0);
        let at_hidden = match self {
            Self::Physical => (-r.dot(hidden.normal)).max(0.0),
            Self::Published => {
                (0.5 * (r - hidden.u_axis * r.dot(hidden.u_axis)).length_squared()).sqrt()
            }
        };
        let falls = hidden
            .fall_off
            .as_ref()
            .map_or(1.0, |f| f.towards(hidden.normal, -r));
        at_wall * at_hidden * falls / (r2 * r2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On the bench both kernels are the formulas of the published study: z2·(15.5 − y)/√2/R⁴ and
    /// z2·√(½((y − y2)² + z2²))/R⁴.
    #[test]
    fn the_bench_has_its_published_formulas() {
        let h = 0.5f64.sqrt();
        for (x, y, x2, d) in [
            (1.0, 2.0, 3.25, 6.0),
            (9.0, 10.0, 6.5, 9.5),
            (5.0, 4.4, 5.0, 7.9),
        ] {
            let (y2, z2) = (15.5 - d * h, d * h);
            let r2: f64 = (x - x2) * (x - x2) + (y - y2) * (y - y2) + z2 * z2;
            let hidden = HiddenPoint {
                position: DVec3::new(x2, y2, z2),
                normal: DVec3::new(0.0, -h, -h),
                u_axis: DVec3::X,
                fall_off: None,
            };
            let wall = DVec3::new(x, y, 0.0);
            let physical = Kernel::Physical.between(wall, DVec3::Z, &hidden);
            let want = z2 * (15.5 - y) * h / (r2 * r2);
            assert!(
                (physical / want - 1.0).abs() < 1e-14,
                "{physical} for {want}"
            );
            let published = Kernel::Published.between(wall, DVec3::Z, &hidden);
            let want = z2 * (0.5 * ((y - y2) * (y - y2) + z2 * z2)).sqrt() / (r2 * r2);
            assert!(
                (published / want - 1.0).abs() < 1e-14,
                "{published} for {want}"
            );
        }
    }

    #[test]
    fn backs_see_nothing() {
        let hidden = HiddenPoint {
            position: DVec3::Z,
            normal: DVec3::Z,
            u_axis: DVec3::X,
            fall_off: None,
        };
        assert_eq!(
            Kernel::Physical.between(DVec3::ZERO, DVec3::Z, &hidden),
            0.0
        );
        let hidden = HiddenPoint {
            normal: -DVec3::Z,
            ..hidden
        };
        assert_eq!(
            Kernel::Physical.between(DVec3::ZERO, DVec3::Z, &hidden),
            1.0
        );
        assert_eq!(
            Kernel::Physical.between(DVec3::ZERO, -DVec3::Z, &hidden),
            0.0
        );
    }
}
