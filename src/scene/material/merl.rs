//! The MERL database's binary tables.

use std::f64::consts::{FRAC_PI_2, PI};

use serde::{Deserialize, Serialize};

use crate::geometry::DVec3;
use crate::scene::error::{Fault, keys};

/// Which of the three colours of a MERL table.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// The first.
    Red,
    /// The second.
    Green,
    /// The third.
    Blue,
}

/// An isotropic BRDF over Rusinkiewicz' half and difference angles (W. Matusik, H. Pfister, M.
/// Brand and L. McMillan, *A data-driven reflectance model*, 2003).
///
/// The file: three little-endian `i32` n_h, n_d, n_φ (90, 90, 180), then 3 n_h n_d n_φ
/// little-endian `f64`, red, green, blue; entry φ + n_φ (d + n_d h) of a colour, times 1/1500,
/// 1.15/1500 or 1.66/1500, is f_r in sr⁻¹. Entry (h, d, φ) covers
///
/// > θ_h ∈ (π/2) \[(h/n_h)², ((h + 1)/n_h)²),   θ_d ∈ (π/2) \[d, d + 1)/n_d,   φ_d ∈ π \[φ, φ + 1)/n_φ
///
/// and stands here for the middle of those intervals (of √θ_h); between the middles f_r is
/// trilinear in (√θ_h, θ_d, φ_d), beyond the outermost it is constant. Exchanging the two
/// directions turns φ_d by π, the table's period, so the interpolated BRDF is reciprocal. Negative
/// entries mark what could not be measured: such an entry takes the value of the next smaller θ_h
/// at the same (θ_d, φ_d), or 0 where there is none. Entries of directions below the surface are
/// negative too, and mean nothing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Merl {
    /// sr⁻¹.
    values: Vec<f64>,
    /// Share of the entries of directions above the surface that was not measured.
    unmeasured: f64,
}

/// n_h, n_d, n_φ.
const COUNT: [usize; 3] = [90, 90, 180];
const HEADER_BYTES: usize = 12;
/// Bytes of one colour.
const SIZE: usize = 8 * COUNT[0] * COUNT[1] * COUNT[2];

impl Merl {
    pub(super) fn read(bytes: &[u8], channel: Channel) -> Result<Self, Fault> {
        let refuse = |cause: String| {
            let cure = "give a file of the MERL database as published: 90 × 90 × 180 entries of three colours";
            Err(Fault::new(keys![], cause, cure))
        };
        let Some((header, body)) = bytes.split_at_checked(HEADER_BYTES) else {
            return refuse(format!(
                "a MERL table of {} bytes: it is cut off in its header",
                bytes.len()
            ));
        };
        let mut written = [0i32; 3];
        for (n, raw) in written.iter_mut().zip(header.as_chunks::<4>().0) {
            *n = i32::from_le_bytes(*raw);
        }
        if written.map(i64::from) != COUNT.map(|n| n as i64) {
            let [h, d, p] = written;
            return refuse(format!("a MERL table of {h} × {d} × {p} entries"));
        }
        if body.len() != 3 * SIZE {
            return refuse(format!(
                "a MERL table needs {} bytes after its header, and {} follow",
                3 * SIZE,
                body.len()
            ));
        }
        let (colour, scale) = match channel {
            Channel::Red => (0, 1.0 / 1500.0),
            Channel::Green => (1, 1.15 / 1500.0),
            Channel::Blue => (2, 1.66 / 1500.0),
        };
        let raw = body[colour * SIZE..(colour + 1) * SIZE].as_chunks::<8>().0;
        let is_possible = possible();
        let (mut unmeasured, mut all) = (0usize, 0usize);
        let [_, d, p] = COUNT;
        let mut values = Vec::with_capacity(raw.len());
        for (i, entry) in raw.iter().enumerate() {
            let value = f64::from_le_bytes(*entry) * scale;
            if !value.is_finite() {
                return refuse(format!("entry {i} of the MERL table is {value}"));
            }
            let nearer = i.checked_sub(d * p).map_or(0.0, |k| values[k]);
            values.push(if value < 0.0 { nearer } else { value });
            all += usize::from(is_possible[i]);
            unmeasured += usize::from(is_possible[i] && value < 0.0);
        }
        if unmeasured == all {
            return refuse(
                "all entries of the MERL table are negative: none was measured".to_owned(),
            );
        }
        Ok(Self {
            values,
            unmeasured: unmeasured as f64 / all as f64,
        })
    }

    /// Share of the entries of directions above the surface that was not measured.
    pub(super) fn unmeasured(&self) -> f64 {
        self.unmeasured
    }

