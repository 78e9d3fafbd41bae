//! Pictures that contradict each other, though the photographs refute neither.

use crate::lab::fit::Judged;
use crate::num::digits::significant;
use crate::recovery::{Method, Recovered};

/// Methods whose standard errors are all that they may be off by, if what they assume holds.
const WHOLE: [Method; 3] = [
    Method::JointUnbounded,
    Method::JointGp,
    Method::JointTwoValued,
];
/// Root mean square distance of two pictures, in the errors of both, above which they contradict
/// each other: both know the same noise, so that it hardly shows between them.
const APART: f64 = 3.0;
/// Evidence that settles which of two is right, ln: the less likely one alone is contested.
const SETTLES: f64 = 10.0;

/// Says of each picture which other one that fits as well it contradicts most.
pub(in crate::lab) fn contest(all: &mut [(&Recovered, &mut Judged)]) {
    let stands = |k: usize| {
        let (found, judged) = &all[k];
        let fits = judged.fit.as_ref().is_some_and(|fit| fit.fits);
        fits && judged.shared().is_none() && WHOLE.contains(&found.method)
    };
    let standing: Vec<usize> = (0..all.len()).filter(|k| stands(*k)).collect();
    let worst = |k: usize| {
        let others = standing.iter().filter(|j| **j != k);
        let far = others.filter_map(|j| {
            let (own, other) = (all[k].0, all[*j].0);
            let apart = apart(own, other)?;
            let ahead = own.log_evidence.zip(other.log_evidence);
            let is_settled = ahead.is_some_and(|(own, other)| own - other > SETTLES);
            (apart > APART && !is_settled).then_some((other.method, apart))
        });
        far.reduce(|a, b| if b.1 > a.1 { b } else { a })
    };
    let found: Vec<_> = standing.iter().map(|k| (*k, worst(*k))).collect();
    for (k, against) in found {
        all[k].1.against = against;
    }
}

/// Root mean square distance in the errors of both.
fn apart(a: &Recovered, b: &Recovered) -> Option<f64> {
    let (own, other) = (a.standard_error.as_ref()?, b.standard_error.as_ref()?);
    let variance = own.zip_map(other, |a, b| a * a + b * b);
    let squares =
        (&a.reflectance - &b.reflectance).component_mul(&(&a.reflectance - &b.reflectance));
    let each = squares.iter().zip(&variance).filter(|(_, v)| **v > 0.0);
    let (sum, n) = each.fold((0.0, 0.0), |(sum, n), (d, v)| (sum + d / v, n + 1.0));
    (n > 0.0).then(|| (sum / n).sqrt())
}

/// What is said of it.
pub(super) fn contested(judged: &Judged) -> Option<String> {
    let (method, apart) = judged.against?;
    Some(format!(
        "{method} explains the photographs too, with another picture: the two lie {} of their standard errors \
         apart. What at least one of them assumes does not hold, and its errors and probabilities rest on that. \
         Look at both, and believe what they have in common",
        significant(apart, 3)
    ))
}
