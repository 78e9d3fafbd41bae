//! Results as bytes, in the wire format of postcard: numbers of 64 bits of floating point as they are, whole numbers in as many bytes as they need.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// `value` as bytes.
///
/// # Errors
/// In words.
pub(super) fn write<T: Serialize>(value: &T) -> Result<Vec<u8>, String> {
    postcard::to_stdvec(value).map_err(|e| e.to_string())
}

/// The value that [`write`] made `bytes` of.
///
/// # Errors
/// In words, also for bytes that are left over.
pub(super) fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (value, rest) = postcard::take_from_bytes(bytes).map_err(|e| e.to_string())?;
    match rest.len() {
        0 => Ok(value),
        more => Err(format!("{more} bytes too many")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde::Deserialize;

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    enum Value {
        Nothing,
        Numbers(Vec<f64>),
        Named { name: String, count: Option<usize> },
    }

    proptest! {
        /// Every bit of every number: not-a-numbers of all kinds, infinities, −0 and subnormals are among them.
        #[test]
        fn every_bit_is_kept(bits in proptest::collection::vec(any::<u64>(), 0..40)) {
            let special = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, 5e-324];
            let numbers: Vec<f64> = bits.iter().map(|b| f64::from_bits(*b)).chain(special).collect();
            let Value::Numbers(found) = read(&write(&Value::Numbers(numbers.clone())).unwrap()).unwrap() else {
                panic!("another kind")
            };
            let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
            prop_assert_eq!(bits(&found), bits(&numbers));
        }

        /// Any bytes are refused or are a value; none is a panic.
        #[test]
        fn forged_bytes_do_no_harm(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = read::<Value>(&bytes);
            let _ = read::<Vec<Option<String>>>(&bytes);
        }
    }

    #[test]
    fn bytes_too_few_or_too_many_are_refused() {
        let value = Value::Named {
            name: "a name".to_owned(),
            count: Some(7),
        };
        let bytes = write(&value).unwrap();
        assert_eq!(read(&bytes), Ok(value));
        for short in 0..bytes.len() {
            assert!(read::<Value>(&bytes[..short]).is_err(), "{short} bytes");
        }
        let long = [&bytes[..], &[0]].concat();
        assert_eq!(read::<Value>(&long), Err("1 bytes too many".to_owned()));
    }

    /// 2⁶³ numbers are announced, eight are there.
    #[test]
    fn an_announced_length_reserves_nothing() {
        let mut bytes = vec![1];
        bytes.extend([0x80; 9]);
        bytes.push(1);
        bytes.extend([0; 64]);
        assert!(read::<Value>(&bytes).is_err());
    }
}