    /// f_r of directions above the surface, sr⁻¹.
    pub(super) fn brdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let [theta_h, theta_d, phi_d] = half_difference(wi, wo);
        let [nh, nd, np] = COUNT;
        let (h0, h1, h) = between((theta_h / FRAC_PI_2).sqrt(), nh);
        let (d0, d1, d) = between(theta_d / FRAC_PI_2, nd);
        let x = phi_d / PI * np as f64 - 0.5;
        let turn = x.floor();
        let p = x - turn;
        let p0 = (turn as i64).rem_euclid(np as i64) as usize;
        let p1 = if p0 + 1 == np { 0 } else { p0 + 1 };
        let along = |h: usize, d: usize| {
            let row = &self.values[np * (d + nd * h)..][..np];
            row[p0] + p * (row[p1] - row[p0])
        };
        let across = |h: usize| along(h, d0) + d * (along(h, d1) - along(h, d0));
        across(h0) + h * (across(h1) - across(h0))
    }
}

/// Whether both directions of each entry's middle are above the surface:
///
/// > cosθ_h cosθ_d ± sinθ_h sinθ_d cosφ_d > 0.
fn possible() -> Vec<bool> {
    let [nh, nd, np] = COUNT;
    let middle = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
    let entry = |i: usize| {
        let (h, d, p) = (i / (nd * np), i / np % nd, i % np);
        let (sin_h, cos_h) = libm::sincos(FRAC_PI_2 * middle(h, nh).powi(2));
        let (sin_d, cos_d) = libm::sincos(FRAC_PI_2 * middle(d, nd));
        cos_h * cos_d > sin_h * sin_d * libm::cos(PI * middle(p, np)).abs()
    };
    (0..nh * nd * np).map(entry).collect()
}

/// The two entries around `x` ∈ [0, 1] of `n`, whose places are the middles (k + ½)/n, and the
/// weight of the second.
fn between(x: f64, n: usize) -> (usize, usize, f64) {
    let place = (x * n as f64 - 0.5).clamp(0.0, (n - 1) as f64);
    let low = place as usize;
    (low, (low + 1).min(n - 1), place - low as f64)
}

