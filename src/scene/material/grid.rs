//! Measured BRDFs as text: one line for each pair of directions.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::geometry::DVec3;
use crate::num::digits::significant;
use crate::num::quadrature::Rule;
use crate::scene::error::{Fault, keys};

/// An isotropic BRDF over the polar angles of both directions and the angle between their azimuths.
///
/// The file is comma-separated text. Its first line is `theta_i,theta_o,phi,value`; every other one
/// states a value in sr⁻¹ (without cosine), 0 or more, for polar angles from 0 to 90 and an azimuth
/// from 0 to 180, in degrees: at φ = 0 both directions are on the same side of the normal (light
/// returns), at φ = 180 on opposite ones (a mirror). Empty lines and lines that begin with `#` are
/// skipped. The triples, in any order, are a complete grid: each θ_i with each θ_o with each φ,
/// once; θ_i and θ_o take the same values.
///
/// f_r is multilinear between the lines and constant beyond the outermost angles, so that a table
/// of one line is Lambertian; one whose polar angles end as if in radians is refused. φ is folded
/// to [0, 180]. Values for (θ_i, θ_o) and (θ_o, θ_i) that differ by no more than a twentieth of the
/// larger are averaged, so the BRDF is exactly reciprocal; others are refused.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    theta: Axis,
    phi: Axis,
    /// Entry φ + n_φ (o + n_θ i), sr⁻¹.
    values: Vec<f64>,
}

const HEADER: &str = "theta_i,theta_o,phi,value";
/// No table in degrees ends so near to the normal: one in radians ends at π/2 at most.
const RADIANS: f64 = 1.6;
/// Largest share by which exchanged directions may differ.
const RECIPROCITY: f64 = 0.05;

/// Ascending angles in radians.
#[derive(Clone, Debug, PartialEq)]
struct Axis {
    nodes: Vec<f64>,
    /// The interval in which each of a number of equal divisions of the axis begins.
    starts: Vec<u32>,
}

impl Axis {
    fn new(degrees: &[f64]) -> Self {
        let nodes: Vec<f64> = degrees.iter().map(|x| x.to_radians()).collect();
        let divisions = 4 * nodes.len();
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
        let start = |k: usize| {
            let x = first + (last - first) * k as f64 / divisions as f64;
            let after = nodes.partition_point(|node| *node <= x);
            after.saturating_sub(1).min(nodes.len().saturating_sub(2)) as u32
        };
        let starts = (0..divisions).map(start).collect();
        Self { nodes, starts }
    }

    /// The two nodes around `x`, and the weight of the second.
    fn between(&self, x: f64) -> (usize, usize, f64) {
        let nodes = &self.nodes;
        let last = nodes.len() - 1;
        if x <= nodes[0] {
            return (0, 0, 0.0);
        }
        if x >= nodes[last] {
            return (last, last, 0.0);
        }
        let share = (x - nodes[0]) / (nodes[last] - nodes[0]);
        let division = (share * self.starts.len() as f64) as usize;
        let mut k = self.starts[division.min(self.starts.len() - 1)] as usize;
        // Rounding may place x one division too high.
        while k > 0 && nodes[k] > x {
            k -= 1;
        }
        while nodes[k + 1] <= x {
            k += 1;
        }
        (k, k + 1, (x - nodes[k]) / (nodes[k + 1] - nodes[k]))
    }

    /// What each node contributes to the integral of `density` times a function that is linear
    /// between them and constant beyond, from 0 to `end`.
    fn weights(&self, end: f64, density: impl Fn(f64) -> f64) -> Vec<f64> {
        let rule = Rule::gauss_legendre(PER_INTERVAL);
        let (nodes, last) = (&self.nodes, self.nodes.len() - 1);
        let mut weights = vec![0.0; nodes.len()];
        let ends = [(0.0, nodes[0]), (nodes[last], end)];
        let between = nodes.windows(2).map(|pair| (pair[0], pair[1]));
        for (a, b) in between.chain(ends).filter(|(a, b)| a < b) {
            for (x, w) in rule.on(a, b) {
                let (first, second, share) = self.between(x);
                weights[first] += w * density(x) * (1.0 - share);
                weights[second] += w * density(x) * share;
            }
        }
        weights
    }
}

