//! Measured materials.

use super::ggx::Ggx;
use super::grid::Grid;
use super::lobe::Lobe;
use super::merl::{Channel, Merl};
use super::slanted;
use crate::geometry::DVec3;
use crate::num::digits::significant;
use crate::num::quadrature::Rule;
use crate::scene::error::{Fault, keys};
use crate::scene::texture::LEAST_ALBEDO;
use crate::store::digest_of;

/// An isotropic BRDF measured on a surface, from a file: one colour of a binary table of the MERL
/// database, or, where the file's name ends in `.csv`, text with the header
/// `theta_i,theta_o,phi,value`. The texture's value multiplies it.
///
/// A table that reflects more than it receives is refused: its directional albedo is taken at all
/// polar angles of a text, between which it is linear, and every half degree of a MERL table, whose
/// entries are a degree wide.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    table: Table,
    lobe: Lobe,
    digest: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Table {
    Merl(Merl),
    Grid(Grid),
}

/// What quadrature and rounding may add to a reflectance of 1.
const ALLOWANCE: f64 = 1e-3;
const INCIDENCES: u32 = 180;
const NODES: usize = 32;
/// Roughnesses and shares from which the lobe is chosen, over the cosines of these exitant
/// directions, with so many nodes.
const ALPHAS: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.4, 0.7];
const SHARES: [f64; 3] = [0.3, 0.6, 0.9];
const EXITANCES: [f64; 4] = [0.97, 0.75, 0.45, 0.15];
const LOBE_NODES: usize = 12;

impl Measured {
    /// One colour of a MERL table; `largest` is what it will be multiplied by at most.
    pub(super) fn merl(bytes: &[u8], channel: Channel, largest: f64) -> Result<Self, Fault> {
        Self::new(Table::Merl(Merl::read(bytes, channel)?), bytes, largest)
    }

    /// A table of angle triples.
    pub(super) fn grid(bytes: &[u8], largest: f64) -> Result<Self, Fault> {
        Self::new(Table::Grid(Grid::read(bytes)?), bytes, largest)
    }

    fn new(table: Table, bytes: &[u8], largest: f64) -> Result<Self, Fault> {
        let mut measured = Self {
            table,
            lobe: Lobe::cosine(),
            digest: digest_of(bytes),
        };
        measured.lobe = measured.best_lobe();
        measured.refuse_gain(largest)?;
        Ok(measured)
    }

    /// SHA-256 of the file, in hexadecimal.
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// Share of the entries of a MERL table that was not measured.
    pub(super) fn unmeasured(&self) -> f64 {
        match &self.table {
            Table::Merl(table) => table.unmeasured(),
            Table::Grid(_) => 0.0,
        }
    }

    /// f_r of directions above the surface, sr⁻¹.
    pub(super) fn brdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        match &self.table {
            Table::Merl(table) => table.brdf(wi, wo),
            Table::Grid(table) => table.brdf(wi, wo),
        }
    }

    pub(super) fn lobe(&self) -> Lobe {
        self.lobe
    }

    /// Of all candidates the lobe p with the least second moment of the estimator f cosθ/p, ∫ (f
    /// cosθ)²/p dω, relative to the square of its mean, summed over some exitant directions.
    fn best_lobe(&self) -> Lobe {
        let rule = Rule::gauss_legendre(LOBE_NODES);
        let spread = |lobe: &Lobe| {
            let relative = |mu: &f64| {
                let wo = slanted(*mu);
                let (mut first, mut second) = (0.0, 0.0);
                let squared = |w: DVec3, p: f64| (self.brdf(w, wo) * w.z).powi(2) / p;
                second += lobe.integral(wo, &rule, squared);
                first += lobe.integral(wo, &rule, |w, _| self.brdf(w, wo) * w.z);
                if first > 0.0 {
                    second / (first * first)
                } else {
                    0.0
                }
            };
            EXITANCES.iter().map(relative).sum::<f64>()
        };
        let mut best = Lobe::cosine();
        let mut least = spread(&best);
        for alpha in ALPHAS {
            for glossy in SHARES {
                let ggx = Ggx::new(alpha);
                let lobe = Lobe { glossy, ggx };
                let found = spread(&lobe);
                if found < least {
                    (best, least) = (lobe, found);
                }
            }
        }
        best
    }

    /// Angles of incidence, degrees, and the share of the light from there that is reflected, by
    /// quadrature.
    fn albedos(&self) -> Vec<[f64; 2]> {
        let rule = Rule::gauss_legendre(NODES);
        let of = |k: u32| {
            let degrees = 90.0 / f64::from(INCIDENCES) * f64::from(k);
            let (sin, cos) = libm::sincos(degrees.to_radians());
            let wi = DVec3::new(sin, 0.0, cos);
            let reflected = self.lobe.integral(wi, &rule, |w, _| self.brdf(wi, w) * w.z);
            [degrees, reflected]
        };
        (0..INCIDENCES).map(of).collect()
    }

    fn refuse_gain(&self, largest: f64) -> Result<(), Fault> {
        let albedos = match &self.table {
            Table::Grid(table) => table.albedos(),
            Table::Merl(_) => self.albedos(),
        };
        let worst = albedos.into_iter().max_by(|a, b| a[1].total_cmp(&b[1]));
        let [degrees, reflected] = worst.unwrap_or_default();
        if reflected * largest <= 1.0 + ALLOWANCE {
            return Ok(());
        }
        let cause = format!(
            "the table reflects {} of the light that arrives at {degrees}° from the normal: more than it receives",
            significant(reflected * largest, 5)
        );
        let less = match scale_to(reflected) {
            Some(scale) => format!("write `scale = {scale}` or less, or "),
            None => String::new(),
        };
        let cure = format!("{less}check that its values are in sr⁻¹ and without cosine");
        Err(Fault::new(keys![], cause, cure))
    }
}

/// The largest number of three digits, as a scene file has it, that takes `reflected` to 1 at most;
/// none where that is no albedo.
fn scale_to(reflected: f64) -> Option<String> {
    let exact = (1.0 + 0.5 * ALLOWANCE) / reflected;
    if exact < LEAST_ALBEDO {
        return None;
    }
    let power = libm::log10(exact).floor() as i32 - 2;
    let digits = (exact / libm::exp10(f64::from(power))).floor();
    let scale: f64 = format!("{digits}e{power}").parse().ok()?;
    Some(if scale >= 1e-3 {
        scale.to_string()
    } else {
        format!("{scale:e}")
    })
}
