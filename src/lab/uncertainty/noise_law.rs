//! How the noise of photographs goes with their light.

use std::str::FromStr;

use crate::lab::options::OptionError;
use crate::matrix::Matrix;
use crate::num::named::{Named, named};

/// Entries without light have the noise of this share of the brightest.
const DARK: f64 = 1e-4;

named! {
    /// How the standard error of an entry goes with its light Φ, at a noise level ε.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(in crate::lab) enum NoiseLaw {
        /// ε Φ.
        Relative = "relative": "A share of each entry",
        /// ε √(Φ Φmax).
        Shot = "shot":
            "The same share of the brightest entry, of others by the root of their light",
        /// ε Φmax.
        Read = "read": "The same for all entries, a share of the brightest",
    }
}

impl FromStr for NoiseLaw {
    type Err = OptionError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::by_name(name)
            .ok_or_else(|| OptionError::new(format!("no noise is called {name}"), "use relative"))
    }
}

impl NoiseLaw {
    /// Standard error at level 1 of an entry of light `x` where the brightest has `top`, W.
    pub(in crate::lab) fn stderr(self, x: f64, top: f64) -> f64 {
        let of = match self {
            Self::Relative => x.abs(),
            Self::Shot => (x.abs() * top).sqrt(),
            Self::Read => top,
        };
        of.max(DARK * top)
    }

    /// Standard errors of photographs `phi` at noise `level`, W.
    pub(in crate::lab) fn stderrs(self, phi: &Matrix, level: f64) -> Matrix {
        let top = phi.amax();
        phi.map(|x| level * self.stderr(x, top))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, for the brightest entry 4: of an entry of 1 the errors are 1, √(1·4) and 4.
    #[test]
    fn laws_by_hand() {
        let errors = |x| NoiseLaw::ALL.map(|law| law.stderr(x, 4.0));
        assert_eq!(errors(1.0), [1.0, 2.0, 4.0]);
        assert_eq!(errors(0.0), [4e-4, 4e-4, 4.0]);
        let phi = Matrix::from_row_slice(1, 2, &[1.0, 4.0]);
        let shot = Matrix::from_row_slice(1, 2, &[0.2, 0.4]);
        assert!((NoiseLaw::Shot.stderrs(&phi, 0.1) - shot).amax() < 1e-15);
        for (name, _) in NoiseLaw::NAMES {
            assert_eq!(name.parse::<NoiseLaw>().unwrap().name(), *name);
        }
        assert!("loud".parse::<NoiseLaw>().is_err());
    }
}
