//! Under which assumption the photographs are likelier.

use nalgebra::DVector;

use super::doubt::TELLS;
use crate::num::digits::figure;
use crate::recovery::{Method, Recovered};

/// Of the methods that know how likely the photographs are by what they assume (`joint-gp`:
/// neighbours resemble one another; `joint-two-valued`: two levels in any pattern) the one of the
/// largest evidence, unless its picture is a pattern of a larger expected squared error ([`loss`]);
/// and by how much which assumption is likelier. None where fewer than two of them know: a sum over
/// patterns that is not to be believed does not. Every error of the model counts as evidence
/// against both, the stiffer one more.
pub(super) fn likelier(found: &[&Recovered]) -> Option<(Method, String)> {
    let known = found.iter().copied();
    let known = known.filter_map(|f| Some((f, f.log_evidence?, mean(f)?)));
    let mut known: Vec<(&Recovered, f64, &DVector<f64>)> = known.collect();
    known.sort_by(|a, b| b.1.total_cmp(&a.1));
    let [(likeliest, best, _), (next, less, _), ..] = known[..] else {
        return None;
    };
    let is_far = likeliest.patterns.is_some() && loss(next, &known) < loss(likeliest, &known);
    let first = if is_far { next } else { likeliest };
    let (a, b) = (likeliest.method, next.method);
    let ahead = best - less;
    let mut words = if ahead < TELLS {
        format!("The photographs do not tell what {a} assumes from what {b} assumes")
    } else {
        format!(
            "What {a} assumes makes the photographs e^{} times likelier than what {b} assumes",
            figure(ahead, 2)
        )
    };
    if is_far {
        words += &format!(", and the picture of {a} is expected to be further off");
    }
    Some((first.method, words + "."))
}

/// Expected squared error of a picture x, but for what is the same for all: Σ_k w_k |x − m_k|², w_k
/// the probability of what method k assumes and m_k the mean of the reflectances by it. A pattern
/// is the likeliest of many, and far from their mean where it is one of many.
fn loss(shown: &Recovered, all: &[(&Recovered, f64, &DVector<f64>)]) -> f64 {
    let best = all.iter().map(|(_, e, _)| *e).fold(f64::MIN, f64::max);
    let each = all.iter().map(|(_, evidence, mean)| {
        libm::exp(evidence - best) * (&shown.reflectance - *mean).norm_squared()
    });
    each.sum()
}

/// The mean by what the evidence takes for granted; none of a sum over patterns that is not to be
/// believed.
fn mean(found: &Recovered) -> Option<&DVector<f64>> {
    match &found.patterns {
        Some(patterns) => patterns.believed().map(|patterns| &patterns.mean),
        None => Some(&found.reflectance),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::problem::problem;
    use crate::lab::study::tests::small;
    use crate::matrix::Matrix;
    use crate::model::{Kernel, MatrixModel};
    use crate::recovery::{Options, Sum, recover};

    /// A slope over the surface is no picture of two values, a board of random elements no surface
    /// whose neighbours resemble one another, and one reflectance throughout no pattern.
    #[test]
    fn slopes_and_patterns_are_told_apart() {
        let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
        let board = |j: usize| f64::from(u8::from((j * 7 + j / 4) % 3 == 1));
        for (picture, expected) in [
            (
                (0..16).map(|j| 0.2 + 0.04 * f64::from(j)).collect(),
                Method::JointGp,
            ),
            (
                (0..16).map(board).collect::<Vec<f64>>(),
                Method::JointTwoValued,
            ),
            (vec![0.4; 16], Method::JointGp),
        ] {
            model.albedo = picture;
            let exact = model.phi();
            let stderr = Matrix::from_element(exact.nrows(), exact.ncols(), 1e-4 * exact.mean());
            let problem = problem(&model, &exact, Some(&stderr)).unwrap();
            let grids = [[4, 4]];
            let problem = problem.with_grids(&grids).unwrap();
            let found = [Method::JointGp, Method::JointTwoValued]
                .map(|method| recover(method, &problem, &Options::default()).unwrap());
            let (method, words) = likelier(&found.each_ref()).unwrap();
            assert_eq!(method, expected, "{words}");
            assert!(words.contains("likelier"), "{words}");
            assert_eq!(likelier(&[&found[0]]), None);
        }
    }

    /// Evidence that hardly differs tells nothing, and that of a sum over patterns that is not to
    /// be believed is none. A pattern that is one of many comes after what is near to their mean.
    #[test]
    fn what_is_expected_to_be_nearer_comes_first() {
        let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
        let exact = model.phi();
        let stderr = Matrix::from_element(exact.nrows(), exact.ncols(), 1e-4 * exact.mean());
        let problem = problem(&model, &exact, Some(&stderr)).unwrap();
        let grids = [[4, 4]];
        let problem = problem.with_grids(&grids).unwrap();
        let mut found = [Method::JointTwoValued, Method::JointGp]
            .map(|method| recover(method, &problem, &Options::default()).unwrap());
        let said = |found: &[Recovered; 2]| likelier(&found.each_ref()).unwrap();
        for (ahead, expected, words) in [
            (
                2.0,
                Method::JointTwoValued,
                "do not tell what joint-two-valued",
            ),
            (-2.0, Method::JointGp, "do not tell what joint-gp"),
            (
                4.0,
                Method::JointTwoValued,
                "What joint-two-valued assumes makes",
            ),
        ] {
            found[0].log_evidence = found[1].log_evidence.map(|known| known + ahead);
            let (method, own) = said(&found);
            assert!(method == expected && own.contains(words), "{ahead}: {own}");
        }
        let process = found[1].reflectance.clone();
        // The mean is that of what the evidence takes for granted.
        let is_further = |found: &[Recovered; 2]| {
            let (method, words) = said(found);
            method == Method::JointGp && words.ends_with("to be further off.")
        };
        let known = found[0].patterns.as_mut().unwrap();
        known.mean = process.clone();
        assert!(!is_further(&found));
        let known = found[0].patterns.as_mut().unwrap();
        known.if_alike.as_mut().unwrap().mean = process;
        known.sum = Sum::Sampled {
            draws: 1000,
            listed: 0.5,
            disagreement: 0.2,
        };
        assert!(is_further(&found));
        found[0].patterns.as_mut().unwrap().if_alike = None;
        assert_eq!(likelier(&found.each_ref()), None);
    }
}