/// Nodes of an interval: exact to rounding for sinθ cosθ over a right angle.
const PER_INTERVAL: usize = 16;

/// A line of the file: its number, three angles in degrees and the value.
struct Line {
    number: usize,
    angles: [f64; 3],
    value: f64,
}

impl Grid {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let text = std::str::from_utf8(bytes).map_err(|e| {
            let cause = format!("the table is not text: byte {}", e.valid_up_to());
            refusal(cause, "save it as UTF-8")
        })?;
        let lines = lines(text.trim_start_matches('\u{feff}'))?;
        let axis = |which: &[usize]| {
            let mut all: Vec<f64> = lines
                .iter()
                .flat_map(|l| which.iter().map(|k| l.angles[*k]))
                .collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all
        };
        let (theta, phi) = (axis(&[0, 1]), axis(&[2]));
        let steepest = theta.last().copied().unwrap_or(0.0);
        if steepest > 0.0 && steepest < RADIANS {
            let cause = format!(
                "the polar angles end at {steepest}, as if they were in radians: all steeper light would have the value there"
            );
            return Err(refusal(
                cause,
                "write angles in degrees, 0 to 90 and 0 to 180",
            ));
        }
        let (nt, np) = (theta.len(), phi.len());
        let size = nt.checked_mul(nt).and_then(|n| n.checked_mul(np));
        let complete = size.filter(|n| *n <= 4 * lines.len());
        let Some(size) = complete else {
            let cause = format!(
                "{nt} polar angles and {np} azimuths make {nt} × {nt} × {np} triples, and the table has {}",
                lines.len()
            );
            return Err(refusal(cause, COMPLETE));
        };
        let position = |axis: &[f64], x: f64| axis.partition_point(|node| *node < x);
        let mut values = vec![0.0; size];
        let mut stated = vec![0usize; size];
        for line in &lines {
            let [i, o, p] = line.angles;
            let entry = position(&phi, p) + np * (position(&theta, o) + nt * position(&theta, i));
            if stated[entry] > 0 {
                let cause = format!(
                    "line {}: θ_i = {i}, θ_o = {o}, φ = {p} was stated in line {} already",
                    line.number, stated[entry]
                );
                return Err(refusal(cause, "keep one of the two lines"));
            }
            stated[entry] = line.number;
            values[entry] = line.value;
        }
        if let Some(entry) = stated.iter().position(|n| *n == 0) {
            let last = lines.last().map_or(1, |l| l.number);
            let (i, o, p) = (entry / np / nt, entry / np % nt, entry % np);
            let cause = format!(
                "no line up to the last, {last}, states θ_i = {}, θ_o = {}, φ = {}",
                theta[i], theta[o], phi[p]
            );
            return Err(refusal(cause, COMPLETE));
        }
        for i in 0..nt {
            for o in 0..i {
                for (p, azimuth) in phi.iter().enumerate() {
                    let (a, b) = (p + np * (o + nt * i), p + np * (i + nt * o));
                    let (x, y) = (values[a], values[b]);
                    if (x - y).abs() > RECIPROCITY * x.max(y) {
                        let cause = format!(
                            "lines {} and {}: {} and {} sr⁻¹ for the same two directions exchanged (θ = {} and {}, φ = {}): \
                             a surface reflects as much either way",
                            stated[a],
                            stated[b],
                            significant(x, 6),
                            significant(y, 6),
                            theta[i],
                            theta[o],
                            azimuth
                        );
                        let cure = format!(
                            "let them differ by {} % of the larger at most, or check that values are without cosine",
                            RECIPROCITY * 100.0
                        );
                        return Err(refusal(cause, &cure));
                    }
                    let mean = 0.5 * (x + y);
                    (values[a], values[b]) = (mean, mean);
                }
            }
        }
        Ok(Self {
            theta: Axis::new(&theta),
            phi: Axis::new(&phi),
            values,
        })
    }

    /// Each polar angle of the table, degrees, and the share ∫ f_r cosθ dω of the light from there
    /// that is reflected, to rounding. Between the angles it is linear: the largest is one of
    /// these.
    pub(super) fn albedos(&self) -> Vec<[f64; 2]> {
        let polar = self
            .theta
            .weights(FRAC_PI_2, |t| libm::sin(t) * libm::cos(t));
        let azimuth = self.phi.weights(PI, |_| 2.0);
        let (nt, np) = (polar.len(), azimuth.len());
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let of = |(i, theta): (usize, &f64)| {
            let rows = self.values[np * nt * i..][..np * nt].chunks(np);
            let along: Vec<f64> = rows.map(|row| dot(row, &azimuth)).collect();
            [theta.to_degrees(), dot(&along, &polar)]
        };
        self.theta.nodes.iter().enumerate().map(of).collect()
    }

    /// f_r of directions above the surface, sr⁻¹.
    pub(super) fn brdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let polar = |w: DVec3| libm::atan2((w.x * w.x + w.y * w.y).sqrt(), w.z);
        let along = wi.x * wo.x + wi.y * wo.y;
        let aside = wi.x * wo.y - wi.y * wo.x;
        let i = self.theta.between(polar(wi));
        let o = self.theta.between(polar(wo));
        let (p0, p1, p) = self.phi.between(libm::atan2(aside.abs(), along));
        let (nt, np) = (self.theta.nodes.len(), self.phi.nodes.len());
        let at = |i: usize, o: usize| {
            let row = &self.values[np * (o + nt * i)..][..np];
            row[p0] + p * (row[p1] - row[p0])
        };
        // Written so that exchanging the directions exchanges equal terms.
        let straight = (1.0 - i.2) * (1.0 - o.2) * at(i.0, o.0) + i.2 * o.2 * at(i.1, o.1);
        let crossed = i.2 * (1.0 - o.2) * at(i.1, o.0) + (1.0 - i.2) * o.2 * at(i.0, o.1);
        straight + crossed
    }
}

