//! The names of the recovery methods.

use std::fmt;
use std::str::FromStr;

/// How reflectances are recovered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Moore–Penrose inverse of the laser side, mean over pixels.
    Pinv,
    /// Truncated singular value decomposition of the laser side, mean over pixels.
    Tsvd,
    /// Tikhonov damping of the laser side, mean over pixels.
    Tikhonov,
    /// Least squares over all pixels and spots, reflectances unbounded.
    JointUnbounded,
    /// The same with reflectances between 0 and 1, which every surface obeys.
    Joint,
    /// The same with reflectances of 0 or more, without an upper bound.
    Nnls,
    /// `joint` with a penalty on differences between neighbours.
    JointTv,
    /// The same with reflectances of two values only.
    JointTwoValued,
}

impl Method {
    /// Every method, simplest first.
    pub const ALL: [Method; 8] = [
        Method::Pinv,
        Method::Tsvd,
        Method::Tikhonov,
        Method::JointUnbounded,
        Method::Joint,
        Method::Nnls,
        Method::JointTv,
        Method::JointTwoValued,
    ];

    /// The methods that a run tries unless told otherwise.
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

    /// Whether the method works on all pixels and spots at once, and so can estimate nuisance terms.
    pub(super) fn is_joint(self) -> bool {
        !matches!(self, Method::Pinv | Method::Tsvd | Method::Tikhonov)
    }

    /// The name by which the method is asked for and by which its files are called.
    pub fn name(self) -> &'static str {
        match self {
            Method::Pinv => "pinv",
            Method::Tsvd => "tsvd",
            Method::Tikhonov => "tikhonov",
            Method::JointUnbounded => "joint-unbounded",
            Method::Joint => "joint",
            Method::Nnls => "nnls",
            Method::JointTv => "joint-tv",
            Method::JointTwoValued => "joint-two-valued",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no recovery method has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no recovery method \"{0}\"; choose one of {list}", list = Method::names().join(", "))]
pub struct UnknownMethod(pub String);

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Method::ALL
            .into_iter()
            .find(|m| m.name() == name)
            .ok_or_else(|| UnknownMethod(name.to_string()))
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
            said.contains("lsqr") && said.contains("pinv, tsvd, tikhonov, joint-unbounded, joint"),
            "{said}"
        );
    }
}
