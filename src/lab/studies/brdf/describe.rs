//! What the study of wall BRDFs says.

use super::results::{Assumption, BrdfStudy, Quality};
use crate::lab::ensemble::Spread;
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Place, Plot, Table, Tone, listed,
};
use crate::num::digits::figure;

impl Describe for BrdfStudy {
    fn describe(&self) -> Finding {
        let known = &self.known().agreement;
        let albedos = self.relay_albedo.iter().map(|a| figure(*a, 4));
        let mut tables = vec![self.agreements(), self.file()];
        tables.extend((0..self.known().qualities.len()).map(|k| self.recovered(k)));
        tables.push(self.compared());
        Finding {
            title: format!("What knowing the wall's BRDF is worth: {}", self.scene),
            tone: if known.agrees { Tone::Good } else { Tone::Bad },
            sentence: self.sentence(),
            notes: vec![format!(
                "Light of three bounces; white-sky albedo of the wall {}.",
                albedos.collect::<Vec<_>>().join(", ")
            )],
            tables,
            figures: vec![self.figure()],
            ..Finding::default()
        }
    }
}

impl BrdfStudy {
    /// Whether the light agrees with the model that knows the wall, what it rejects, and what is
    /// recovered.
    fn sentence(&self) -> String {
        let g = &self.known().agreement;
        let named = |agrees: bool| -> Vec<String> {
            let others = self.assumptions.iter().skip(1);
            let own = others.filter(|a| a.agreement.agrees == agrees);
            own.map(|a| {
                let off = figure(a.agreement.relative_difference, 2);
                format!("{} (off by {off})", a.name)
            })
            .collect()
        };
        let accepted = named(true);
        let also = if accepted.is_empty() {
            String::new()
        } else {
            format!("; it also accepts {}", listed(&accepted))
        };
        let judged: Vec<bool> = self.ratios.iter().filter_map(|r| r.reaches).collect();
        format!(
            "On {}, at a significance of {}, the traced light {} the model that has the \
             wall's true BRDF (difference {}, of which noise {}); the test rejects {}{also}. With \
             the known BRDF, {} of {} recoveries that succeed on a Lambertian wall do as well \
             within 10 %.",
            self.scene,
            figure(g.significance, 2),
            if g.agrees { "agrees with" } else { "REJECTS" },
            figure(g.relative_difference, 2),
            figure(g.relative_noise, 2),
            listed(&named(false)),
            judged.iter().filter(|reaches| **reaches).count(),
            judged.len(),
        )
    }

    /// Every assumption against the light.
    fn agreements(&self) -> Table {
        Table {
            caption: format!(
                "Assumed BRDFs of the wall against the light traced by {} with {} samples",
                self.estimator, self.samples
            ),
            ..Table::of(
                self.rows(),
                [
                    Column::text("assumed of the wall", "").of(|a| (&a.name).into()),
                    Column::text("verdict", "").of(|a| verdict(a).into()),
                    Column::number("difference", "", "", 3)
                        .of(|a| a.agreement.relative_difference.into()),
                    Column::number("noise", "", "", 3).of(|a| a.agreement.relative_noise.into()),
                    Column::number("largest z", "", "", 3).of(|a| a.agreement.largest_z.into()),
                    Column::number("scale", "", "", 5).of(|a| a.scale.into()),
                ],
            )
        }
    }

    /// What is recovered under every assumption by one method at one level of noise.
    fn recovered(&self, k: usize) -> Table {
        let Quality { method, noise, .. } = &self.known().qualities[k];
        let rows = || self.rows().map(|a| (&a.name, &a.qualities[k]));
        let reason = |(name, q): (&String, &Quality)| {
            let (failed, reason) = (q.failed, q.reason.as_ref()?);
            Some(format!("{name}: {failed} draws gave nothing: {reason}."))
        };
        Table {
            caption: format!(
                "Recovered by {method} at a noise of {} of each entry, {} draws",
                figure(*noise, 2),
                self.draws
            ),
            note: rows().filter_map(reason).collect::<Vec<_>>().join(" "),
            ..Table::of(
                rows(),
                [
                    Column::text("assumed of the wall", "").of(|(name, _)| (*name).into()),
                    Column::estimate("MTF raw", "", "", 4).of(|(_, q)| Cell::spread(q.mtf_raw)),
                    Column::estimate("correlation", "", "", 4)
                        .of(|(_, q)| Cell::spread(q.correlation)),
                    Column::estimate("RMSE", "", "", 4).of(|(_, q)| Cell::spread(q.rmse)),
                ],
            )
        }
    }