/// θ_h, θ_d and φ_d (Rusinkiewicz, *A new change of variables for efficient BRDF representation*,
/// 1998): the half vector, and the incident direction in the frame where that is the pole.
fn half_difference(wi: DVec3, wo: DVec3) -> [f64; 3] {
    let h = (wi + wo).normalize();
    let across = (h.x * h.x + h.y * h.y).sqrt();
    let (cos, sin) = if across > 0.0 {
        (h.x / across, h.y / across)
    } else {
        (1.0, 0.0)
    };
    let x = wi.dot(DVec3::new(h.z * cos, h.z * sin, -across));
    let y = wi.y * cos - wi.x * sin;
    [
        libm::atan2(across, h.z),
        libm::atan2((x * x + y * y).sqrt(), wi.dot(h)),
        libm::atan2(y, x),
    ]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene::material::tests::directions;

    /// The bytes of a table whose entries are `f`(θ_h, θ_d, φ_d) at their middles, in every colour.
    pub(in crate::scene::material) fn written(f: impl Fn(f64, f64, f64) -> f64) -> Vec<u8> {
        let mut bytes = Vec::new();
        for n in COUNT {
            bytes.extend(i32::try_from(n).unwrap().to_le_bytes());
        }
        let middle = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
        for scale in [1500.0, 1500.0 / 1.15, 1500.0 / 1.66] {
            for h in 0..COUNT[0] {
                for d in 0..COUNT[1] {
                    for p in 0..COUNT[2] {
                        let value = f(
                            FRAC_PI_2 * middle(h, COUNT[0]).powi(2),
                            FRAC_PI_2 * middle(d, COUNT[1]),
                            PI * middle(p, COUNT[2]),
                        );
                        bytes.extend((value * scale).to_le_bytes());
                    }
                }
            }
        }
        bytes
    }

    /// A table made of a known function gives it back between its entries: error of linear
    /// interpolation, ⅛ Δ² max|f″| an axis.
    #[test]
    fn a_synthetic_table_is_the_function_it_was_made_of() {
        let f = |h: f64, d: f64, p: f64| {
            (0.3 + 0.2 * (2.0 * p).cos() * d.sin().powi(2)) * (-h / 0.5).exp()
        };
        for (channel, _) in [(Channel::Red, 0), (Channel::Green, 1), (Channel::Blue, 2)] {
            let table = Merl::read(&written(f), channel).unwrap();
            let mut worst: f64 = 0.0;
            for (i, o) in directions(4000) {
                let [h, d, p] = half_difference(i, o);
                let inside = |x: f64| x > 0.5 / 90.0 && x < 89.5 / 90.0;
                if inside((h / FRAC_PI_2).sqrt()) && inside(d / FRAC_PI_2) {
                    worst = worst.max((table.brdf(i, o) - f(h, d, p)).abs());
                }
            }
            assert!(worst < 3e-4, "{worst}");
        }
    }

    /// The half vector bisects: of a mirror pair θ_h = 0 and θ_d is the angle of incidence; of one
    /// direction twice θ_d = 0.
    #[test]
    fn half_and_difference_angles() {
        for theta in [0.1, 0.7, 1.3f64] {
            let (s, c) = theta.sin_cos();
            let [h, d, _] = half_difference(DVec3::new(s, 0.0, c), DVec3::new(-s, 0.0, c));
            assert!(h.abs() < 1e-14 && (d - theta).abs() < 1e-14);
            let [h, d, _] = half_difference(DVec3::new(0.0, s, c), DVec3::new(0.0, s, c));
            assert!((h - theta).abs() < 1e-14 && d.abs() < 1e-7);
        }
        // Both in the plane of the normal: φ_d is 0 or π; aside of it, ±π/2.
        let at = |x: f64| DVec3::new(x, 0.0, (1.0 - x * x).sqrt());
        let [_, _, p] = half_difference(at(0.8), at(0.1));
        assert!(p.abs() < 1e-12, "{p}");
        let [_, _, p] = half_difference(
            DVec3::new(0.5, 0.6, 0.39f64.sqrt()),
            DVec3::new(0.5, -0.6, 0.39f64.sqrt()),
        );
        assert!((p - FRAC_PI_2).abs() < 1e-12, "{p}");
    }

    #[test]
    fn entries_that_were_not_measured_take_their_neighbour() {
        let f = |h: f64, _: f64, _: f64| if h > 0.8 { -1.0 } else { 0.2 };
        let table = Merl::read(&written(f), Channel::Red).unwrap();
        assert!(table.values.iter().all(|v| (v - 0.2).abs() < 1e-15));
    }

    /// Directions from their angles: what lies below the surface is not missed, of the rest the
    /// share that is. A table of none is refused.
    #[test]
    fn the_share_that_was_not_measured_is_of_directions_above_the_surface() {
        let above = |h: f64, d: f64, p: f64| {
            let half = DVec3::new(h.sin(), 0.0, h.cos());
            let along = DVec3::new(h.cos(), 0.0, -h.sin());
            let aside = DVec3::new(0.0, 1.0, 0.0);
            let across = along * p.cos() + aside * p.sin();
            let [wi, wo] = [1.0, -1.0].map(|s| half * d.cos() + across * (s * d.sin()));
            wi.z > 0.0 && wo.z > 0.0
        };
        let read = |f: &dyn Fn(f64, f64, f64) -> f64| Merl::read(&written(f), Channel::Green);
        let whole = read(&|h, d, p| if above(h, d, p) { 0.2 } else { -1.0 }).unwrap();
        assert_eq!(whole.unmeasured(), 0.0);
        // Of φ_d and π − φ_d either both directions are above the surface or neither.
        let half = |_: f64, _: f64, p: f64| if p < FRAC_PI_2 { 0.2 } else { -1.0 };
        assert_eq!(read(&half).unwrap().unmeasured(), 0.5);
        for none in [-1.0, f64::NEG_INFINITY] {
            let beyond = |h, d, p| if above(h, d, p) { none } else { 0.2 };
            assert!(read(&beyond).is_err(), "{none}");
        }
        let fault = read(&|_, _, _| -1.0).unwrap_err();
        assert!(fault.cause.contains("none was measured"), "{}", fault.cause);
    }

    #[test]
    fn forged_and_cut_tables_are_refused() {
        let good = written(|_, _, _| 0.1);
        assert!(Merl::read(&good, Channel::Blue).is_ok());
        let headed = |count: [i32; 3]| {
            let mut bytes = good.clone();
            bytes[..12].copy_from_slice(&count.map(i32::to_le_bytes).concat());
            bytes
        };
        let mut longer = good.clone();
        longer.push(0);
        let mut infinite = good.clone();
        infinite[12..20].copy_from_slice(&f64::INFINITY.to_le_bytes());
        for (bytes, cause) in [
            (&good[..7], "cut off in its header"),
            (&good[..good.len() - 1], "34991999 follow"),
            (&longer[..], "34992001 follow"),
            (&headed([-90, -90, 180])[..], "-90 × -90 × 180 entries"),
            (&headed([i32::MAX; 3])[..], "2147483647 × 2147483647"),
            // As many bytes.
            (&headed([90, 180, 90])[..], "90 × 180 × 90 entries"),
            (&headed([180, 90, 90])[..], "180 × 90 × 90 entries"),
            (&infinite[..], "entry 0"),
        ] {
            let fault = Merl::read(bytes, Channel::Red).unwrap_err();
            assert!(fault.cause.contains(cause), "{}", fault.cause);
        }
    }
}
