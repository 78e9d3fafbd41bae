//! Tables of a study of noise.

use super::{MEASURES, between};
use crate::lab::finding::{Cell, Column, Table};
use crate::lab::studies::noise::best::Best;
use crate::lab::studies::noise::curve::{LIMITS, Lost, NoiseCurve, Point, Reach};
use crate::lab::studies::noise::picture::Picture;
use crate::lab::studies::noise::study::NoiseStudy;
use crate::num::digits::perhaps;

impl NoiseStudy {
    /// Every threshold.
    pub(super) fn lost(&self) -> Table {
        let [high, low] = LIMITS;
        let label = self.axis.label();
        let mut columns = keys();
        for kind in ["raw", "norm."] {
            columns.extend(LIMITS.map(|l| Column::number(&format!("{kind} {l}"), "", "", 2)));
        }
        let row = |c: &NoiseCurve| {
            let levels = c.lost_raw.iter().chain(&c.lost_normalized);
            let levels = levels.map(|lost| match lost {
                Lost::At(level) => Cell::from(*level),
                Lost::Between(levels) => between(*levels).into(),
                Lost::Before => "lost".into(),
                Lost::Never => "kept".into(),
                Lost::Unknown => "unknown".into(),
            });
            key((c.picture, c.elements), &c.method)
                .chain(levels)
                .collect()
        };
        let caption = format!(
            "{} at which the mean MTF over {} draws falls to {high} and to {low} of the picture's own ({} kernel)",
            label.title, self.seeds, self.kernel
        );
        Table::new(caption, columns, self.curves.iter().map(row)).noted(format!(
            "{} lost: below at the quietest level already; kept: at no level below; unknown: before that some \
             draw gave nothing, or no mean is known (of one draw, above 1.1, to less than a tenth, or of sums W + B that \
             spread by more than a tenth). `a to b`: between these two levels, more than a decade (3 bits) apart. Others \
             are interpolated between two levels: the MTF of a method that drops directions (tsvd) steps between them, \
             and the scatter of the draws does not tell it. Study more levels there (--noise).",
            label.procedure
        ))
    }

    /// The best method of each object, its noise and its distance from the bound.
    pub(super) fn bests(&self) -> Table {
        let mut columns = keys();
        columns.extend(
            ["level", "RMSE", "RMSE over bound"].map(|name| Column::number(name, "", "", 2)),
        );
        let row = |b: &Best| {
            let level = match b.reach {
                Some(Reach::AtLeast) => format!("to {}", perhaps(b.level, 2)).into(),
                _ => Cell::from(b.level),
            };
            let method = b.method.as_deref().unwrap_or("none");
            let found = [level, b.rmse.into(), b.rmse_over_bound.into()];
            key((b.picture, b.elements), method).chain(found).collect()
        };
        let caption = format!(
            "The best method: mean raw MTF of {} of the picture's own or more up to the loudest noise, of equals the least RMSE",
            LIMITS[0]
        );
        Table::new(caption, columns, self.best.iter().map(row)).noted(
            "`to`: the mean has not fallen at this level, but no higher level was studied or its \
             mean is not known (or above 1.1). RMSE over elements and draws; the bound is \
             √(trace/elements) of that of Cramér and Rao for unbiased recoveries, which methods \
             that use bounds or two values can undercut.",
        )
    }

    /// Noise of renders.
    pub(super) fn renders(&self) -> Table {
        let caption =
            "Noise of renders (relative, rms over entries) and the level of an entry as noisy";
        Table {
            caption: caption.to_owned(),
            ..Table::of(
                &self.render_noise,
                [
                    Column::text("estimator", "").of(|m| Cell::name(&m.estimator)),
                    Column::text("samples", "").of(|m| m.samples.into()),
                    Column::number("noise", "", "", 3).of(|m| m.noise.into()),
                    Column::number("level", "", "", 3).of(|m| m.level.into()),
                ],
            )
        }
    }

    /// Every point of every curve.
    pub(super) fn points(&self) -> Table {
        let column = self.axis.label().column;
        let own = ["board", "elements", "method", column, "draws", "failed"];
        let mut keys = [&own[..], &["denominator_spread"]].concat().join(",");
        for (name, ..) in MEASURES {
            keys += &format!(",{name},{name}_deviation,{name}_stderr");
        }
        keys += ",rmse_over_draws,cramer_rao,rmse_over_bound";
        let row = |c: &NoiseCurve, p: &Point| {
            let mut cells: Vec<Cell> = vec![
                Cell::Name(c.picture.to_string()),
                c.elements.into(),
                Cell::name(&c.method),
                p.level.into(),
                p.draws.into(),
                p.failed.into(),
                p.denominator_spread.into(),
            ];
            for (.., of) in MEASURES {
                let s = of(p);
                let [deviation, stderr] = [s.and_then(|s| s.deviation), s.and_then(|s| s.stderr)];
                cells.extend([s.map(|s| s.mean), deviation, stderr].map(Cell::from));
            }
            let bound = [p.rmse_over_draws, p.cramer_rao, p.rmse_over_bound];
            cells.extend(bound.map(Cell::from));
            cells
        };
        let rows = self.curves.iter();
        let rows = rows.flat_map(|c| c.points.iter().map(move |p| row(c, p)));
        Table::of_file("noise-curves.csv", keys.split(','), rows)
    }
}

/// Columns of what a row is of.
fn keys() -> Vec<Column> {
    ["checks", "elements", "method"]
        .map(|key| Column::text(key, ""))
        .to_vec()
}

/// What a row is of.
fn key((picture, n): (Picture, usize), method: &str) -> impl Iterator<Item = Cell> {
    let checks = match picture {
        Picture::Own => "own picture".to_owned(),
        Picture::Board(checks) => format!("{checks} × {checks}"),
    };
    let elements = format!("{n} × {n}");
    [checks, elements]
        .map(Cell::Name)
        .into_iter()
        .chain([Cell::name(method)])
}
