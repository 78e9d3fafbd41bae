//! Orthonormal bases.

use super::DVec3;

/// A right-handed orthonormal basis (s, t, n) around a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// First tangent.
    pub s: DVec3,
    /// Second tangent.
    pub t: DVec3,
    /// Normal.
    pub n: DVec3,
}

impl Basis {
    /// A basis around the unit vector `n` (Duff et al., *Building an orthonormal basis, revisited*,
    /// JCGT 6(1), 2017).
    pub fn around(n: DVec3) -> Self {
        let sign = 1f64.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: DVec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// Local coordinates → world: x·s + y·t + z·n.
    pub fn to_world(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        self.s * x + self.t * y + self.n * z
    }

    /// World → local coordinates.
    pub fn to_local(&self, w: DVec3) -> DVec3 {
        DVec3::new(self.s.dot(w), self.t.dot(w), self.n.dot(w))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orthonormal_and_right_handed_in_every_direction() {
        for i in 0..1000 {
            // A spiral over the sphere, poles included.
            let z = 1.0 - 2.0 * f64::from(i) / 999.0;
            let r = (1.0 - z * z).max(0.0).sqrt();
            let phi = 2.4 * f64::from(i);
            let n = DVec3::new(r * phi.cos(), r * phi.sin(), z).normalize();
            let Basis { s, t, n } = Basis::around(n);
            for (x, want) in [
                (s.dot(s), 1.0),
                (t.dot(t), 1.0),
                (s.dot(t), 0.0),
                (s.dot(n), 0.0),
                (t.dot(n), 0.0),
                (s.cross(t).dot(n), 1.0),
            ] {
                assert!((x - want).abs() < 1e-14, "n {n}: {x} for {want}");
            }
        }
    }
}
