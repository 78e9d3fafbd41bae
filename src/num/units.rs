//! Constants of nature, exact by the definition of the SI (2019).

/// Planck's constant h, J s.
pub const PLANCK: f64 = 6.626_070_15e-34;
/// Speed of light c, m/s.
pub const LIGHT_SPEED: f64 = 299_792_458.0;

/// Energy of a photon of `wavelength` (m): hc/λ, J.
///
/// ```
/// // A helium–neon laser's photon has 1.959 eV of 1.602176634e-19 J.
/// let energy = phicam::num::units::photon_energy(632.8e-9) / 1.602_176_634e-19;
/// assert!((energy - 1.959).abs() < 5e-4);
/// ```
pub fn photon_energy(wavelength: f64) -> f64 {
    PLANCK * LIGHT_SPEED / wavelength
}
