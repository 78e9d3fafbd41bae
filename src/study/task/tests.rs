//! What is asked of every division.

use std::sync::atomic::AtomicBool;

use serde::Serialize;

use super::*;
use crate::scene::Scene;

/// Runs `act` with a control that nobody stops.
pub(in crate::study) fn unstopped<T>(act: impl FnOnce(Control<'_>) -> T) -> T {
    let stop = AtomicBool::new(false);
    act(Control {
        progress: &|_| (),
        stop: &stop,
    })
}

/// Numbers 0 to n − 1 in another order: a multiplicative sequence of a prime that n is no multiple of.
fn shuffled(n: usize) -> Vec<usize> {
    let prime = [7919, 7907]
        .into_iter()
        .find(|p| !n.is_multiple_of(*p))
        .unwrap();
    (0..n).map(|k| (k * prime + 3) % n).collect()
}

/// Holds a division to its promise: tasks in any order, on two machines with a ground of their own, their results as bytes, come to the JSON of the whole; results that
/// are cut short or left out are refused; flipped bits are refused or taken, and no one panics.
pub(in crate::study) fn divides<D: Division>(division: &D) -> D::Finding
where
    D::Finding: Serialize,
{
    let ground = || unstopped(|c| division.ground(c)).unwrap().unwrap();
    let whole = unstopped(|c| whole(division, c, &|_, _| ())).unwrap();
    let json = serde_json::to_string(&whole).unwrap();
    let whole = whole.unwrap();

    let order = shuffled(division.tasks());
    assert!(order.len() > 1, "a single task is no division");
    let (one, other) = order.split_at(order.len() / 2);
    let mut bytes = vec![Vec::new(); division.tasks()];
    for machine in [one, other] {
        let ground = ground();
        for &index in machine {
            let part = unstopped(|c| division.task(&ground, index, c));
            bytes[index] = encode(index, &part.unwrap().unwrap()).unwrap();
        }
    }
    let merge = |bytes: &[Vec<u8>]| {
        let ground = ground();
        let parts = decode(division, &ground, bytes)?;
        Ok::<_, TaskError>(division.finish(&ground, parts).unwrap())
    };
    let merged = serde_json::to_string(&merge(&bytes).unwrap()).unwrap();
    assert_eq!(merged, json);

    let ground = ground();
    let refused = |bytes: &[Vec<u8>]| decode(division, &ground, bytes).is_err();
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
                if let Ok(parts) = decode(division, &ground, &forged) {
                    let _ = division.finish(&ground, parts);
                }
            }
        }
    }

    let stop = AtomicBool::new(true);
    let control = Control {
        progress: &|_| (),
        stop: &stop,
    };
    let stopped = parts(division, &ground, 0..division.tasks(), control, &|_, _| ());
    assert!(matches!(stopped, Ok(None)));
    whole
}

/// Holds a division to refuse what is not the result of task `index`, though it can be read.
pub(in crate::study) fn refuses<D: Division>(division: &D, index: usize, part: &D::Part) {
    let ground = unstopped(|c| division.ground(c)).unwrap().unwrap();
    let own = unstopped(|c| parts(division, &ground, 0..division.tasks(), c, &|_, _| ()));
    let own = own.unwrap().unwrap();
    let mut bytes: Vec<Vec<u8>> = own.iter().map(|p| encode(0, p).unwrap()).collect();
    bytes[index] = encode(index, part).unwrap();
    let refused = decode(division, &ground, &bytes);
    assert!(matches!(refused, Err(TaskError::Damaged { index: i, .. }) if i == index));
}

/// A built-in scene of four by four pixels and every ninth spot, so that tasks are short.
pub(in crate::study) fn small(name: &str) -> Scene {
    let mut scene = Scene::load(name).unwrap();
    [scene.camera.columns, scene.camera.rows] = [4; 2];
    let spots = std::mem::take(&mut scene.laser.spots);
    scene.laser.spots = spots.into_iter().step_by(9).collect();
    scene
}
