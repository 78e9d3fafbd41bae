//! The search for the place and the size of an occluder.

use super::kinds::Place;

/// Compass search (Kolda, Lewis and Torczon 2003): from `start` each coordinate is tried by a step
/// to both sides, the best is gone to, and where none is better the steps are halved; so many tries
/// in all. `merit` is what is to be small. Returns the best place and the tries.
pub(super) fn search<E>(
    start: Place,
    tries: usize,
    mut merit: impl FnMut(&Place) -> Result<f64, E>,
) -> Result<(Place, usize), E> {
    let mut best = (start, merit(&start)?);
    let (mut step, mut made) = (1.0, 0);
    while made < tries && step > 0.05 {
        let mut found = best;
        for to in neighbours(&best.0, step).into_iter().take(tries - made) {
            made += 1;
            let value = merit(&to)?;
            if value < found.1 {
                found = (to, value);
            }
        }
        if found.1 < best.1 {
            best = found;
        } else {
            step *= 0.5;
        }
    }
    Ok((best.0, made))
}

/// Places a step away along each coordinate: a factor of 1.5 in size, a seventh of the way, half a
/// size aside.
fn neighbours(at: &Place, step: f64) -> Vec<Place> {
    let both = [step, -step];
    let size = both.map(|s| Place {
        size: at.size * libm::pow(1.5, s),
        ..*at
    });
    let height = both.map(|s| Place {
        height: at.height + s / 7.0,
        ..*at
    });
    let aside = |k: usize| {
        both.map(|s| {
            let mut to = *at;
            to.offset[k] += 0.5 * s * at.size;
            to
        })
    };
    let all = [size, height, aside(1), aside(0)].concat();
    all.into_iter()
        .filter(|p| p.height > 0.02 && p.height < 0.98)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bowl (ln size − 1)² + (height − ½)² + (offset)² has its bottom at size e, height ½.
    #[test]
    fn the_bottom_of_a_bowl_is_found() {
        let start = Place {
            height: 0.3,
            offset: [0.5, -0.5],
            size: 1.0,
        };
        let bowl = |p: &Place| -> Result<f64, ()> {
            let off = p.offset[0] * p.offset[0] + p.offset[1] * p.offset[1];
            Ok((libm::log(p.size) - 1.0).powi(2) + (p.height - 0.5).powi(2) + off)
        };
        let (found, tries) = search(start, 400, bowl).unwrap();
        assert!((libm::log(found.size) - 1.0).abs() < 0.05 && (found.height - 0.5).abs() < 0.02);
        assert!(
            found.offset.iter().all(|x| x.abs() < 0.1) && tries <= 400,
            "{found:?}"
        );
        let few = search(start, 3, bowl).unwrap();
        assert_eq!(few.1, 3);
    }
}
