//! Pictures that contradict each other, though the photographs refute neither.

use crate::lab::recovered::fit::{Judged, Rival};
use crate::num::digits::{figure, significant};
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

/// Evidence that tells one assumption from another, ln: a factor of 20.
pub(in crate::lab) const TELLS: f64 = 3.0;
/// Errors of another picture over those of two levels, from which on these are the assumption's.
const WIDER: f64 = 3.0;

/// Says of each picture which other one that fits as well it contradicts most, and of two levels
/// whether they are surer than the photographs make them.
pub(in crate::lab) fn contest(all: &mut [(&Recovered, &mut Judged)]) {
    let stands = |k: usize| {
        let (found, judged) = &all[k];
        let fits = judged.fit.as_ref().is_some_and(|fit| fit.fits);
        // With a free scale each picture has a unit of its own.
        let has_unit = found.nuisance.as_ref().is_none_or(|n| n.scale.is_none());
        fits && has_unit && judged.shared().is_none() && WHOLE.contains(&found.method)
    };
    let standing: Vec<usize> = (0..all.len()).filter(|k| stands(*k)).collect();
    let worst = |k: usize| {
        let others = standing.iter().filter(|j| **j != k);
        let rivals = others.filter_map(|j| rival(all[k].0, all[*j].0));
        rivals.reduce(|a, b| if b.apart > a.apart { b } else { a })
    };
    let found: Vec<_> = standing.iter().map(|k| (*k, worst(*k))).collect();
    for (k, against) in found {
        all[k].1.against = against;
    }
}

/// What `other` says against `own`; none where it says nothing.
fn rival(own: &Recovered, other: &Recovered) -> Option<Rival> {
    let (a, b) = (own.standard_error.as_ref()?, other.standard_error.as_ref()?);
    let variance = a.zip_map(b, |a, b| a * a + b * b);
    let off = &own.reflectance - &other.reflectance;
    let each = off.iter().zip(&variance).filter(|(_, v)| **v > 0.0);
    let (sum, n) = each.fold((0.0, 0.0), |(sum, n), (d, v)| (sum + d * d / v, n + 1.0));
    let both = own.log_evidence.zip(other.log_evidence);
    let found = Rival {
        method: other.method,
        apart: (n > 0.0).then(|| (sum / n).sqrt())?,
        wider: b.norm() / a.norm(),
        ahead: both.map(|(own, other)| own - other),
    };
    let is_settled = found.ahead.is_some_and(|ahead| ahead > SETTLES);
    let rests = is_surer(own.method, &found) || is_unlikelier(own.method, &found);
    (!is_settled && (found.apart > APART || rests)).then_some(found)
}

/// Whether alike neighbours are what another assumption makes less likely.
fn is_unlikelier(own: Method, rival: &Rival) -> bool {
    own == Method::JointGp && rival.ahead.is_some_and(|ahead| ahead < -TELLS)
}

/// Whether two levels are surer than another assumption as likely makes them.
fn is_surer(own: Method, rival: &Rival) -> bool {
    own == Method::JointTwoValued && rival.ahead.is_some() && rival.wider > WIDER
}

/// What is said of it, of the picture of `own`.
pub(super) fn contested(own: Method, judged: &Judged) -> Option<String> {
    let Rival {
        method,
        apart,
        wider,
        ahead,
    } = judged.against?;
    if apart > APART {
        return Some(format!(
            "{method} explains the photographs too, with another picture: the two lie {} of their standard \
             errors apart. What at least one of them assumes does not hold, and its errors and probabilities \
             rest on that. Look at both, and believe what they have in common",
            significant(apart, 3)
        ));
    }
    if own == Method::JointGp {
        return Some(format!(
            "its errors and bands hold if neighbours resemble one another, and are too small if they do not: \
             what {method} assumes makes the photographs likelier, by e^{}. Look at its picture as well",
            figure(-ahead?, 2)
        ));
    }
    let likelier = match ahead? {
        ahead if ahead > 0.0 => format!("make likelier by e^{} alone", figure(ahead, 2)),
        ahead => format!("make less likely, by e^{}", figure(-ahead, 2)),
    };
    Some(format!(
        "its errors and probabilities hold if there are two reflectances and no more, which the photographs \
         {likelier}: {method} explains them too, with errors {} times as large. Look at its picture as well",
        significant(wider, 2)
    ))
}
