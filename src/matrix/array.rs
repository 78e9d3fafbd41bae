//! An array of any number of dimensions, as files of other programs hold photographs.

/// Most entries of an array that is read: 1 GiB as f64.
pub const MOST_ENTRIES: usize = 1 << 27;
/// Largest integer up to which f64 holds every one.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Numbers in rows of rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Its lengths; the last index runs fastest in `values`.
    pub shape: Vec<usize>,
    /// Its entries in C order.
    pub values: Vec<f64>,
    /// The largest value that integers of its type can have; `None` for floating-point numbers.
    pub full_scale: Option<f64>,
}

/// Why an array cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArrayError {
    /// Cut short or altered.
    #[error("`{name}` is damaged: {reason}; write it again")]
    Damaged {
        /// The file.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Of a kind that is not read.
    #[error("`{name}`: {reason}")]
    Unsupported {
        /// The file.
        name: String,
        /// What it is, and how to save it instead.
        reason: String,
    },
}

pub(super) fn damaged(name: &str, reason: impl ToString) -> ArrayError {
    let (name, reason) = (name.to_owned(), reason.to_string());
    ArrayError::Damaged { name, reason }
}

pub(super) fn unsupported(name: &str, reason: impl Into<String>) -> ArrayError {
    let (name, reason) = (name.to_owned(), reason.into());
    ArrayError::Unsupported { name, reason }
}

/// A type of number: how many bytes, and which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    /// Integers without sign.
    Unsigned(usize),
    /// Integers in two's complement.
    Signed(usize),
    /// IEEE 754.
    Float(usize),
}

impl Number {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::Unsigned(n) | Self::Signed(n) | Self::Float(n) => n,
        }
    }

    /// The largest integer of the type.
    pub(super) fn full_scale(self) -> Option<f64> {
        let bits = |n: usize| (8 * n) as i32;
        match self {
            Self::Unsigned(n) => Some(libm::exp2(f64::from(bits(n))) - 1.0),
            Self::Signed(n) => Some(libm::exp2(f64::from(bits(n) - 1)) - 1.0),
            Self::Float(_) => None,
        }
    }

    /// The number in `bytes`, least significant byte first.
    fn value(self, bytes: &[u8]) -> f64 {
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        let word = u64::from_le_bytes(wide);
        match self {
            Self::Unsigned(_) => word as f64,
            Self::Signed(n) => {
                let above = 64 - 8 * n as u32;
                ((word << above) as i64 >> above) as f64
            }
            Self::Float(4) => f64::from(f32::from_bits(word as u32)),
            Self::Float(_) => f64::from_bits(word),
        }
    }

    /// All numbers of `bytes`, each finite and, of integers, exact.
    pub(super) fn all(self, name: &str, bytes: &[u8], big: bool) -> Result<Vec<f64>, ArrayError> {
        let mut values = Vec::with_capacity(bytes.len() / self.bytes());
        for stored in bytes.chunks_exact(self.bytes()) {
            let mut ordered = [0; 8];
            let ordered = &mut ordered[..stored.len()];
            ordered.copy_from_slice(stored);
            if big {
                ordered.reverse();
            }
            let value = self.value(ordered);
            if !value.is_finite() {
                return Err(damaged(name, "it has numbers that are not finite"));
            }
            if self.full_scale().is_some() && value.abs() > EXACT {
                let reason =
                    "it has integers beyond 2⁵³, which f64 does not hold; divide them first";
                return Err(unsupported(name, reason));
            }
            values.push(value);
        }
        Ok(values)
    }
}

/// The entries of an array of `shape`, from Fortran order (first index fastest) to C order.
pub(super) fn from_fortran(shape: &[usize], values: &[f64]) -> Vec<f64> {
    let mut strides = Vec::with_capacity(shape.len());
    let mut stride = 1;
    for length in shape {
        strides.push(stride);
        stride *= length;
    }
    let mut index = vec![0; shape.len()];
    let mut at = 0;
    let mut ordered = Vec::with_capacity(values.len());
    for _ in 0..values.len() {
        ordered.push(values[at]);
        for axis in (0..shape.len()).rev() {
            index[axis] += 1;
            at += strides[axis];
            if index[axis] < shape[axis] {
                break;
            }
            at -= strides[axis] * shape[axis];
            index[axis] = 0;
        }
    }
    ordered
}
