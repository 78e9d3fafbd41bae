//! Grids, spots and kernel of the published simulation from their decimal numbers, with as many
//! digits as are asked for.

use crate::model::{Kernel, PixelGrid, Published, Stagger};
use crate::num::multiprecision::{Digits, Real};

/// Lengths in inches.
pub(super) struct Geometry {
    digits: Digits,
    pub(super) elements: Vec<[Real; 3]>,
    root_two: Real,
    hinge: Real,
}

impl Geometry {
    pub(super) fn new(case: &Published, digits: Digits) -> Self {
        let root_two = digits.whole(2).sqrt();
        let hinge = digits.ratio(155, 10);
        let n = case.elements as i64;
        // Centres at (2 i + 1)·4/(2 n).
        let centre = |i: i64| digits.ratio((2 * i + 1) * 2, n);
        let near = digits.ratio(586_764, 100_000);
        let element = |at: i64| {
            let z = &(&near + &centre(at / n)) / &root_two;
            [&digits.whole(3) + &centre(at % n), &hinge - &z, z]
        };
        Self {
            digits,
            elements: (0..n * n).map(element).collect(),
            root_two,
            hinge,
        }
    }

    /// The different spots: of those that the layout has twice, one.
    pub(super) fn spots(&self, case: &Published) -> Vec<[Real; 2]> {
        let d = self.digits;
        let (n, h) = (case.per_side as i64, whole_thousandths(case.half_width));
        let centre = [
            d.whole(5),
            &self.hinge - &(&d.ratio(786_764, 100_000) * &self.root_two),
        ];
        let half = d.ratio(h, 1000);
        let mut different: Vec<([i64; 2], [Real; 2])> = Vec::new();
        for side in 0..4 {
            for i in 0..n {
                // In units of h/(n − 1) along, and of a thousandth of an inch across: equal keys
                // are equal spots.
                let along = if n == 1 { 0 } else { 2 * i - (n - 1) };
                let off = match case.stagger {
                    Stagger::None => 0,
                    Stagger::OneInch => [0, -1, 1][((i + 1) % 3) as usize],
                };
                let t = &half * &d.ratio(along, (n - 1).max(1));
                let o = d.whole(off);
                let [x, y] = match side {
                    0 => [t, &o - &half],
                    1 => [&half + &o, t],
                    2 => [&d.whole(0) - &t, &half + &o],
                    _ => [&o - &half, &d.whole(0) - &t],
                };
                let scaled = (n - 1).max(1);
                let across = |sign: i64| (sign * h + 1000 * off) * scaled;
                let key = match side {
                    0 => [along * h, across(-1)],
                    1 => [across(1), along * h],
                    2 => [-along * h, across(1)],
                    _ => [across(-1), -along * h],
                };
                if different.iter().all(|(k, _)| *k != key) {
                    different.push((key, [&centre[0] + &x, &centre[1] + &y]));
                }
            }
        }
        different.into_iter().map(|(_, spot)| spot).collect()
    }

    pub(super) fn pixels(&self, case: &Published) -> Vec<[Real; 2]> {
        let (d, n) = (self.digits, case.pixels as i64);
        // From 6.5 down to 3.25 and from 2.75 up to 6.
        let along = |k: i64| match case.grid {
            PixelGrid::Edges if n > 1 => d.ratio(325 * k, 100 * (n - 1)),
            _ => d.ratio(325 * (2 * k + 1), 200 * n),
        };
        let pixel = |p: i64| {
            [
                &d.ratio(65, 10) - &along(p % n),
                &d.ratio(275, 100) + &along(p / n),
            ]
        };
        (0..n * n).map(pixel).collect()
    }

    /// z2·root/R⁴.
    pub(super) fn g(&self, kernel: Kernel, [x, y]: &[Real; 2], element: usize) -> Real {
        let [x2, y2, z2] = &self.elements[element];
        let (dx, dy) = (x - x2, y - y2);
        let plane = &(&dy * &dy) + &(z2 * z2);
        let r2 = &(&dx * &dx) + &plane;
        let root = match kernel {
            Kernel::Published => (&plane / &self.digits.whole(2)).sqrt(),
            Kernel::Physical => &(&self.hinge - y) / &self.root_two,
        };
        &(z2 * &root) / &(&r2 * &r2)
    }
}

/// A length in thousandths of an inch.
fn whole_thousandths(length: f64) -> i64 {
    (1000.0 * length).round() as i64
}
