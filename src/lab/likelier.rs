//! Under which assumption the photographs are likelier.

use crate::num::digits::figure;
use crate::recovery::{Method, Recovered};

/// Evidences that differ by less, ln, do not tell: a factor of 20.
const TELLS: f64 = 3.0;

/// The evidence by which a picture is ranked, ln. One of two levels is sharp, and far off where it
/// is wrong; one of a Gaussian process is a mean with its errors. So two levels come first only
/// where the photographs tell.
pub(super) fn ranked(evidence: f64, is_two_valued: bool) -> f64 {
    evidence - if is_two_valued { TELLS } else { 0.0 }
}

/// Of the methods that know how likely the photographs are by what they assume (`joint-gp`:
/// neighbours resemble one another; `joint-two-valued`: two levels in any pattern) the one of the
/// largest evidence as [`ranked`], and how much that tells. None where fewer than two of them were
/// tried. Every error of the model counts as evidence against both, the stiffer one more.
pub(super) fn likelier(found: &[&Recovered]) -> Option<(Method, String)> {
    let known = found
        .iter()
        .filter_map(|f| Some((f.method, f.log_evidence?, f.patterns.is_some())));
    let mut known: Vec<(Method, f64, bool)> = known.collect();
    known.sort_by(|a, b| ranked(b.1, b.2).total_cmp(&ranked(a.1, a.2)));
    let [(first, best, _), (second, next, _), ..] = known[..] else {
        return None;
    };
    let ahead = best - next;
    let words = if ahead.abs() < TELLS {
        format!("The photographs do not tell what {first} assumes from what {second} assumes.")
    } else {
        format!(
            "What {first} assumes makes the photographs e^{} times likelier than what {second} \
             assumes.",
            figure(ahead, 2)
        )
    };
    Some((first, words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::problem::problem;
    use crate::lab::study::tests::small;
    use crate::matrix::Matrix;
    use crate::model::{Kernel, MatrixModel};
    use crate::recovery::{Options, recover};

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

    /// Two levels whose photographs are e^2 times likelier are not told from a Gaussian process,
    /// which comes first; of those e^4 times likelier the pattern does.
    #[test]
    fn a_pattern_comes_first_only_where_the_photographs_tell() {
        let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
        let exact = model.phi();
        let stderr = Matrix::from_element(exact.nrows(), exact.ncols(), 1e-4 * exact.mean());
        let problem = problem(&model, &exact, Some(&stderr)).unwrap();
        let grids = [[4, 4]];
        let problem = problem.with_grids(&grids).unwrap();
        let mut found = [Method::JointTwoValued, Method::JointGp]
            .map(|method| recover(method, &problem, &Options::default()).unwrap());
        for (ahead, expected, word) in [
            (2.0, Method::JointGp, "do not tell what joint-gp"),
            (-2.0, Method::JointGp, "do not tell what joint-gp"),
            (
                4.0,
                Method::JointTwoValued,
                "What joint-two-valued assumes makes",
            ),
            (-4.0, Method::JointGp, "What joint-gp assumes makes"),
        ] {
            found[0].log_evidence = found[1].log_evidence.map(|known| known + ahead);
            let (method, words) = likelier(&found.each_ref()).unwrap();
            assert!(
                method == expected && words.contains(word),
                "{ahead}: {words}"
            );
        }
    }
}
