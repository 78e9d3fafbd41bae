//! Many points at once.

use std::ops::Range;

use crate::geometry::{DVec3, Ray, ShapeId};
use crate::num::lanes::widest;

/// Points with their normals, laid out coordinate by coordinate for wide arithmetic, each with a weight. Points without weight stand
/// for light that goes nowhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Packet {
    position: [Vec<f64>; 3],
    normal: [Vec<f64>; 3],
    pub weight: Vec<f64>,
    pub shape: Vec<ShapeId>,
}

impl Packet {
    /// `n` points without weight.
    pub(super) fn dark(n: usize) -> Self {
        let zeros = || std::array::from_fn(|_| vec![0.0; n]);
        Self {
            position: zeros(),
            normal: zeros(),
            weight: vec![0.0; n],
            shape: vec![0; n],
        }
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.weight.len()
    }

    /// Replaces point `i`.
    pub(super) fn set(
        &mut self,
        i: usize,
        (position, normal): (DVec3, DVec3),
        weight: f64,
        shape: ShapeId,
    ) {
        for d in 0..3 {
            self.position[d][i] = position[d];
            self.normal[d][i] = normal[d];
        }
        self.weight[i] = weight;
        self.shape[i] = shape;
    }

    /// Puts the first `n` points on one flat shape with the normal `normal`.
    pub(super) fn fill_shape(&mut self, shape: ShapeId, normal: DVec3, n: usize) {
        for d in 0..3 {
            self.normal[d][..n].fill(normal[d]);
        }
        self.shape[..n].fill(shape);
    }

    /// Positions and weights of the first `n` points, to be written.
    pub(super) fn places_mut(&mut self, n: usize) -> ([&mut [f64]; 3], &mut [f64]) {
        (
            self.position.each_mut().map(|c| &mut c[..n]),
            &mut self.weight[..n],
        )
    }

    /// Point `i` with its normal.
    pub(super) fn point(&self, i: usize) -> (DVec3, DVec3) {
        let at = |c: &[Vec<f64>; 3]| DVec3::new(c[0][i], c[1][i], c[2][i]);
        (at(&self.position), at(&self.normal))
    }

    /// Takes the weight of the points from `first` on.
    pub(super) fn darken_from(&mut self, first: usize) {
        self.weight[first..].fill(0.0);
    }

    /// Points `range`.
    pub(super) fn part(&self, range: Range<usize>) -> Self {
        let cut = |v: &[f64]| v[range.clone()].to_vec();
        Self {
            position: self.position.each_ref().map(|c| cut(c)),
            normal: self.normal.each_ref().map(|c| cut(c)),
            weight: cut(&self.weight),
            shape: self.shape[range.clone()].to_vec(),
        }
    }

    /// factor · w_i · cosθ·cosθ_i/d_i² between one point and every point of the packet; visibility is no part of it.
    pub(super) fn forms_from(&self, (p, n): (DVec3, DVec3), factor: f64, out: &mut [f64]) {
        let count = self.len();
        let [x, y, z] = self.position.each_ref().map(|c| &c[..count]);
        let [a, b, c] = self.normal.each_ref().map(|c| &c[..count]);
        let (weight, out) = (&self.weight[..count], &mut out[..count]);
        widest(
            #[inline(always)]
            || {
                for i in 0..count {
                    let d = [x[i] - p.x, y[i] - p.y, z[i] - p.z];
                    out[i] = factor * weight[i] * form(d, n.to_array(), [a[i], b[i], c[i]]);
                }
            },
        );
    }

    /// cosθ·cosθ_i/d_i² between one point and every point of the packet; visibility is no part of it.
    pub(super) fn unit_forms_from(&self, (p, n): (DVec3, DVec3), out: &mut [f64]) {
        let count = self.len();
        let [x, y, z] = self.position.each_ref().map(|c| &c[..count]);
        let [a, b, c] = self.normal.each_ref().map(|c| &c[..count]);
        let out = &mut out[..count];
        widest(
            #[inline(always)]
            || {
                for i in 0..count {
                    let d = [x[i] - p.x, y[i] - p.y, z[i] - p.z];
                    out[i] = form(d, n.to_array(), [a[i], b[i], c[i]]);
                }
            },
        );
    }

