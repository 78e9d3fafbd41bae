//! Whether photographs are in an order that is easily mistaken for the right one.
//!
//! Against random orders one that is off by a single frame looks right: neighbouring spots light
//! much the same. So frames that follow each other by a few places too early or too late, all or
//! from one on, two frames exchanged, all backwards, and photographs that are mirrored or turned
//! are tried too, at the stated place; with the likeliest of them the search is made again. Where
//! one was missed, what stands last is of no spot, and where one was taken twice its double is:
//! both orders are then compared without it.

use std::sync::Arc;

use rayon::prelude::*;
use serde::Serialize;

use super::frames::{Seen, Sides, TermsOf};
use super::likelihood::Fit;
use crate::lab::error::LabError;
use crate::lab::geometry::common::Common;
use crate::lab::uncertainty::unexplained::{Photographs, Unexplained};
use crate::matrix::Matrix;

/// Frames too early or too late that are tried.
const MOST_SHIFT: usize = 8;
/// Pairs of frames up to which all exchanges are tried; of more those up to `MOST_SHIFT` places
/// apart.
const MOST_PAIRS: usize = 1000;
/// An order is likelier if the photographs are by e to this, and it leaves at most this part of
/// what the stated one leaves: what a model lacks is no independent noise, which the first takes it
/// for.
const TELLS: f64 = 5.0;
const LESS: f64 = 0.9;
/// The same of an order that differs in a few photographs, at the stated place: of many such, some
/// one leaves a good deal less of what a model lacks (of frames that are too dark, say).
const FEW_LESS: f64 = 0.5;

/// An order in which the photographs are likelier than in the stated one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mistaken {
    /// What is wrong with the stated one, in words.
    pub what: String,
    /// ln of how much likelier they are, each at its own place.
    pub log_likelier: f64,
    /// Misfit in this order.
    pub misfit: f64,
}

/// Where frames and pixels of the stated order belong.
#[derive(Clone, Debug)]
pub(super) struct Rearranged {
    pub(super) what: String,
    /// The frame that is taken for each spot, and the pixel for each pixel.
    frames: Vec<usize>,
    pixels: Arc<[usize]>,
    /// Whether most frames follow each other as stated.
    is_of_few: bool,
    /// The frame that is of no spot.
    pub(super) left_over: Option<usize>,
}

impl Rearranged {
    /// All that are tried, of so many frames of columns × rows pixels.
    pub(super) fn all([columns, rows]: [usize; 2], frames: usize) -> Vec<Self> {
        let pixels = columns * rows;
        let own: Vec<usize> = (0..pixels).collect();
        let mut all = Vec::new();
        let most = MOST_SHIFT.min((frames - 1) / 2);
        let late = |k: usize, of: &dyn Fn(usize) -> usize| -> Vec<usize> {
            (0..frames).map(|l| of((l + k) % frames)).collect()
        };
        let backwards = |l: usize| frames - 1 - l;
        let words = |k: usize| match k {
            0 => String::new(),
            k if k <= most => format!("{k} too late"),
            k => format!("{} too early", frames - k),
        };
        let shifts = || (0..=most).chain(frames - most..frames);
        for k in shifts() {
            let (is_stated, place) = (k == 0, words(k));
            if !is_stated {
                all.push((
                    format!("each frame stands {place}"),
                    late(k, &|l| l),
                    own.clone(),
                ));
            }
            if frames > 2 {
                let place = if is_stated {
                    place
                } else {
                    format!(", {place}")
                };
                let what = format!("the frames stand backwards{place}");
                all.push((what, late(k, &backwards), own.clone()));
            }
        }
        let at = |of: &dyn Fn(usize, usize) -> [usize; 2]| -> Vec<usize> {
            let each = (0..pixels).map(|p| of(p % columns, p / columns));
            each.map(|[u, v]| u + v * columns).collect()
        };
        let stated: Vec<usize> = (0..frames).collect();
        for (what, pixels) in [
            (
                "photographs are mirrored left to right",
                at(&|u, v| [columns - 1 - u, v]),
            ),
            (
                "photographs stand upside down, mirrored",
                at(&|u, v| [u, rows - 1 - v]),
            ),
            (
                "photographs stand upside down",
                at(&|u, v| [columns - 1 - u, rows - 1 - v]),
            ),
        ] {
            all.push((what.to_owned(), stated.clone(), pixels));
        }
        if columns == rows {
            let what = "columns and rows of the photographs are exchanged".to_owned();
            all.push((what, stated, at(&|u, v| [v, u])));
        }
        let whole = all.into_iter().map(|(what, frames, pixels)| Self {
            what,
            frames,
            pixels: pixels.into(),
            is_of_few: false,
            left_over: None,
        });
        whole.chain(Self::of_few(frames, &own.into())).collect()
    }

