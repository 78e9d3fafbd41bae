//! Tables, figures and pictures of a calibration.

use crate::lab::finding::{Axis, Cell, Column, Curve, Figure, Gallery, Mark, Picture, Plot, Table};
use crate::lab::geometry::calibrate::{Calibrated, Calibration};
use crate::lab::geometry::located::Grid;

impl Calibration {
    pub(super) fn table(&self) -> Table {
        let rows = self.in_order().into_iter().chain(self.gains());
        Table {
            caption: "From what the scene says, and its errors".to_owned(),
            file: Some("calibration.csv".to_owned()),
            ..Table::of(
                rows,
                [
                    (Column::text("unknown", "unknown"), |f: &&Calibrated| {
                        Cell::name(&f.name)
                    }),
                    (Column::text("unit", "unit"), |f| Cell::name(&f.unit)),
                    (Column::number("known to", "prior", "", 2), |f| {
                        f.prior.into()
                    }),
                    (Column::number("estimate", "estimate", "", 5), |f| {
                        f.value.into()
                    }),
                    (Column::number("± error", "stderr", "", 2), |f| {
                        f.stderr.into()
                    }),
                    (Column::number("by curvature", "by_curvature", "", 2), |f| {
                        f.by_curvature.into()
                    }),
                    (Column::number("by frames", "by_frames", "", 2), |f| {
                        f.by_frames.into()
                    }),
                    (Column::number("by blocks", "by_blocks", "", 2), |f| {
                        f.by_blocks.into()
                    }),
                    (
                        Column::number("by other pictures", "by_pictures", "", 2),
                        |f| f.by_pictures.into(),
                    ),
                    (Column::number("by finer rule", "by_rule", "", 2), |f| {
                        f.by_rule.into()
                    }),
                    (
                        Column::number("by finer elements", "by_elements", "", 2),
                        |f| f.by_elements.into(),
                    ),
                    (
                        Column::number("by 1 % of even light", "by_even_light", "", 2),
                        |f| f.by_even_light.into(),
                    ),
                ],
            )
        }
    }

    pub(super) fn told(&self) -> Table {
        Table {
            caption: format!(
                "What the photographs could tell, before anything was fitted: standard errors{}",
                if self.p.is_some() {
                    ""
                } else {
                    " at a noise of 3 % of the light"
                }
            ),
            file: Some("identifiability.csv".to_owned()),
            ..Table::of(
                self.in_order(),
                [
                    (Column::text("unknown", "unknown"), |f: &&Calibrated| {
                        Cell::name(&f.name)
                    }),
                    (Column::text("unit", "unit"), |f| Cell::name(&f.unit)),
                    (Column::number("all else known", "alone", "", 2), |f| {
                        f.identified.alone.into()
                    }),
                    (
                        Column::number("picture unknown", "picture_unknown", "", 2),
                        |f| f.identified.picture_unknown.into(),
                    ),
                    (Column::number("all unknown", "by_light", "", 2), |f| {
                        f.identified.by_light.into()
                    }),
                    (
                        Column::number("with what is known", "with_prior", "", 2),
                        |f| f.identified.with_prior.into(),
                    ),
                ],
            )
        }
    }

    /// How the likelihood falls along each parameter.
    pub(super) fn figures(&self) -> Vec<Figure> {
        let plot = |f: &Calibrated| {
            let profile = f.profile.as_ref()?;
            let points: Vec<[f64; 2]> = profile.points.iter().map(|(x, y)| [*x, *y]).collect();
            let ends = |k: usize| {
                let each = points.iter().map(|p| p[k]);
                [
                    each.clone().fold(f64::INFINITY, f64::min),
                    each.fold(f64::NEG_INFINITY, f64::max),
                ]
            };
            let title = format!("{} ({})", f.name, f.unit);
            let axes = [
                Axis::linear(&title, ends(0)),
                Axis::linear("log likelihood", ends(1)),
            ];
            let curve = Curve::new("log likelihood", Mark::Line, points);
            Some(Plot::new("", axes, vec![curve]))
        };
        let plots: Vec<Plot> = self.geometry().filter_map(plot).collect();
        if plots.is_empty() {
            return Vec::new();
        }
        vec![Figure::new(
            "profiles.svg",
            "Likelihood along each parameter, the others following",
            plots,
        )]
    }

    /// The picture and its errors; of a free scale, of which only ratios are told, over its
    /// brightest element.
    pub(super) fn gallery(&self) -> Gallery {
        let all = self.grids.iter().flat_map(|g| &g.values);
        let brightest = all.fold(0.0, |most: f64, x| most.max(*x));
        let (unit, over) = if self.scale != 1.0 && brightest > 0.0 {
            (brightest, " over its brightest element")
        } else {
            (1.0, "")
        };
        let of = |title: String, count: [usize; 2], values: &[f64]| Picture {
            title,
            size: count,
            values: values.iter().map(|x| x / unit).collect(),
            axes: ["u", "v"].map(str::to_owned),
            width: 2.0,
        };
        let both = |grid: &Grid| {
            [
                of(grid.surface.clone(), grid.count, &grid.values),
                of(
                    format!("{}: standard errors", grid.surface),
                    grid.count,
                    &grid.stderr,
                ),
            ]
        };
        Gallery::reflectances(
            format!(
                "The picture with the calibrated geometry{over}, and its errors with those of the geometry"
            ),
            self.grids.iter().flat_map(both).collect(),
        )
    }
}
