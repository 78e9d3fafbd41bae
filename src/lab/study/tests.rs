//! What is asked of every study.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::*;
use crate::lab::bytes::{TaskError, decode, encode};
use crate::scene::Scene;

/// Numbers 0 to n − 1 in another order: a multiplicative sequence of a prime that n is no multiple
/// of.
fn shuffled(n: usize) -> Vec<usize> {
    let prime = [7919, 7907]
        .into_iter()
        .find(|p| !n.is_multiple_of(*p))
        .unwrap();
    (0..n).map(|k| (k * prime + 3) % n).collect()
}

/// Holds a study to its promise: tasks in any order, on two machines with a context of their own,
/// their outputs as bytes, come to the JSON of the whole; outputs that are cut short or left out
/// are refused; flipped bits are refused or taken, and nothing panics; all work is reported; a stop
/// is an error of its own.
pub(in crate::lab) fn divides<S: Study>(study: &S) -> S::Result {
    let context = || context(study, Control::none()).unwrap();
    let reported = AtomicU64::new(0);
    let counting = Control {
        progress: &|n| _ = reported.fetch_add(n, Ordering::Relaxed),
        ..Control::none()
    };
    let whole = run(study, counting).unwrap();
    if let Work::Tasks(tasks) = study.work() {
        assert_eq!(tasks, study.tasks() as u64);
        assert_eq!(reported.into_inner(), tasks);
    } else {
        assert!(reported.into_inner() > 0, "no samples reported");
    }
    let json = serde_json::to_string(&whole).unwrap();

    let order = shuffled(study.tasks());
    assert!(order.len() > 1, "a single task is no study");
    let (one, other) = order.split_at(order.len() / 2);
    let mut bytes = vec![Vec::new(); study.tasks()];
    for machine in [one, other] {
        let context = context();
        for &index in machine {
            let output = study.task(&context, index, Control::none()).unwrap();
            bytes[index] = encode(index, &output).unwrap();
        }
    }
    let merge = |bytes: &[Vec<u8>]| {
        let context = context();
        let outputs = decode(study, &context, bytes)?;
        Ok::<_, TaskError>(study.finish(&context, outputs).unwrap())
    };
    let merged = serde_json::to_string(&merge(&bytes).unwrap()).unwrap();
    assert_eq!(merged, json);

    let context = context();
    let refused = |bytes: &[Vec<u8>]| decode(study, &context, bytes).is_err();
    assert!(refused(&bytes[1..]), "one is missing");
    for (index, own) in bytes.iter().enumerate().take(4) {
        let mut forged = bytes.clone();
        for forgery in [&own[..own.len() - 1], &[], &[&own[..], &[1]].concat()] {
            forged[index] = forgery.to_vec();
            assert!(refused(&forged), "task {index}: {} bytes", forgery.len());
        }
        // Lengths and kinds are near the front.
        for at in (0..own.len().min(10)).chain([own.len() - 1]) {
            for bit in [0, 7] {
                forged[index] = own.clone();
                forged[index][at] ^= 1 << bit;
                if let Ok(outputs) = decode(study, &context, &forged) {
                    let _ = study.finish(&context, outputs);
                }
            }
        }
    }

    let stop = AtomicBool::new(true);
    let control = Control {
        progress: &|_| (),
        stop: &stop,
    };
    let stopped = outputs(study, &context, 0..study.tasks(), control);
    let Err(error) = stopped else {
        panic!("not stopped")
    };
    let source = error.source();
    let said = source.unwrap_or(&error).is::<Stopped>();
    assert!(said, "{error:?} does not tell that it was stopped");
    whole
}

/// Holds a study to refuse what is not the result of task `index`, though it can be read.
pub(in crate::lab) fn refuses<S: Study>(study: &S, index: usize, output: &S::Output) {
    let context = context(study, Control::none()).unwrap();
    let own = outputs(study, &context, 0..study.tasks(), Control::none()).unwrap();
    let mut bytes: Vec<Vec<u8>> = own.iter().map(|p| encode(0, p).unwrap()).collect();
    bytes[index] = encode(index, output).unwrap();
    let refused = decode(study, &context, &bytes);
    assert!(matches!(refused, Err(TaskError::Damaged { index: i, .. }) if i == index));
}

/// A built-in scene of four by four pixels and every ninth spot, so that tasks are short.
pub(in crate::lab) fn small(name: &str) -> Scene {
    let mut scene = Scene::load(name).unwrap();
    [scene.camera.columns, scene.camera.rows] = [4; 2];
    let spots = std::mem::take(&mut scene.laser.spots);
    scene.laser.spots = spots.into_iter().step_by(9).collect();
    scene
}
