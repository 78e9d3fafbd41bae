//! Exact answers that a scene states about itself.

use super::error::{Fault, keys};
use super::file::KnownTable;

/// An exact entry of Φcam, from a closed form or a converged quadrature: for tests, and for users'
/// own checks.
///
/// It holds for the scene as it is written; a variant of the scene keeps the original's answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Pixel index.
    pub pixel: usize,
    /// Spot index.
    pub spot: usize,
    /// Flux into the pixel when that spot is lit, W.
    pub flux: f64,
    /// Only light that met exactly so many surfaces; `None`: all light of up to `max_bounces`
    /// surfaces.
    pub bounces: Option<u32>,
}

impl Known {
    /// Checks all answers against what the scene has: pixels, spots, orders.
    pub(super) fn from_tables(
        tables: &[KnownTable],
        pixels: usize,
        spots: usize,
        max_bounces: u32,
    ) -> Result<Vec<Self>, Fault> {
        let mut all: Vec<Self> = Vec::with_capacity(tables.len());
        for (i, table) in tables.iter().enumerate() {
            let refuse = |key, cause: String, cure: &str| {
                Err(Fault::new(keys!["known", i, key], cause, cure))
            };
            let known = Self {
                pixel: index(table.pixel, pixels, "pixel")
                    .map_err(|f| f.within(keys!["known", i]))?,
                spot: index(table.spot, spots, "spot").map_err(|f| f.within(keys!["known", i]))?,
                flux: table.flux,
                bounces: table.bounces,
            };
            if !(known.flux >= 0.0 && known.flux.is_finite()) {
                let cause = format!("a known flux of {} W", known.flux);
                return refuse("flux", cause, "give a finite flux in W, 0 or more");
            }
            if let Some(n) = known.bounces.filter(|n| !(1..=max_bounces).contains(n)) {
                let cause =
                    format!("light of {n} bounces is not traced: max_bounces is {max_bounces}");
                return refuse(
                    "bounces",
                    cause,
                    "use 1 to max_bounces, or raise max_bounces",
                );
            }
            let same =
                |k: &Self| (k.pixel, k.spot, k.bounces) == (known.pixel, known.spot, known.bounces);
            if all.iter().any(same) {
                let cause = format!(
                    "the flux of pixel {} and spot {} is stated twice",
                    known.pixel, known.spot
                );
                return Err(Fault::new(
                    keys!["known", i],
                    cause,
                    "remove one of the two",
                ));
            }
            all.push(known);
        }
        Ok(all)
    }
}

/// An index below `count`.
fn index(value: u64, count: usize, what: &'static str) -> Result<usize, Fault> {
    usize::try_from(value)
        .ok()
        .filter(|i| *i < count)
        .ok_or_else(|| {
            let plural = if count == 1 { "" } else { "s" };
            let cause = format!("{what} {value} of a scene with {count} {what}{plural}");
            let cure = format!("{what}s count from 0: use 0 to {}", count - 1);
            Fault::new(keys![what], cause, cure)
        })
}

#[cfg(test)]
mod tests {
    use super::super::{Scene, SceneError};
    use super::Known;

    const BENCH: &str = include_str!("../../scenes/bench.toml");

    fn with(table: &str) -> Result<Scene, SceneError> {
        Scene::from_toml("my.toml", &format!("{BENCH}\n[[known]]\n{table}\n"))
    }

    #[test]
    fn answers_are_read_as_written() {
        let scene = with(
            "pixel = 255\nspot = 119\nflux = 1.5e-12\n[[known]]\npixel = 0\nspot = 0\nflux = 0\nbounces = 3",
        );
        let all = |pixel, spot, flux, bounces| Known {
            pixel,
            spot,
            flux,
            bounces,
        };
        assert_eq!(
            scene.unwrap().known,
            [all(255, 119, 1.5e-12, None), all(0, 0, 0.0, Some(3))]
        );
    }

    /// What is known of a scene does not change its light, and so not its hash.
    #[test]
    fn answers_do_not_change_the_hash() {
        let bare = Scene::from_toml("my.toml", BENCH).unwrap();
        assert!(bare.known.is_empty());
        assert_eq!(
            with("pixel = 0\nspot = 0\nflux = 1.0").unwrap().hash,
            bare.hash
        );
    }

    #[test]
    fn impossible_answers_are_refused_where_they_stand() {
        for (table, line, cause, cure) in [
            (
                "pixel = 256\nspot = 0\nflux = 1.0",
                "pixel = 256",
                "256 pixels",
                "0 to 255",
            ),
            (
                "pixel = 0\nspot = 120\nflux = 1.0",
                "spot = 120",
                "120 spots",
                "0 to 119",
            ),
            (
                "pixel = -1\nspot = 0\nflux = 1.0",
                "pixel = -1",
                "invalid value",
                "",
            ),
            (
                "pixel = 0\nspot = 0\nflux = -1.0",
                "flux = -1.0",
                "-1 W",
                "0 or more",
            ),
            (
                "pixel = 0\nspot = 0\nflux = nan",
                "flux = nan",
                "NaN W",
                "finite",
            ),
            (
                "pixel = 0\nspot = 0\nflux = inf",
                "flux = inf",
                "inf W",
                "finite",
            ),
            (
                "pixel = 0\nspot = 0\nflux = 1.0\nbounces = 0",
                "bounces = 0",
                "0 bounces",
                "1 to",
            ),
            (
                "pixel = 0\nspot = 0\nflux = 1.0\nbounces = 4",
                "bounces = 4",
                "max_bounces is 3",
                "raise",
            ),
            (
                "pixel = 0\nspot = 0\nflux = \"much\"",
                "flux = \"much\"",
                "invalid type",
                "",
            ),
            (
                "pixel = 0\nspot = 0\nfluks = 1.0",
                "fluks = 1.0",
                "unknown field",
                "`flux`",
            ),
            (
                "pixel = 0\nspot = 0\nflux = 1.0\nbounce = 3",
                "bounce = 3",
                "unknown field",
                "`bounces`",
            ),
            (
                "pixel = 0\nspot = 0",
                "[[known]]",
                "missing field `flux`",
                "add `flux",
            ),
        ] {
            let error = with(table).unwrap_err();
            assert_eq!(error.place.as_ref().unwrap().text, line, "{error}");
            assert!(error.cause.contains(cause), "{error}");
            assert!(error.cure.contains(cure), "{error}");
        }
        let twice = "pixel = 0\nspot = 0\nflux = 1.0\n[[known]]\npixel = 0\nspot = 0\nflux = 2.0";
        assert!(with(twice).unwrap_err().cause.contains("twice"));
        let orders = twice.replacen("flux = 2.0", "flux = 2.0\nbounces = 3", 1);
        assert!(with(&orders).is_ok());
    }

    #[test]
    fn a_misspelt_table_is_told_its_name() {
        let text = format!("{BENCH}\n[[knwon]]\npixel = 0\n");
        let error = Scene::from_toml("my.toml", &text).unwrap_err();
        assert!(error.cure.contains("`known`"), "{error}");
    }
}
