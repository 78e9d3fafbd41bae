//! Which picture is shown first: that of the assumption under which the photographs are likeliest.

use crate::num::digits::figure;
use crate::recovery::{Method, Recovered};

/// Evidences that differ by less, ln, do not tell: a factor of 20.
const TELLS: f64 = 3.0;

/// Why the picture of `method` is shown first.
pub(super) struct Preferred {
    pub(super) method: Method,
    pub(super) why: String,
}

/// Of methods that know how likely the photographs are by what they assume (`joint-gp`: neighbours
/// resemble one another; `joint-two-valued`: two levels in any pattern) the one of the largest
/// evidence; where it does not tell, the one that assumes less sharply, `joint-gp`. None where fewer
/// than two of them were tried.
pub(super) fn preferred(found: &[&Recovered]) -> Option<Preferred> {
    let known = found
        .iter()
        .filter_map(|f| Some((f.method, f.log_evidence?)));
    let mut known: Vec<(Method, f64)> = known.collect();
    known.sort_by(|a, b| b.1.total_cmp(&a.1));
    let [(first, best), (second, next), ..] = known[..] else {
        return None;
    };
    let ahead = best - next;
    if ahead >= TELLS {
        let why = format!(
            "shown first: what it assumes makes the photographs e^{} times likelier than what {second} \
             assumes",
            figure(ahead, 2)
        );
        return Some(Preferred { method: first, why });
    }
    let why = format!(
        "shown first: the photographs do not tell what {first} assumes from what {second} assumes \
         (a factor of e^{}), and it assumes less",
        figure(ahead, 2)
    );
    Some(Preferred {
        method: Method::JointGp,
        why,
    })
}
