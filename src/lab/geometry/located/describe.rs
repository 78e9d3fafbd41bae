//! What is said of where a hidden surface is.

mod ordered;

use super::{Grid, Located};
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Gallery, Mark, Picture, Place, Plot,
    Shades, Table, Tone,
};
use crate::lab::geometry::light_left_out::LightLeftOut;
use crate::lab::geometry::resized::Resized;
use crate::lab::recovered::fit::Fit;
use crate::lab::uncertainty::certainty::{hang_together, neighbours_share};
use crate::num::digits::figure;

/// What is left of other light's remainder above which more than noise is at work.
const MUCH: f64 = 0.05;
/// A standard error that is less than this part of the others is rounding.
const FLAT: f64 = 1e-9;

impl Located {
    /// Whether the largest likelihood lies within the range, no other peak is nearly as likely and
    /// no other size of the surface is much likelier and elsewhere,
    /// the stated noise does not refute what is there, and the order of the spots is neither by
    /// chance nor mistaken.
    pub fn is_found(&self) -> bool {
        let by_chance = self.order.and_then(|order| order.is_by_chance());
        let is_in_order = by_chance != Some(true) && self.mistaken.is_none();
        let is_alone = self.size.is_some() && self.elsewhere.is_empty() && self.moved().is_none();
        is_alone && self.refuted().is_none() && is_in_order
    }

    /// The fit, where the stated noise refutes it.
    fn refuted(&self) -> Option<&Fit> {
        self.fit.as_ref().filter(|fit| !fit.fits)
    }

    /// Whether the likeliest reflectances leave no more than the stated noise.
    fn is_explained(&self) -> bool {
        let fit = self.fit.as_ref();
        fit.is_some_and(|fit| fit.fits && !fit.is_open())
    }

    /// Light that would explain most of what is more than noise.
    fn left_out_light(&self) -> impl Iterator<Item = &LightLeftOut> {
        let refuted = self.refuted();
        let misfit = refuted.map_or(0.0, |fit| (fit.chi2_per_dof - 1.0) * fit.dof);
        LightLeftOut::likely(&self.light_left_out, misfit)
    }

    fn sentence(&self) -> String {
        let unit = &self.unit;
        let Some(size) = self.size else {
            return format!(
                "{}: the likelihood grows up to an end of what was tried. Widen the range (--range \
                 LOW,HIGH), or these photographs do not tell it.",
                self.what
            );
        };
        let error = match self.stderr() {
            Some(stderr) => format!("± {} {unit}", figure(stderr, 2)),
            None => format!("{unit} (its error is not known)"),
        };
        let [x, y, z] = self.middle.map(|x| figure(x, 3));
        let refuted = self.refuted().map_or(String::new(), |fit| {
            format!(
                "The photographs fit it NOWHERE: χ²/dof {} (p = {}). Closest, ",
                figure(fit.chi2_per_dof, 3),
                figure(fit.p, 1)
            )
        });
        let (which, together) = self.as_one_body();
        format!(
            "{refuted}{}: {} {error} from where the scene has it; the middle of {which} is then at \
             ({x}, {y}, {z}).{together}{}{}",
            self.what,
            figure(size, 3),
            self.or_elsewhere(),
            self.moved()
                .map_or(String::new(), |other| format!(" {}", self.as_large(other)))
        )
    }

    /// The surface whose middle is told, and that others are moved with it.
    fn as_one_body(&self) -> (String, String) {
        match &self.hidden[..] {
            [first, others @ ..] if !others.is_empty() => {
                let each: Vec<String> = self.hidden.iter().map(|s| format!("{s}.normal")).collect();
                let together = format!(
                    " All {} hidden surfaces are moved, as one body, in the directions of `{first}`: where one of \
                     them alone is elsewhere, place and error are wrong, and what is left over need not tell it. \
                     `phicam calibrate --free {}` moves each alone.",
                    self.hidden.len(),
                    each.join(",")
                );
                (format!("`{first}`"), together)
            }
            _ => ("the hidden surface".to_owned(), String::new()),
        }
    }

    /// Another size of the surface, where with it the place is another too.
    fn moved(&self) -> Option<&Resized> {
        let own = (self.size?, self.stderr()?);
        let other = self.resized.as_ref();
        other.filter(|other| other.is_elsewhere(std::iter::once(own)))
    }

