//! A head on shoulders.

use super::Triangles;
use super::grid::closed;
use crate::geometry::DVec3;
use std::f64::consts::TAU;

/// How far a cross-section reaches at a height: to the sides, to the front, to the back.
type Section = [f64; 4];

/// From the rim of the base to the crown: height, half width, depth to the front and to the back.
const SECTIONS: [Section; 21] = [
    [0.000, 0.310, 0.130, 0.120],
    [0.080, 0.330, 0.150, 0.135],
    [0.170, 0.365, 0.160, 0.145],
    [0.245, 0.395, 0.155, 0.145],
    [0.310, 0.395, 0.140, 0.135],
    [0.355, 0.340, 0.115, 0.120],
    [0.390, 0.235, 0.085, 0.105],
    [0.420, 0.140, 0.066, 0.092],
    [0.460, 0.090, 0.058, 0.085],
    [0.510, 0.080, 0.057, 0.082],
    [0.545, 0.080, 0.068, 0.084],
    [0.566, 0.094, 0.112, 0.088],
    [0.590, 0.103, 0.130, 0.096],
    [0.640, 0.118, 0.136, 0.112],
    [0.700, 0.131, 0.139, 0.132],
    [0.770, 0.139, 0.142, 0.150],
    [0.840, 0.141, 0.141, 0.156],
    [0.900, 0.131, 0.127, 0.145],
    [0.950, 0.104, 0.098, 0.114],
    [0.985, 0.059, 0.055, 0.064],
    [1.000, 0.000, 0.000, 0.000],
];
/// Share of the latitudes that the flat base takes.
const BASE: f64 = 0.1;

/// A bump or hollow of the face or the ears: where (x, z), how far to either side, below and above,
/// and how high; x counts to both sides, and the face is where y < 0.
type Feature = [f64; 6];

const FEATURES: [Feature; 9] = [
    // Nose: its bridge and its tip.
    [0.000, 0.725, 0.013, 0.030, 0.040, 0.018],
    [0.000, 0.688, 0.017, 0.011, 0.026, 0.030],
    // Eyes, and the brows above them.
    [0.046, 0.752, 0.019, 0.013, 0.013, -0.015],
    [0.044, 0.787, 0.026, 0.010, 0.016, 0.006],
    // Lips, and the hollow below them.
    [0.000, 0.645, 0.026, 0.006, 0.006, 0.007],
    [0.000, 0.629, 0.022, 0.006, 0.006, 0.007],
    [0.000, 0.610, 0.028, 0.007, 0.007, -0.007],
    // Chin and cheeks.
    [0.000, 0.585, 0.024, 0.014, 0.014, 0.009],
    [0.062, 0.705, 0.020, 0.020, 0.020, 0.006],
];

/// How far a feature stands out at a point of the face.
fn out([at_x, at_z, half, below, above, height]: Feature, x: f64, z: f64) -> f64 {
    let upright = if z < at_z { below } else { above };
    let (a, b) = ((x.abs() - at_x) / half, (z - at_z) / upright);
    height * libm::exp(-0.5 * (a * a + b * b))
}

/// A person's head and shoulders as a closed body of at least `faces` triangles, wound outwards: 1
/// high, standing on z = 0 at the origin, face towards −y, about 0.8 wide. u is the longitude (0
/// and 1 at the back, 0.5 in the face), v is the height z. The same for the same `faces` on every
/// machine.
pub fn bust(faces: usize) -> Triangles {
    closed(faces, |u, v| {
        // From the back (+y) counterclockwise seen from above.
        let angle = TAU * u;
        let (x, y) = (-libm::sin(angle), libm::cos(angle));
        let point = if v < BASE {
            place(SECTIONS[0], x, y) * DVec3::new(v / BASE, v / BASE, 0.0)
        } else {
            place(section((v - BASE) / (1.0 - BASE)), x, y)
        };
        (point, point.z)
    })
}

/// The point of a cross-section in the direction (x, y) from its middle.
fn place([z, half, front, back]: Section, x: f64, y: f64) -> DVec3 {
    let depth = if y < 0.0 { front } else { back };
    let round = DVec3::new(half * x, depth * y, z);
    // The features fade out towards the temples; the ears stand on the sides.
    let facing = (-y).max(0.0);
    let face: f64 = FEATURES.map(|f| out(f, round.x, z)).iter().sum();
    let (along, up) = ((y - 0.05) / 0.16, (z - 0.725) / 0.026);
    let ear = 0.024 * libm::exp(-(along * along) - up * up) * x;
    round + DVec3::new(ear, -face * facing * facing, 0.0)
}

/// The cross-section at t in \[0, 1\] from the base to the crown: a Catmull–Rom curve through
/// [`SECTIONS`].
fn section(t: f64) -> Section {
    let last = SECTIONS.len() - 1;
    let at = (t * last as f64).clamp(0.0, last as f64);
    let k = (at as usize).min(last - 1);
    let s = at - k as f64;
    // Beyond the crown the curve comes down as it went up, beyond the base it goes on straight.
    let before = match k {
        0 => std::array::from_fn(|i| 2.0 * SECTIONS[0][i] - SECTIONS[1][i]),
        _ => SECTIONS[k - 1],
    };
    let after = if k + 2 > last {
        let [z, half, front, back] = SECTIONS[last - 1];
        [z, -half, -front, -back]
    } else {
        SECTIONS[k + 2]
    };
    let (from, to) = (SECTIONS[k], SECTIONS[k + 1]);
    std::array::from_fn(|i| {
        let (a, b, c, d) = (before[i], from[i], to[i], after[i]);
        b + 0.5 * s * (c - a + s * (2.0 * a - 5.0 * b + 4.0 * c - d + s * (3.0 * (b - c) + d - a)))
    })
}