const COMPLETE: &str = "state each θ_i with each θ_o (the same angles) and each φ, once";

fn refusal(cause: String, cure: &str) -> Fault {
    Fault::new(keys![], cause, cure)
}

fn lines(text: &str) -> Result<Vec<Line>, Fault> {
    let mut written = text
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let bare = |line: &str| line.replace(char::is_whitespace, "");
    match written.next() {
        Some((_, line)) if bare(line) == HEADER => {}
        Some((n, line)) => {
            let start: String = line.chars().take(60).collect();
            let cause = format!("line {n}: `{start}` is not the header");
            return Err(refusal(cause, &format!("begin with the line `{HEADER}`")));
        }
        None => {
            let cause = "the table is empty".to_owned();
            return Err(refusal(cause, &format!("begin with the line `{HEADER}`")));
        }
    }
    let mut all = Vec::new();
    for (number, line) in written {
        let fields: Vec<Option<f64>> = line.split(',').map(|x| x.trim().parse().ok()).collect();
        let [Some(i), Some(o), Some(p), Some(value)] = fields[..] else {
            let start: String = line.chars().take(60).collect();
            let cause = format!("line {number}: `{start}` is not four numbers");
            let cure = "write θ_i, θ_o, φ in degrees and the value in sr⁻¹, with commas between";
            return Err(refusal(cause, cure));
        };
        for (name, x, most) in [("θ_i", i, 90.0), ("θ_o", o, 90.0), ("φ", p, 180.0)] {
            if !(0.0..=most).contains(&x) {
                let cause = format!("line {number}: {name} is {x}°");
                let cure = format!("use 0 to {most} degrees (fold φ above 180 to 360 − φ)");
                return Err(refusal(cause, &cure));
            }
        }
        if !(value >= 0.0 && value.is_finite()) {
            let cause = format!("line {number}: a BRDF of {value} sr⁻¹");
            return Err(refusal(cause, "use a finite number, 0 or more"));
        }
        // −0 and 0 are one angle.
        all.push(Line {
            number,
            angles: [i + 0.0, o + 0.0, p + 0.0],
            value,
        });
    }
    if all.is_empty() {
        let cause = "the table has a header and no values".to_owned();
        return Err(refusal(cause, COMPLETE));
    }
    Ok(all)
}

#[cfg(test)]
pub(super) mod tests;