    /// w_i · cosθ·cosθ_i/d_i² between point i of this packet and point i of `other`; visibility is no part of it.
    pub(super) fn forms_to(&self, other: &Self, out: &mut [f64]) {
        let count = self.len();
        let [x, y, z] = self.position.each_ref().map(|c| &c[..count]);
        let [a, b, c] = self.normal.each_ref().map(|c| &c[..count]);
        let [u, v, w] = other.position.each_ref().map(|c| &c[..count]);
        let [k, l, m] = other.normal.each_ref().map(|c| &c[..count]);
        let (weight, out) = (&self.weight[..count], &mut out[..count]);
        widest(
            #[inline(always)]
            || {
                for i in 0..count {
                    let d = [u[i] - x[i], v[i] - y[i], w[i] - z[i]];
                    out[i] = weight[i] * form(d, [a[i], b[i], c[i]], [k[i], l[i], m[i]]);
                }
            },
        );
    }

    /// Position of point `i`.
    pub(super) fn position(&self, i: usize) -> DVec3 {
        self.point(i).0
    }

    /// cosθ·cosθ_i/d_i² between point `i` and another.
    pub(super) fn form(&self, i: usize, (q, m): (DVec3, DVec3)) -> f64 {
        let (p, n) = self.point(i);
        form((q - p).to_array(), n.to_array(), m.to_array())
    }

    /// The segment from point `i` to `to`.
    pub(super) fn segment(&self, i: usize, to: DVec3) -> Option<Ray> {
        Ray::between(self.point(i).0, to)
    }
}

/// cosθ·cosθ′/d² for the segment d from a point with normal n to one with normal m: (n·d)(−m·d)/|d|⁴ where both fronts are seen, else 0.
#[inline(always)]
fn form(d: [f64; 3], n: [f64; 3], m: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (there, back, square) = (dot(n, d), -dot(m, d), dot(d, d));
    if there > 0.0 && back > 0.0 {
        there * back / (square * square)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::form;
    use super::*;

    /// Against the scalar form of the tracer, for points on all sides, coincident and dark ones among them.
    #[test]
    fn wide_forms_are_the_scalar_ones() {
        let spiral = |i: usize, r: f64| {
            let t = i as f64 * 0.7;
            DVec3::new(libm::cos(t), libm::sin(t), libm::sin(t * 0.37)) * (r + 0.01 * i as f64)
        };
        let n = 40;
        let (mut a, mut b) = (Packet::dark(n), Packet::dark(n));
        for i in 0..n {
            let at = if i == 5 {
                spiral(i, 2.0)
            } else {
                spiral(i, 1.0)
            };
            a.set(i, (at, spiral(i + 3, 1.0).normalize()), i as f64 * 0.1, 0);
            b.set(i, (spiral(i, 2.0), spiral(i + 20, 1.0).normalize()), 1.0, 1);
        }
        let mut out = vec![f64::NAN; n];
        a.forms_to(&b, &mut out);
        let mut from = vec![f64::NAN; n];
        b.forms_from(a.point(7), 3.0, &mut from);
        let expected = |p, q| form::form(p, q).map_or(0.0, |(f, _)| f);
        for i in 0..n {
            let close = |x: f64, y: f64| (x - y).abs() <= 1e-14 * y.abs();
            assert!(
                close(out[i], a.weight[i] * expected(a.point(i), b.point(i))),
                "{i}"
            );
            assert!(
                close(from[i], 3.0 * expected(a.point(7), b.point(i))),
                "{i}"
            );
        }
        assert!(out.iter().filter(|x| **x > 0.0).count() > 3);
    }
}