    /// What is said of another size of the surface.
    fn as_large(&self, other: &Resized) -> String {
        let size = figure(other.values[0], 3);
        other.told(&format!("{} {size} {}", self.what, self.unit))
    }

    /// What is said of neighbours of which what is left hangs together.
    fn hangs_together(&self, r: f64) -> String {
        let frames = "the error by the curvature is too small, and that by frames does not see it where all err alike";
        match &self.picture {
            Some(picture) if !self.is_noise_known && picture.misfit > MUCH => format!(
                "Beware: {} of what other light leaves is explained by nothing, and hangs together from pixel to pixel \
                 (correlation {}), which noise does not: the model lacks something (another shape, a surface, other light), \
                 and place and picture may be wrong by more than their errors.",
                figure(picture.misfit, 2),
                figure(r, 2)
            ),
            _ => format!("Beware: {}.", neighbours_share(r, frames)),
        }
    }

    /// Places that are not told from this one.
    fn or_elsewhere(&self) -> String {
        let each: Vec<String> = self
            .elsewhere
            .iter()
            .map(|at| {
                let (size, off) = (figure(at.size, 3), figure(-at.log_likelihood, 2));
                format!("{size} {} (by e^{off} less likely)", self.unit)
            })
            .collect();
        if each.is_empty() {
            return String::new();
        }
        format!(
            " The photographs do NOT TELL that from {}: narrow the range (--range LOW,HIGH) by what is \
             known otherwise, or photograph by spots or a view that tell them apart.",
            each.join(" or ")
        )
    }

    fn errors(&self) -> String {
        let of = |error: Option<f64>| match error {
            Some(error) => format!("{} {}", figure(error, 2), self.unit),
            None => "not known".to_owned(),
        };
        let curvature = of(self.by_curvature);
        if self.frames < 3 {
            return format!(
                "By the curvature of the likelihood the error is {curvature}. That takes what is not \
                 explained for independent noise and elements for small enough; fewer than three \
                 frames cannot tell whether that holds."
            );
        }
        format!(
            "The stated error is the larger of two: by the curvature of the likelihood {curvature}, \
             which takes what is not explained for independent noise; by leaving out one of {} \
             frames after the other {}. Neither sees what is wrong in the same way in all frames.",
            self.frames,
            of(self.by_frames)
        )
    }

    fn explained(&self) -> String {
        let mut noise = "No noise is stated.".to_owned();
        if self.is_noise_known {
            let left = figure(self.noise, 3);
            noise = format!("What the likeliest reflectances leave is {left} of the stated noise.");
        }
        if let Some(fit) = self.fit.as_ref().filter(|fit| fit.is_open()) {
            noise += &format!(
                " That is more than noise (χ²/dof {}), but no more than the light may be integrated wrongly \
                 by: whether the photographs fit is not told.",
                figure(fit.chi2_per_dof, 3)
            );
        }
        if self.refuted().is_some() {
            noise += " That is MORE THAN NOISE: the model lacks something (a surface or an object, other \
                      light), the elements are too coarse (--elements), or something else is wrong that is \
                      not looked for; the place may be wrong by more than its error.";
        }
        let Some(picture) = &self.picture else {
            return format!("{noise} There is no picture of fewer than three frames.");
        };
        format!(
            "The picture is as smooth as it can be and still predict each photograph from the \
             others as well as any, to {} of what other light leaves; it explains all of them to \
             {}. {} of its {} directions are above what is not explained: its shape is known no \
             finer. {noise} Reflectances are not bounded here. {} entries of Φcam count.",
            figure(picture.predicted, 3),
            figure(picture.misfit, 3),
            picture.directions,
            self.elements,
            self.entries
        )
    }

