//! The names of the recovery methods.

use std::str::FromStr;

use crate::num::named::{Named, named};

named! {
    /// How reflectances are recovered, simplest first.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Method {
        /// Moore–Penrose inverse of the laser side, mean over pixels.
        Pinv = "pinv",
        /// (DᵀD)⁻¹Dᵀ of the laser side where its columns are independent, mean over pixels.
        LeftInverse = "left-inverse",
        /// Dᵀ(DDᵀ)⁻¹ of the laser side where its rows are independent, mean over pixels.
        RightInverse = "right-inverse",
        /// Φ/D by pivoted QR, basic solution, mean over pixels: what MATLAB's `/` does.
        Rdivide = "rdivide",
        /// Φ/D by pivoted QR, solution of least norm, mean over pixels: what Octave's `/` does.
        RdivideMinNorm = "rdivide-min-norm",
        /// Truncated singular value decomposition of the laser side, mean over pixels.
        Tsvd = "tsvd",
        /// Tikhonov damping of the laser side, mean over pixels.
        Tikhonov = "tikhonov",
        /// Tikhonov damping of the differences between neighbouring elements, mean over pixels.
        TikhonovGradient = "tikhonov-gradient",
        /// Least squares over all pixels and spots, reflectances unbounded.
        JointUnbounded = "joint-unbounded",
        /// The same with reflectances between 0 and 1, which every surface obeys.
        Joint = "joint",
        /// The same with reflectances of 0 or more, without an upper bound.
        Nnls = "nnls",
        /// Reflectances as a Gaussian process: neighbours resemble one another, without bounds.
        JointGp = "joint-gp",
        /// `joint` with a penalty on differences between neighbours.
        JointTv = "joint-tv",
        /// The same with reflectances of two values only.
        JointTwoValued = "joint-two-valued",
    }
}

impl Method {
    /// Methods that know how likely the photographs are by what they assume, and the most elements
    /// of which they end within a minute or so.
    pub const OF_FEW: [(Method, usize); 2] =
        [(Method::JointGp, 2048), (Method::JointTwoValued, 256)];

    /// The methods that are tried for so many elements where none is named, simplest first: those
    /// of [`Method::USUAL`], and those of [`Method::OF_FEW`] that take so many.
    pub fn tried(elements: usize) -> Vec<Method> {
        let few = Method::OF_FEW
            .into_iter()
            .filter(|(_, most)| elements <= *most);
        let few = few.map(|(method, _)| method);
        Method::USUAL.into_iter().chain(few).collect()
    }

    /// The methods that are compared over regularisation and noise, simplest first.
    pub const USUAL: [Method; 5] = [
        Method::Pinv,
        Method::Tsvd,
        Method::Tikhonov,
        Method::JointUnbounded,
        Method::Joint,
    ];

    /// The names of all methods, in the order of [`Method::ALL`].
    pub fn names() -> [&'static str; Method::ALL.len()] {
        Method::ALL.map(Method::name)
    }

    /// Whether the method works on all pixels and spots at once, and so can estimate nuisance
    /// terms.
    pub fn is_joint(self) -> bool {
        matches!(
            self,
            Method::JointUnbounded
                | Method::Joint
                | Method::Nnls
                | Method::JointGp
                | Method::JointTv
                | Method::JointTwoValued
        )
    }

    /// Whether it compares neighbouring elements, and needs to know how they lie.
    pub fn compares_neighbours(self) -> bool {
        [Method::JointGp, Method::JointTv, Method::TikhonovGradient].contains(&self)
    }
}

/// A name that no recovery method has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no recovery method \"{0}\"; choose one of {list}", list = Method::names().join(", "))]
pub struct UnknownMethod(pub String);

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Method::by_name(name).ok_or_else(|| UnknownMethod(name.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_strangers_are_told_the_list() {
        for method in Method::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        let said = "lsqr".parse::<Method>().unwrap_err().to_string();
        assert!(
            said.contains("lsqr")
                && Method::ALL.iter().all(|m| said.contains(m.name()))
                && said.contains("tikhonov-gradient, joint-unbounded, joint"),
            "{said}"
        );
        assert!(Method::USUAL.iter().all(|m| Method::ALL.contains(m)));
        assert_eq!(Method::tried(5000), Method::USUAL);
        assert_eq!(Method::tried(64).len(), 7);
    }
}
