//! How things move per unit of a parameter.

use crate::geometry::{Basis, DVec3};
use crate::scene::{Material, Scene};

/// The velocity of a rigid body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// ω, radians per unit of the parameter.
    pub angular: DVec3,
    /// v, that of the body's point at the origin.
    pub linear: DVec3,
}

impl Twist {
    /// Of a shift along a vector, of its length per unit.
    pub fn along(linear: DVec3) -> Self {
        Self {
            angular: DVec3::ZERO,
            linear,
        }
    }

    /// Of a turn by a degree per unit about an axis, a unit vector, through a point.
    pub fn about(point: DVec3, axis: DVec3) -> Self {
        let angular = axis * 1f64.to_radians();
        Self {
            angular,
            linear: -angular.cross(point),
        }
    }

    /// ẋ = v + ω × x.
    pub fn at(&self, x: DVec3) -> DVec3 {
        self.linear + self.angular.cross(x)
    }
}

/// How f_r of a surface changes per unit of a parameter: a central difference.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialRate {
    /// The surface, by its index.
    pub surface: usize,
    /// Its material a step below and a step above, and what its albedo is multiplied by there.
    pub ends: [(Material, f64); 2],
    /// The parameter from one to the other.
    pub over: f64,
}

impl MaterialRate {
    /// ∂f_r/∂θ, sr⁻¹ per unit, with what [`Surface::brdf`](crate::scene::Surface::brdf) takes.
    pub fn of(&self, albedo: f64, normal: DVec3, wi: DVec3, wo: DVec3) -> f64 {
        let basis = Basis::around(normal);
        let [wi, wo] = [wi, wo].map(|w| basis.to_local(w));
        let [less, more] = self
            .ends
            .each_ref()
            .map(|(m, by)| m.brdf(by * albedo, wi, wo));
        (more - less) / self.over
    }
}

/// How everything in a scene moves, and what else changes, per unit of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Velocity {
    /// Of each surface, by its index.
    pub surfaces: Vec<Twist>,
    /// Of each spot along x and y; none move in a scene without a laser.
    pub spots: Vec<[f64; 2]>,
    /// Of the middle of the view along x and y.
    pub view: [f64; 2],
    /// Relative growth of the view's sides.
    pub view_growth: f64,
    /// Of the pinhole.
    pub camera: DVec3,
    /// Of where the beams start.
    pub laser: DVec3,
    /// Relative growth of each spot.
    pub spot_growth: f64,
    /// Of walls that reflect in another way.
    pub materials: Vec<MaterialRate>,
}

impl Velocity {
    /// Of a scene in which nothing moves.
    pub fn still(scene: &Scene) -> Self {
        Self {
            surfaces: vec![Twist::default(); scene.surfaces.len()],
            spots: vec![[0.0; 2]; scene.laser.spots.len()],
            view: [0.0; 2],
            view_growth: 0.0,
            camera: DVec3::ZERO,
            laser: DVec3::ZERO,
            spot_growth: 0.0,
            materials: Vec::new(),
        }
    }
}
