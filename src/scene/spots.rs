//! Layouts of the laser spots on the wall.
//!
//! The order in which a layout lists its spots is the spot index everywhere.

use super::error::{Fault, keys};
use super::file::{Layout, LineTable, SpotsTable};
use crate::num::stream::{Key, Sampling, Stream};

/// More spots than this are taken for a mistake.
const MOST: u64 = 100_000;

/// The places (x, y) on the wall that `table` lists.
pub(super) fn places(table: &SpotsTable) -> Result<Vec<[f64; 2]>, Fault> {
    refuse_foreign_keys(table)?;
    let places = match table.layout {
        Layout::Square => {
            let stagger = table.stagger.as_deref().unwrap_or(&[]);
            square(
                centre(table)?,
                half_width(table)?,
                per_side(table)?,
                stagger,
            )
        }
        Layout::Grid => grid(centre(table)?, half_width(table)?, per_side(table)?),
        Layout::Ring => ring(
            centre(table)?,
            positive("radius", needed("radius", table.radius)?)?,
            at_least("count", needed("count", table.count)?, 1)?,
            table.start_angle.unwrap_or(0.0),
        ),
        Layout::Random => random(
            centre(table)?,
            half_width(table)?,
            at_least("count", needed("count", table.count)?, 1)?,
            needed("seed", table.seed)?,
        ),
        Layout::Lines => {
            let table_lines = table.lines.as_deref().unwrap_or(&[]);
            lines(table_lines, table.stagger.as_deref().unwrap_or(&[]))?
        }
        Layout::List => table.points.clone().unwrap_or_default(),
    };
    if places.len() as u64 > MOST {
        return Err(too_many(places.len() as u64));
    }
    if places.is_empty() {
        return Err(Fault::new(
            keys![],
            "the layout lists no spot",
            "give it at least one (`points = [[x, y]]` for a list)",
        ));
    }
    match places
        .iter()
        .position(|p| !(p[0].is_finite() && p[1].is_finite()))
    {
        Some(i) => Err(Fault::new(
            keys![],
            format!("spot {i} has no finite place"),
            "use finite numbers",
        )),
        None => Ok(places),
    }
}

/// Sides of a square in turn: bottom by growing x, right by growing y, top by falling x, left by
/// falling y; `n` spots each, both ends included, corners repeated. Offset k mod m of `stagger` is
/// added to the y of bottom and top and to the x of left and right.
pub fn square([cx, cy]: [f64; 2], half: f64, n: u32, stagger: &[f64]) -> Vec<[f64; 2]> {
    let step = |k: u32| 2.0 * half * f64::from(k) / f64::from(n - 1) - half;
    let offset = |k: u32| {
        if stagger.is_empty() {
            0.0
        } else {
            stagger[k as usize % stagger.len()]
        }
    };
    let side = |f: &dyn Fn(u32) -> [f64; 2]| (0..n).map(f).collect::<Vec<_>>();
    [
        side(&|k| [cx + step(k), cy - half + offset(k)]),
        side(&|k| [cx + half + offset(k), cy + step(k)]),
        side(&|k| [cx - step(k), cy + half + offset(k)]),
        side(&|k| [cx - half + offset(k), cy - step(k)]),
    ]
    .concat()
}

/// n × n spots over a square, rows along +y, each row along +x.
pub fn grid([cx, cy]: [f64; 2], half: f64, n: u32) -> Vec<[f64; 2]> {
    let step = |k: u32| 2.0 * half * f64::from(k) / f64::from(n - 1) - half;
    (0..n * n)
        .map(|i| [cx + step(i % n), cy + step(i / n)])
        .collect()
}

/// `count` spots around a circle, counter-clockwise from `start` degrees off +x.
pub fn ring([cx, cy]: [f64; 2], radius: f64, count: u32, start: f64) -> Vec<[f64; 2]> {
    (0..count)
        .map(|k| {
            let turn = f64::from(k) / f64::from(count) + start / 360.0;
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
            [cx + radius * cos, cy + radius * sin]
        })
        .collect()
}

