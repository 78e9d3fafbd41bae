//! What the study of misplaced things says.

use super::results::{Misplacement, Sensitivity, Tolerance};
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Place, Plot, Table, listed,
};
use crate::num::digits::figure;

impl Describe for Tolerance {
    fn describe(&self) -> Finding {
        Finding {
            title: format!("How wrong the assumed geometry may be: {}", self.scene),
            sentence: self.sentence(),
            notes: vec![self.needed()],
            tables: vec![self.limits(), self.sizes()],
            figures: vec![self.figure()],
            ..Finding::default()
        }
    }
}

impl Tolerance {
    /// What is recovered with the right geometry, and what loses it first.
    fn sentence(&self) -> String {
        let lost = |p: &Sensitivity| p.lost_at.is_some();
        let count = self.parameters.iter().filter(|p| lost(p)).count();
        // Sizes compare within a unit only.
        let first = |own: &[Sensitivity]| {
            let sizes = own.iter().filter_map(|p| Some((p, p.lost_at?)));
            let (p, size) = sizes.min_by(|a, b| a.1.total_cmp(&b.1))?;
            Some(format!("{} off by {} {}", p.name, figure(size, 2), p.unit))
        };
        let units = self.parameters.chunk_by(|a, b| a.unit == b.unit);
        let found = if !self.shows_pattern() {
            let own = self.own.map_or(String::new(), |own| figure(own, 3));
            format!(
                "that is less than half of the picture's own {own}, and what errors of geometry lose of it is not told: less noise shows it"
            )
        } else if count == 0 {
            "no error of geometry that was studied halves its MTF".to_owned()
        } else {
            format!(
                "{count} of {} errors of geometry can halve it, first {}",
                self.parameters.len(),
                listed(&units.filter_map(first).collect::<Vec<_>>())
            )
        };
        let Some(mtf) = self.mtf else {
            return format!(
                "The picture of {} is flat, or of one element, and has no MTF: how much each error of geometry changes the light stands below.",
                self.scene
            );
        };
        format!(
            "With the right geometry and a noise of {} of each entry, joint recovers {} at an MTF raw of {} (mean of {} draws of the noise, as all here); {found}.",
            figure(self.noise, 2),
            self.scene,
            figure(mtf, 3),
            self.draws
        )
    }

    /// What has to be measured how well for the MTF that is wished for: section 5.4 of the
    /// published study.
    fn needed(&self) -> String {
        let wished = match self.own {
            Some(own) if own < 1.0 => format!("{} of the picture's own", figure(self.wished, 2)),
            _ => figure(self.wished, 2),
        };
        let both = self.mtf.zip(self.limit());
        let Some((mtf, limit)) = both else {
            return "What must be measured how well, no MTF tells here. What light itself tells of the geometry `phicam calibrate` finds.".to_owned();
        };
        if mtf <= limit {
            return format!(
                "An MTF of {wished} is not reached with the right geometry either: less noise is needed first, not a better measurement."
            );
        }
        let has = |p: &&Sensitivity| p.needed.is_some();
        let of = |p: &Sensitivity| {
            let size = p.needed.unwrap_or_default();
            format!("{} to {} {}", p.name, figure(size, 2), p.unit)
        };
        let critical: Vec<String> = self.parameters.iter().filter(has).map(of).collect();
        let free: Vec<String> = self
            .parameters
            .iter()
            .filter(|p| !has(p))
            .map(|p| p.name.clone())
            .collect();
        let critical = if critical.is_empty() {
            "nothing better than the largest sizes tried here".to_owned()
        } else {
            listed(&critical)
        };
        let others = if free.is_empty() {
            String::new()
        } else {
            format!(" No size tried here matters of {}.", listed(&free))
        };
        format!(
            "What must be measured how well for an MTF of {wished}, each alone, to either side, and the rest right: {critical}.{others} Where several are off at once each has to be better by about the square root of their number. What light itself tells of the geometry `phicam calibrate` finds."
        )
    }

    /// Where the pattern is lost: above the largest size where the MTF holds there, – where none
    /// tells.
    fn lost(&self, thing: &Sensitivity) -> String {
        let holds = |m: &Misplacement| Some(m.mtf? >= 0.5 * self.mtf?);
        let size = |x: f64| format!("{} {}", figure(x, 2), thing.unit);
        match (thing.lost_at, thing.rows.last()) {
            (Some(at), _) => size(at),
            (None, Some(last)) if self.shows_pattern() && holds(last) == Some(true) => {
                format!("> {}", size(last.size))
            }
            _ => "–".to_owned(),
        }
    }

    fn limits(&self) -> Table {
        // Small changes grow in proportion: the smallest tells the slope.
        let things = self
            .parameters
            .iter()
            .map(|p| (p, p.rows.first(), self.lost(p)));
        Table {
            caption: "Change of Φcam where the error is small, and where the pattern is lost, to the side where either is worse"
                .to_owned(),
            ..Table::of(
                things,
                [
                    Column::text("what is off", "").of(|(p, ..)| (&p.name).into()),
                    Column::number("dΦ/Φ a unit", "", "", 2)
                        .of(|(_, r, _)| r.map(|r| r.change / r.size).into()),
                    Column::number("after the best single scale", "", "", 2)
                        .of(|(_, r, _)| r.map(|r| r.after_scale / r.size).into()),
                    Column::number("by derivative", "", "", 2)
                        .of(|(p, ..)| p.by_derivative.map(|d| d[0]).into()),
                    Column::number("by derivative, scaled", "", "", 2)
                        .of(|(p, ..)| p.by_derivative.map(|d| d[1]).into()),
                    Column::text("known to at least", "").of(|(p, ..)| {
                        p.needed
                            .map_or("–".to_owned(), |x| format!("{} {}", figure(x, 2), p.unit))
                            .into()
                    }),
                    Column::text("pattern lost (MTF halved) at", "").of(|(.., lost)| lost.into()),
                ],
            )
        }
    }

