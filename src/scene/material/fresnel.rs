//! Fresnel's equations for unpolarised light.

/// Reflectance of a smooth interface to a dielectric of relative refractive index η (transmitted
/// over incident side), and the cosine of the refracted direction; (1, 0) in total reflection.
///
/// > R = ½ (r_s² + r_p²),   r_s = (c − η c_t)/(c + η c_t),   r_p = (η c − c_t)/(η c + c_t),   c_t = √(1 − (1 − c²)/η²)
pub(super) fn dielectric(cosine: f64, eta: f64) -> (f64, f64) {
    let squared = 1.0 - (1.0 - cosine * cosine) / (eta * eta);
    if squared <= 0.0 {
        return (1.0, 0.0);
    }
    let refracted = squared.sqrt();
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    (0.5 * (s * s + p * p), refracted)
}

/// Reflectance of a smooth conductor of refractive index η + ik in vacuum (Born and Wolf,
/// *Principles of Optics*, § 14.2). With a² + b² = √((η² − k² − sin²θ)² + 4η²k²) and a = √(½ (a² +
/// b² + η² − k² − sin²θ)):
///
/// > R_s = (a² + b² − 2ac + c²)/(a² + b² + 2ac + c²),   R_p = R_s (c²(a² + b²) − 2ac sin²θ + sin⁴θ)/(c²(a² + b²) + 2ac sin²θ + sin⁴θ)
pub(super) fn conductor(cosine: f64, eta: f64, k: f64) -> f64 {
    let c2 = cosine * cosine;
    let s2 = 1.0 - c2;
    let e = eta * eta - k * k - s2;
    let ab = (e * e + 4.0 * eta * eta * k * k).sqrt();
    let ac = 2.0 * cosine * (0.5 * (ab + e)).max(0.0).sqrt();
    let s = (ab + c2 - ac) / (ab + c2 + ac);
    let p = s * (c2 * ab + s2 * s2 - ac * s2) / (c2 * ab + s2 * s2 + ac * s2);
    0.5 * (s + p)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ((η − 1)/(η + 1))² and ((η − 1)² + k²)/((η + 1)² + k²) at normal incidence; 1 at grazing
    /// incidence.
    #[test]
    fn closed_values_at_both_ends() {
        for eta in [1.1, 1.5, 2.4, 1.0 / 1.5f64] {
            let r = ((eta - 1.0) / (eta + 1.0)).powi(2);
            assert!((dielectric(1.0, eta).0 - r).abs() < 1e-15);
            assert_eq!(dielectric(0.0, eta).0, 1.0);
        }
        for (eta, k) in [(0.2f64, 3.9f64), (1.5, 7.6), (2.9, 3.1)] {
            let r = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
            assert!((conductor(1.0, eta, k) - r).abs() < 1e-14);
            assert!((conductor(0.0, eta, k) - 1.0).abs() < 1e-14);
        }
    }

    /// At tanθ = η no p-polarised light is reflected, and R = ½ cos²2θ.
    #[test]
    fn brewster() {
        for eta in [1.33, 1.5, 2.0f64] {
            let theta = eta.atan();
            let r = 0.5 * (2.0 * theta).cos().powi(2);
            assert!((dielectric(theta.cos(), eta).0 - r).abs() < 1e-14);
        }
    }

    /// The same reflectance from either side (Stokes), and total reflection beyond sinθ = 1/η.
    #[test]
    fn both_sides_agree() {
        for i in 1..50 {
            let c = f64::from(i) / 50.0;
            let (r, t) = dielectric(c, 1.5);
            assert!((dielectric(t, 1.0 / 1.5).0 - r).abs() < 1e-13);
        }
        let critical = (1.0 - 1.0 / 2.25f64).sqrt();
        assert_eq!(dielectric(critical - 1e-9, 1.0 / 1.5), (1.0, 0.0));
    }

    /// A conductor that does not absorb is a dielectric.
    #[test]
    fn without_absorption_a_conductor_is_a_dielectric() {
        for i in 0..=40 {
            let c = f64::from(i) / 40.0;
            assert!((conductor(c, 1.7, 0.0) - dielectric(c, 1.7).0).abs() < 1e-12);
        }
    }
}