    /// Those in which one frame was missed or taken twice, and those behind it stand beside their
    /// places, or two are exchanged.
    fn of_few(frames: usize, pixels: &Arc<[usize]>) -> Vec<Self> {
        let mut all = Vec::new();
        let mut push = |what: String, frames: Vec<usize>, left_over: Option<usize>| {
            all.push(Self {
                what,
                frames,
                pixels: Arc::clone(pixels),
                is_of_few: true,
                left_over,
            });
        };
        for from in 0..frames - 1 {
            let tail = frames - from;
            for (places, way, left_over, last) in [
                (1, "late", from, "one before it twice"),
                (
                    tail - 1,
                    "early",
                    frames - 1,
                    "one missed, the last of no spot",
                ),
            ] {
                let moved = |l: usize| from + (l - from + places) % tail;
                let order = (0..frames).map(|l| if l < from { l } else { moved(l) });
                let what =
                    format!("from about photograph {from} on each stands 1 too {way} ({last})");
                push(what, order.collect(), Some(left_over));
            }
        }
        let apart = if frames * (frames - 1) / 2 <= MOST_PAIRS {
            frames - 1
        } else {
            MOST_SHIFT
        };
        for a in 0..frames {
            for b in a + 1..frames.min(a + apart + 1) {
                let mut order: Vec<usize> = (0..frames).collect();
                order.swap(a, b);
                push(
                    format!("photographs {a} and {b} are exchanged"),
                    order,
                    None,
                );
            }
        }
        all
    }

    /// The photographs as stated, without the one that is of no spot.
    pub(super) fn stated(&self, stated: &Unexplained<'_>) -> Photographs {
        let all: Vec<usize> = (0..stated.phi.ncols()).collect();
        let pixels: Vec<usize> = (0..stated.phi.nrows()).collect();
        self.taken(stated, &pixels, &all)
    }

    /// The photographs in this order, without the one that is of no spot.
    pub(super) fn of(&self, stated: &Unexplained<'_>) -> Photographs {
        self.taken(stated, &self.pixels, &self.frames)
    }

    fn taken(&self, of: &Unexplained<'_>, pixels: &[usize], frames: &[usize]) -> Photographs {
        let in_order =
            |m: &Matrix| Matrix::from_fn(m.nrows(), m.ncols(), |p, l| m[(pixels[p], frames[l])]);
        let mut left_out = of.left_out.map(in_order);
        if let Some(frame) = self.left_over
            && let Some(spot) = frames.iter().position(|l| *l == frame)
        {
            let [rows, columns] = [pixels.len(), frames.len()];
            let all = left_out.get_or_insert_with(|| Matrix::zeros(rows, columns));
            all.column_mut(spot).fill(1.0);
        }
        Photographs {
            phi: in_order(of.phi),
            stderr: of.stderr.map(in_order),
            certainty: of.certainty,
            left_out,
            patterns: of.patterns.cloned(),
        }
    }
}

/// The likeliest order of `all` at the place of `terms`, against the stated one of the same frames;
/// none where that is the likeliest. Light that all frames share is that of all of them.
pub(super) fn likeliest(
    (seen, sides): (Seen<'_>, &Sides<'_>),
    terms: TermsOf<'_>,
    root: &Matrix,
    all: Vec<Rearranged>,
) -> Result<Option<Rearranged>, LabError> {
    // ln p and the misfit.
    let fit = |sides: &Sides<'_>, frames: &[usize], out: Option<usize>| {
        let lit = frames.iter().copied().zip(0..);
        let lit: Vec<(usize, usize)> = lit.filter(|(frame, _)| Some(*frame) != out).collect();
        let found = Fit::new(&sides.lit(&lit, terms), root)?;
        let dark = [f64::NEG_INFINITY, f64::INFINITY];
        Ok::<_, LabError>(found.map_or(dark, |fit| [fit.log_likelihood, fit.misfit]))
    };
    let stated: Vec<usize> = (0..sides.len()).collect();
    let as_stated = fit(sides, &stated, None)?;
    let found = all.par_iter().map(|order| {
        // Frames are what they are in any order; pixels see other light in other places.
        if order.frames == stated {
            let own = order.of(&seen.photographs);
            let again = seen.common.map(|_| Common::new(&own.unexplained(), false));
            let common = again.transpose()?;
            let turned = Seen {
                photographs: own.unexplained(),
                common: common.as_ref(),
            };
            let found = fit(&Sides::new(turned, terms.camera)?, &stated, None)?;
            Ok([found, as_stated])
        } else {
            let out = order.left_over.filter(|_| seen.common.is_none());
            let own = match out {
                Some(_) => fit(sides, &stated, out)?,
                None => as_stated,
            };
            Ok([fit(sides, &order.frames, out)?, own])
        }
    });
    let found: Vec<[[f64; 2]; 2]> = found.collect::<Result<_, LabError>>()?;
    let mut best = (0.0, None);
    for ([found, own], order) in found.into_iter().zip(all) {
        let more = found[0] - own[0];
        if more > best.0 && (!order.is_of_few || found[1] < FEW_LESS * own[1]) {
            best = (more, Some(order));
        }
    }
    Ok(best.1)
}

impl Mistaken {
    /// Of photographs whose stated order has this likelihood and misfit; none where that of the
    /// other one says no more.
    pub(super) fn new(what: String, stated: [f64; 2], other: [f64; 2]) -> Option<Self> {
        let log_likelier = other[0] - stated[0];
        let misfit = other[1];
        (log_likelier > TELLS && misfit < LESS * stated[1]).then_some(Self {
            what,
            log_likelier,
            misfit,
        })
    }
}