    fn compared(&self) -> Table {
        Table {
            caption: "Recovery with the known BRDF over that of a Lambertian wall of equal albedo"
                .to_owned(),
            ..Table::of(
                &self.ratios,
                [
                    Column::text("method", "").of(|r| Cell::name(&r.method)),
                    Column::number("noise", "", "", 2).of(|r| r.noise.into()),
                    Column::number("MTF raw ×", "", "", 4).of(|r| r.mtf_raw.into()),
                    Column::number("correlation ×", "", "", 4).of(|r| r.correlation.into()),
                    Column::number("RMSE ×", "", "", 4).of(|r| r.rmse.into()),
                    Column::text("reaches it within 10 %", "").of(|r| {
                        match r.reaches {
                            Some(true) => "yes",
                            Some(false) => "NO",
                            None => "that one recovers nothing either",
                        }
                        .into()
                    }),
                ],
            )
        }
    }

    /// Every assumption with every method and level.
    fn file(&self) -> Table {
        let all = self.rows();
        let number = |key| Column::number("", key, "", 0);
        let estimate = |key| Column::estimate("", key, "", 0);
        Table {
            file: Some("brdf.csv".to_owned()),
            place: Place::File,
            ..Table::of(
                all.flat_map(|a| a.qualities.iter().map(move |q| (a, &a.agreement, q))),
                [
                    number("assumed").of(|(a, ..)| (&a.name).into()),
                    number("agrees").of(|(_, g, _)| g.agrees.into()),
                    number("relative_difference").of(|(_, g, _)| g.relative_difference.into()),
                    number("relative_noise").of(|(_, g, _)| g.relative_noise.into()),
                    number("largest_z").of(|(_, g, _)| g.largest_z.into()),
                    number("scale").of(|(a, ..)| a.scale.into()),
                    number("method").of(|(.., q)| Cell::name(&q.method)),
                    number("noise").of(|(.., q)| q.noise.into()),
                    estimate("mtf_raw").of(|(.., q)| Cell::spread(q.mtf_raw)),
                    estimate("correlation").of(|(.., q)| Cell::spread(q.correlation)),
                    estimate("rmse").of(|(.., q)| Cell::spread(q.rmse)),
                    number("failed").of(|(.., q)| q.failed.into()),
                ],
            )
        }
    }

    /// Raw MTF and RMSE of the last method against the noise, one line an assumption, its verdict
    /// in the legend.
    fn figure(&self) -> Figure {
        let known = self.known();
        let method = known.qualities.last().map_or("", |q| &q.method);
        let plot = |upwards: Axis, f: fn(&Quality) -> Option<Spread>| {
            let curve = |a: &Assumption| {
                let own = a.qualities.iter().filter(|q| q.method == method);
                let points = own.filter_map(|q| Some([q.noise, f(q)?.mean]));
                let mut points: Vec<[f64; 2]> = points.collect();
                points.sort_by(|a, b| a[0].total_cmp(&b[0]));
                Curve::new(format!("{} ({})", a.name, verdict(a)), Mark::Line, points)
            };
            let across = Axis::decades("relative noise of each entry of Φcam");
            Plot::new("", [across, upwards], self.rows().map(curve).collect())
        };
        let mtf = Axis::linear("raw MTF of the recovery", [-0.2, 1.0]);
        Figure {
            file: "brdf.svg".to_owned(),
            title: format!("What knowing the wall's BRDF is worth: {}", self.scene),
            note: format!(
                "recovered by {method}; verdicts on the model's integral at a significance of {}",
                figure(known.agreement.significance, 2)
            ),
            plots: vec![
                plot(mtf, |q| q.mtf_raw),
                plot(Axis::decades("RMSE of the reflectances"), |q| q.rmse),
            ],
        }
    }
}

fn verdict(a: &Assumption) -> &'static str {
    if a.agreement.agrees {
        "agrees"
    } else {
        "rejected"
    }
}