    fn sizes(&self) -> Table {
        let all = self.parameters.iter();
        Table {
            caption: "Every size".to_owned(),
            file: Some("tolerance.csv".to_owned()),
            place: Place::Page,
            ..Table::of(
                all.flat_map(|p| p.rows.iter().map(move |r| (p, r))),
                [
                    Column::text("what is off", "what").of(|(p, _)| (&p.name).into()),
                    Column::text("unit", "unit").of(|(p, _)| Cell::name(&p.unit)),
                    Column::number("size", "size", "", 2).of(|(_, r)| r.size.into()),
                    Column::number("‖ΔΦ‖/‖Φ‖", "change", "", 3).of(|(_, r)| r.change.into()),
                    Column::number("after the best single scale", "after_scale", "", 3)
                        .of(|(_, r)| r.after_scale.into()),
                    Column::number("MTF raw", "mtf", "", 3).of(|(_, r)| r.mtf.into()),
                ],
            )
        }
    }

    /// Change of Φcam, and MTF of the recovery, against the size of each misplacement.
    fn figure(&self) -> Figure {
        let mut units = self.parameters.iter().map(|p| p.unit.as_str());
        let unit = units.find(|u| !["deg", "%"].contains(u)).unwrap_or("");
        let size = format!("size of the error ({unit}; angles: degrees; scale: %)");
        let plot = |upwards: Axis, f: fn(&Misplacement) -> Option<f64>| {
            let curve = |p: &Sensitivity| {
                let points = p.rows.iter().filter_map(|r| Some([r.size, f(r)?]));
                Curve::new(&p.name, Mark::Line, points.collect())
            };
            let curves = self.parameters.iter().map(curve).collect();
            Plot::new("", [Axis::decades(&size), upwards], curves)
        };
        Figure {
            file: "tolerance.svg".to_owned(),
            title: format!("How wrong the assumed geometry may be: {}", self.scene),
            note: format!(
                "photographs with {} relative noise, recovered by joint",
                figure(self.noise, 2)
            ),
            plots: vec![
                plot(Axis::decades("‖ΔΦcam‖ / ‖Φcam‖"), |r| {
                    Some(r.change)
                }),
                plot(Axis::linear("raw MTF of the recovery", [-0.2, 1.0]), |r| {
                    r.mtf
                }),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thing(name: &str, unit: &str, mtf: f64, lost_at: Option<f64>) -> Sensitivity {
        let row = |size, mtf| Misplacement {
            size,
            change: 2.0 * size,
            after_scale: size,
            mtf: Some(mtf),
        };
        Sensitivity {
            name: name.to_owned(),
            unit: unit.to_owned(),
            rows: vec![row(1e-3, 1.0), row(1.0, mtf)],
            by_derivative: Some([2.0, 1.0]),
            needed: lost_at.map(|size| 0.5 * size),
            lost_at,
        }
    }

    /// Degrees and inches are not compared; what holds at the largest size is lost beyond it.
    #[test]
    fn what_is_lost_first_is_said_of_each_unit() {
        let found = Tolerance {
            scene: "bench".to_owned(),
            scene_hash: String::new(),
            noise: 0.01,
            draws: 4,
            wished: 0.9,
            own: Some(1.0),
            mtf: Some(0.99),
            parameters: vec![
                thing("hinge angle", "deg", 0.1, Some(0.7)),
                thing("view, x", "in", 0.1, Some(0.3)),
                thing("view, y", "in", 0.1, Some(0.2)),
                thing("S2 along u", "in", 0.9, None),
                thing("S2 along v", "in", 0.1, None),
            ],
        };
        let said = found.describe();
        assert!(
            said.sentence
                .contains("0.990 (mean of 4 draws of the noise")
        );
        let first = "3 of 5 errors of geometry can halve it, first hinge angle off by 0.70 deg and view, y off by 0.20 in.";
        assert!(said.sentence.ends_with(first), "{}", said.sentence);
        let lost: Vec<_> = said.tables[0].rows.iter().map(|r| r[6].clone()).collect();
        let want = ["0.70 deg", "0.30 in", "0.20 in", "> 1.0 in", "–"];
        assert_eq!(lost, want.map(Into::into));
        assert_eq!(said.tables[1].rows.len(), 10);
        let note = &said.notes[0];
        assert!(
            note.contains("hinge angle to 0.35 deg")
                && note.contains("No size tried here matters of S2 along u"),
            "{note}"
        );
        // Less than half of the picture's own modulation is no pattern to lose; a picture of greys
        // is held to its own.
        let faint = Tolerance {
            mtf: Some(0.4),
            ..found.clone()
        };
        let said = faint.describe();
        assert!(said.sentence.contains("is not told"), "{}", said.sentence);
        assert!(
            said.tables[0]
                .rows
                .iter()
                .all(|r| r[6] != "> 1.0 in".into())
        );
        let greys = Tolerance {
            own: Some(0.42),
            ..faint
        };
        let said = greys.describe();
        assert!(said.sentence.contains("3 of 5 errors"), "{}", said.sentence);
        let note = &said.notes[0];
        assert!(
            note.contains("0.90 of the picture's own, each alone"),
            "{note}"
        );
    }
}
