//! Outputs of tasks as bytes, in the wire format of postcard: numbers of 64 bits of floating point
//! as they are, whole numbers in as many bytes as they need.

use std::ops::Range;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::lab::error::StudyError;
use crate::lab::study::{Study, outputs};
use crate::transport::Control;

/// How studies are divided and what the outputs of their tasks are: raised whenever a change of
/// either makes outputs of another number useless, or different.
pub const LAYOUT: u32 = 2;

/// Why outputs cannot be used.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum TaskError {
    /// An output that cannot be written.
    #[error("the result of task {index} cannot be written: {cause} (report it as a bug)")]
    Unwritten {
        /// The task.
        index: usize,
        /// What is wrong.
        cause: String,
    },
    /// Bytes that no task gave.
    #[error("the result of task {index} is damaged: {cause} (run that task again)")]
    Damaged {
        /// The task.
        index: usize,
        /// What is wrong.
        cause: String,
    },
    /// Not one output for each task.
    #[error("there are {found} results of {tasks} tasks (give that of every task, once)")]
    Number {
        /// Outputs.
        found: usize,
        /// Tasks.
        tasks: usize,
    },
    /// Tasks that the study does not have.
    #[error("there are no tasks {} to {} among {all}\n  cure: plan again: the command, the scene or the program is another one", tasks.start, tasks.end)]
    NoSuch {
        /// What was asked for.
        tasks: Range<usize>,
        /// Tasks of the study.
        all: usize,
    },
}

/// The output of task `index` as bytes, every bit of every number kept.
///
/// # Errors
/// [`TaskError::Unwritten`].
pub fn encode<T: Serialize>(index: usize, output: &T) -> Result<Vec<u8>, TaskError> {
    postcard::to_stdvec(output).map_err(|e| TaskError::Unwritten {
        index,
        cause: e.to_string(),
    })
}

/// The outputs of some tasks of `study` as bytes, in the order of their numbers, on the threads of
/// the pool.
///
/// # Errors
/// Those of the study, and [`TaskError::NoSuch`].
pub fn encoded<S: Study>(
    study: &S,
    context: &S::Context,
    tasks: Range<usize>,
    control: Control<'_>,
) -> Result<Vec<Vec<u8>>, StudyError> {
    let all = study.tasks();
    if tasks.start > tasks.end || tasks.end > all {
        return Err(TaskError::NoSuch { tasks, all }.into());
    }
    let found = outputs(study, context, tasks.clone(), control)?;
    let encoded = tasks
        .zip(&found)
        .map(|(index, output)| encode(index, output));
    Ok(encoded.collect::<Result<_, _>>()?)
}

/// The outputs of all tasks from their bytes, in the order of the tasks. The bytes may come from
/// anywhere: they are checked, and the memory reserved for them is bounded by their own number.
///
/// # Errors
/// [`TaskError`].
pub fn decode<S: Study>(
    study: &S,
    context: &S::Context,
    outputs: &[Vec<u8>],
) -> Result<Vec<S::Output>, TaskError> {
    let (found, tasks) = (outputs.len(), study.tasks());
    if found != tasks {
        return Err(TaskError::Number { found, tasks });
    }
    let one = |(index, bytes): (usize, &Vec<u8>)| {
        let damaged = |cause| TaskError::Damaged { index, cause };
        let output = read(bytes).map_err(damaged)?;
        if study.fits(context, index, &output) {
            Ok(output)
        } else {
            Err(damaged("it is of another task or study".to_owned()))
        }
    };
    outputs.iter().enumerate().map(one).collect()
}

/// The value of `bytes`, or what is wrong with them; also that some are left over.
pub(super) fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (value, rest) = postcard::take_from_bytes(bytes).map_err(|e| e.to_string())?;
    if rest.is_empty() {
        Ok(value)
    } else {
        Err(format!("{} bytes too many", rest.len()))
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
        /// Every bit of every number: not-a-numbers of all kinds, infinities, −0 and subnormals are
        /// among them.
        #[test]
        fn every_bit_is_kept(bits in proptest::collection::vec(any::<u64>(), 0..40)) {
            let special = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, 5e-324];
            let numbers: Vec<f64> = bits.iter().map(|b| f64::from_bits(*b)).chain(special).collect();
            let Value::Numbers(found) = read(&encode(0, &Value::Numbers(numbers.clone())).unwrap()).unwrap() else {
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
        let bytes = encode(0, &value).unwrap();
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
