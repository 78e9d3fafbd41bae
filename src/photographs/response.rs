//! From stored values to light: the inverse of a camera's response.

use super::error::{PhotographError, refused};

/// R⁻¹, from the value that a file stores to light in counts.
#[derive(Clone, Debug, PartialEq)]
pub enum Response {
    /// Values are counts of light.
    Linear,
    /// light = S·(s/S)^γ with the full scale S.
    Gamma {
        /// γ, above 0.
        exponent: f64,
        /// S, above 0.
        full_scale: f64,
    },
    /// Linear between measured pairs, and straight on beyond them.
    Table(ResponseTable),
}

/// Pairs of stored value and light, both rising.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseTable {
    stored: Vec<f64>,
    light: Vec<f64>,
}

impl ResponseTable {
    /// The table of (stored value, light) pairs.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] for fewer than two pairs, or such that do not rise.
    pub fn new(pairs: &[[f64; 2]]) -> Result<Self, PhotographError> {
        let rises = |k: usize| pairs.windows(2).all(|w| w[0][k] < w[1][k]);
        let is_finite = pairs.iter().flatten().all(|x| x.is_finite());
        if pairs.len() < 2 || !is_finite || !rises(0) || !rises(1) {
            return Err(refused(
                "the response table does not rise from line to line",
                "give two or more lines of `stored value,light`, both rising",
            ));
        }
        Ok(Self {
            stored: pairs.iter().map(|p| p[0]).collect(),
            light: pairs.iter().map(|p| p[1]).collect(),
        })
    }

    /// That stored values lie beyond the table, up to `highest`.
    pub(super) fn beyond(&self, highest: f64) -> Option<String> {
        let last = self.stored.iter().copied().fold(0.0, f64::max);
        (highest > last).then(|| {
            format!(
                "stored values reach {highest} and the response table ends at {last}: light beyond is its last \
                 line drawn on; measure the response farther, or give `saturation = {last}`"
            )
        })
    }

    /// Light and slope at `s`.
    fn at(&self, s: f64) -> [f64; 2] {
        let last = self.stored.len() - 2;
        let k = self.stored.partition_point(|x| *x <= s);
        let k = k.saturating_sub(1).min(last);
        let slope = (self.light[k + 1] - self.light[k]) / (self.stored[k + 1] - self.stored[k]);
        [self.light[k] + slope * (s - self.stored[k]), slope]
    }
}

/// The lines `stored,light` of a CSV file; lines that do not begin with a number are passed over.
pub(super) fn response_table(name: &str, bytes: &[u8]) -> Result<ResponseTable, PhotographError> {
    let text = String::from_utf8_lossy(bytes);
    let mut pairs = Vec::new();
    let text = text.trim_start_matches('\u{feff}');
    for (k, line) in text.lines().enumerate() {
        let cells: Vec<Option<f64>> = line.split(',').map(|c| c.trim().parse().ok()).collect();
        match cells[..] {
            [Some(stored), Some(light)] => pairs.push([stored, light]),
            [None, ..] if pairs.is_empty() || line.trim().is_empty() => {}
            _ => {
                return Err(refused(
                    format!("line {} of {name} is not `stored,light`", k + 1),
                    "give two numbers a line",
                ));
            }
        }
    }
    ResponseTable::new(&pairs)
}

impl Response {
    /// A power law of the full scale.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] for an exponent that no camera has (below 0.1 or above 10) and
    /// a scale that is not positive.
    pub fn gamma(exponent: f64, full_scale: f64) -> Result<Self, PhotographError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if (0.1..=10.0).contains(&exponent) && positive(full_scale) {
            return Ok(Self::Gamma {
                exponent,
                full_scale,
            });
        }
        Err(refused(
            format!("gamma {exponent} of the full scale {full_scale} has no meaning"),
            "use a gamma from 0.1 to 10, e.g. 2.2, and a full scale above 0",
        ))
    }

    /// Light of the stored value `s`, and how much it rises for one more.
    pub fn light(&self, s: f64) -> [f64; 2] {
        match self {
            Self::Linear => [s, 1.0],
            Self::Gamma {
                exponent,
                full_scale,
            } => {
                let x = s.max(0.0) / full_scale;
                let slope = exponent * libm::pow(x, exponent - 1.0);
                // At 0 the slope of a power below 1 has no end: that of half a step is taken.
                let at_half = exponent * libm::pow(0.5 / full_scale, exponent - 1.0);
                [
                    full_scale * libm::pow(x, *exponent),
                    slope.min(at_half.max(*exponent)),
                ]
            }
            Self::Table(table) => table.at(s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_beyond_the_table_are_told() {
        let table = ResponseTable::new(&[[0.0, 0.0], [1000.0, 3000.0]]).unwrap();
        assert_eq!(table.beyond(1000.0), None);
        let told = table.beyond(1001.0).unwrap();
        assert!(
            told.contains("reach 1001") && told.contains("saturation = 1000"),
            "{told}"
        );
    }

    /// The first pair counts too where a spreadsheet put a byte-order mark before it.
    #[test]
    fn a_byte_order_mark_is_read_over() {
        let table = response_table("r.csv", "\u{feff}0,1\r\n10,2\r\n20,6\r\n".as_bytes());
        assert_eq!(Response::Table(table.unwrap()).light(5.0), [1.5, 0.1]);
    }

    #[test]
    fn light_is_the_power_and_the_line() {
        let gamma = Response::gamma(2.0, 200.0).unwrap();
        assert_eq!(gamma.light(100.0), [50.0, 1.0]);
        assert_eq!(gamma.light(200.0), [200.0, 2.0]);
        let pairs = [[0.0, 1.0], [10.0, 2.0], [20.0, 6.0]];
        let table = Response::Table(ResponseTable::new(&pairs).unwrap());
        for (s, light) in [
            (5.0, [1.5, 0.1]),
            (15.0, [4.0, 0.4]),
            (30.0, [10.0, 0.4]),
            (-10.0, [0.0, 0.1]),
        ] {
            assert_eq!(table.light(s), light);
        }
        assert!(ResponseTable::new(&pairs[..1]).is_err());
        assert!(ResponseTable::new(&[[0.0, 1.0], [1.0, 1.0]]).is_err());
        assert!(Response::gamma(0.0, 255.0).is_err());
    }
}