    fn brightest(&self) -> Option<String> {
        let Some(bright) = self.picture.as_ref()?.bright else {
            let words = "No element of the picture is above twice its error.";
            return Some(words.to_owned());
        };
        let [x, y, z] = [0, 1, 2].map(|k| {
            let middle = figure(bright.middle[k], 3);
            match bright.stderr {
                // Across a flat surface that is parallel to the wall nothing varies but rounding.
                Some(all) if all[k] > FLAT * all[0].max(all[1]).max(all[2]) => {
                    format!("{middle} ± {}", figure(all[k], 2))
                }
                _ => middle,
            }
        });
        let error = match bright.stderr {
            Some(_) => {
                " (by leaving frames out, and no finer than an element, the place of the surface being given)"
            }
            None => "; its error is not known",
        };
        let pieces = match bright.pieces {
            1 => String::new(),
            n => format!(
                " It lies in {n} PIECES that do not touch, and between them need be none of it."
            ),
        };
        Some(format!(
            "The bright part, {} element{} of at least half the largest reflectance and above twice \
             their error, has its middle at ({x}, {y}, {z}){error}.{pieces}",
            bright.elements,
            if bright.elements == 1 { "" } else { "s" }
        ))
    }

    /// The picture with its standard errors.
    fn galleries(&self) -> Vec<Gallery> {
        let Some(found) = &self.picture else {
            return Vec::new();
        };
        let of = |title: String, grid: &Grid, values: &[f64]| Picture {
            title,
            size: grid.count,
            values: values.to_vec(),
            axes: ["u", "v"].map(str::to_owned),
            width: 2.0,
        };
        let both = |grid: &Grid| {
            let known = format!("{}: {} directions known", grid.surface, found.directions);
            let errors = format!("{}: standard errors", grid.surface);
            [
                of(known, grid, &grid.values),
                of(errors, grid, &grid.stderr),
            ]
        };
        vec![Gallery {
            title: "The reflectance there, over its largest, and its errors by leaving frames out"
                .to_owned(),
            shades: Shades::Values,
            unit: String::new(),
            pictures: found.grids.iter().flat_map(both).collect(),
        }]
    }

    fn axis(&self) -> Axis {
        let ends = |k: usize| self.curve.get(k).map_or(0.0, |at| at.size);
        let title = format!("{}, {}", self.what, self.unit);
        Axis::linear(title, [ends(0), ends(self.curve.len().saturating_sub(1))])
    }
}

impl Describe for Located {
    fn describe(&self) -> Finding {
        let title = format!("Where it is: {}, {}", self.what, self.scene);
        let mut notes = vec![self.errors(), self.explained()];
        let which = self.shared.filter(|_| self.is_noise_known);
        notes.extend(which.map(|which| hang_together(which, "the place")));
        let neighbours = self.neighbours.filter(|_| self.refuted().is_none());
        notes.extend(neighbours.map(|r| self.hangs_together(r)));
        notes.extend(self.left_out_light().map(|light| light.beware("place")));
        let resized = self.resized.as_ref().filter(|_| self.moved().is_none());
        notes.extend(resized.map(|other| format!("Beware: {}", self.as_large(other))));
        notes.extend(self.brightest());
        notes.push(self.ordered());
        let points = |of: fn(&super::Likelihood) -> f64| -> Vec<[f64; 2]> {
            self.curve.iter().map(|at| [at.size, of(at)]).collect()
        };
        let plot = |title: &str, points: Vec<[f64; 2]>| {
            let low = points.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
            let high = points
                .iter()
                .map(|p| p[1])
                .fold(f64::NEG_INFINITY, f64::max);
            let axes = [self.axis(), Axis::linear(title, [low, high])];
            Plot::new("", axes, vec![Curve::new(title, Mark::Line, points)])
        };
        let plots = vec![
            plot("log likelihood", points(|at| at.log_likelihood)),
            plot("misfit", points(|at| at.misfit)),
        ];
        let table = Table {
            file: Some("locate.csv".to_owned()),
            place: Place::Page,
            ..Table::new(
                "Sizes that were tried",
                vec![
                    Column::number("size", "size", &self.unit, 4),
                    Column::number("log likelihood", "log_likelihood", "", 6),
                    Column::number("misfit", "misfit", "", 4),
                ],
                self.curve.iter().map(|at| {
                    [at.size, at.log_likelihood, at.misfit]
                        .map(Cell::from)
                        .to_vec()
                }),
            )
        };
        Finding {
            title,
            tone: if !self.is_found() {
                Tone::Bad
            } else if self.left_out_light().next().is_some() || self.resized.is_some() {
                Tone::Plain
            } else {
                Tone::Good
            },
            sentence: self.sentence(),
            notes,
            tables: vec![table],
            figures: vec![Figure::new("locate.svg", "Likelihood and misfit", plots)],
            galleries: self.galleries(),
            ..Finding::default()
        }
    }
}