/// Independent uniform places in a square.
pub fn random([cx, cy]: [f64; 2], half: f64, count: u32, seed: u64) -> Vec<[f64; 2]> {
    // No pixel has this index: the places are independent of every path of a render with the same
    // seed.
    let key = Key {
        seed,
        spot: Key::ALL_SPOTS,
        pixel: u32::MAX,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    (0..count)
        .map(|_| {
            let u = stream.next_four();
            [
                cx + half * (2.0 * u[0] - 1.0),
                cy + half * (2.0 * u[1] - 1.0),
            ]
        })
        .collect()
}

/// Lines one after the other, each from its first to its last spot. Offset k mod m of `stagger`
/// moves spot k of a line to its left.
fn lines(lines: &[LineTable], stagger: &[f64]) -> Result<Vec<[f64; 2]>, Fault> {
    let mut places = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        let n = at_least("count", line.count, 1).map_err(|f| f.within(keys!["lines", i]))?;
        if places.len() as u64 + u64::from(n) > MOST {
            return Err(too_many(places.len() as u64 + u64::from(n)));
        }
        let [dx, dy] = [line.to[0] - line.from[0], line.to[1] - line.from[1]];
        let length = (dx * dx + dy * dy).sqrt();
        if length <= 0.0 && n > 1 {
            return Err(Fault::new(
                keys!["lines", i],
                format!("line {i} has {n} spots but no length"),
                "give it two different ends",
            ));
        }
        for k in 0..n {
            let t = if n > 1 {
                f64::from(k) / f64::from(n - 1)
            } else {
                0.0
            };
            let offset = match stagger {
                [] => 0.0,
                offsets => offsets[k as usize % offsets.len()] / length.max(f64::MIN_POSITIVE),
            };
            places.push([
                line.from[0] + t * dx - offset * dy,
                line.from[1] + t * dy + offset * dx,
            ]);
        }
    }
    Ok(places)
}

fn too_many(spots: u64) -> Fault {
    Fault::new(
        keys![],
        format!("{spots} spots are more than {MOST}"),
        "use fewer",
    )
}

fn needed<T>(key: &'static str, value: Option<T>) -> Result<T, Fault> {
    value.ok_or_else(|| {
        let cause = format!("this layout needs `{key}`");
        Fault::new(keys![], cause, format!("add `{key} = …` to [laser.spots]"))
    })
}

fn centre(table: &SpotsTable) -> Result<[f64; 2], Fault> {
    needed("centre", table.centre)
}

fn half_width(table: &SpotsTable) -> Result<f64, Fault> {
    positive("half_width", needed("half_width", table.half_width)?)
}

fn per_side(table: &SpotsTable) -> Result<u32, Fault> {
    let n = at_least("per_side", needed("per_side", table.per_side)?, 2)?;
    let total = if table.layout == Layout::Grid {
        u64::from(n) * u64::from(n)
    } else {
        4 * u64::from(n)
    };
    if total > MOST {
        return Err(too_many(total).within(keys!["per_side"]));
    }
    Ok(n)
}

fn positive(key: &'static str, x: f64) -> Result<f64, Fault> {
    if x > 0.0 && x.is_finite() {
        return Ok(x);
    }
    Err(Fault::new(
        keys![key],
        format!("`{key}` is {x}, not a positive length"),
        "use a positive number",
    ))
}

fn at_least(key: &'static str, n: u32, least: u32) -> Result<u32, Fault> {
    if n >= least && u64::from(n) <= MOST {
        return Ok(n);
    }
    let cure = format!("use a whole number from {least} to {MOST}");
    Err(Fault::new(keys![key], format!("`{key}` is {n}"), cure))
}

/// A key that this layout would ignore is an error: it shows that something else was meant.
fn refuse_foreign_keys(table: &SpotsTable) -> Result<(), Fault> {
    use Layout::{Grid, Lines, List, Random, Ring, Square};
    let given: [(&'static str, bool, &[Layout]); 10] = [
        (
            "centre",
            table.centre.is_some(),
            &[Square, Grid, Ring, Random],
        ),
        (
            "half_width",
            table.half_width.is_some(),
            &[Square, Grid, Random],
        ),
        ("per_side", table.per_side.is_some(), &[Square, Grid]),
        ("stagger", table.stagger.is_some(), &[Square, Lines]),
        ("lines", table.lines.is_some(), &[Lines]),
        ("radius", table.radius.is_some(), &[Ring]),
        ("count", table.count.is_some(), &[Ring, Random]),
        ("start_angle", table.start_angle.is_some(), &[Ring]),
        ("seed", table.seed.is_some(), &[Random]),
        ("points", table.points.is_some(), &[List]),
    ];
    for (key, is_given, layouts) in given {
        if is_given && !layouts.contains(&table.layout) {
            let layout = format!("{:?}", table.layout).to_lowercase();
            let cause = format!("the layout `{layout}` has no `{key}`");
            return Err(Fault::new(
                keys![key],
                cause,
                format!("remove `{key}`, or choose another layout"),
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
