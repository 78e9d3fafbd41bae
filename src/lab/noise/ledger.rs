//! Finished trials as text, from which a study goes on.
//!
//! Comma-separated values below a line that says what was studied. Numbers are written with the
//! fewest digits that bring back the same double, so a study that went on and one that ran through
//! end with the same bytes.

use super::trial::Trial;
use crate::lab::measures::Measures;

const COLUMNS: &str = "board,elements,method,level,seed,mtf_raw,light_plus_dark,mtf_normalized,correlation,rmse,failure";

/// Why a ledger cannot be gone on with.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum LedgerError {
    /// It is of another study.
    #[error(
        "it holds trials of another study ({found}; now asked for: {asked}): give the same settings, or choose another folder (-o)"
    )]
    OtherStudy {
        /// What the file says.
        found: String,
        /// What is studied now.
        asked: String,
    },
    /// A line that no study wrote.
    #[error("line {line} is not a trial: remove that line, or choose another folder (-o)")]
    Damaged {
        /// The line, from 1.
        line: usize,
    },
}

/// The trials as text, sorted; `study` says what they are trials of.
pub fn write_ledger(study: &str, trials: &[Trial]) -> String {
    let mut sorted: Vec<&Trial> = trials.iter().collect();
    sorted.sort_by(|a, b| a.order(b));
    let mut text = format!("# {study}\n{COLUMNS}\n");
    for t in sorted {
        let key = format!(
            "{},{},{},{:e},{}",
            t.board, t.elements, t.method, t.level, t.seed
        );
        let (measures, failure) = match &t.outcome {
            Ok(measures) => (measures.all(), String::new()),
            Err(why) => {
                let why = why.replace('"', "'").replace(['\n', '\r'], " ");
                ([None; 5], format!("\"{why}\""))
            }
        };
        let measures = measures.map(|x| x.map_or(String::new(), |x| format!("{x:e}")));
        text += &format!("{key},{},{failure}\n", measures.join(","));
    }
    text
}

/// The trials of a text by [`write_ledger`].
///
/// # Errors
/// [`LedgerError`].
pub fn read_ledger(study: &str, text: &str) -> Result<Vec<Trial>, LedgerError> {
    let mut lines = text.lines().enumerate();
    let first = lines.next().map_or("", |(_, line)| line);
    let found = first
        .strip_prefix("# ")
        .ok_or(LedgerError::Damaged { line: 1 })?;
    if found != study {
        return Err(LedgerError::OtherStudy {
            found: found.to_owned(),
            asked: study.to_owned(),
        });
    }
    if lines.next().is_none_or(|(_, line)| line != COLUMNS) {
        return Err(LedgerError::Damaged { line: 2 });
    }
    lines
        .map(|(at, line)| trial(line).ok_or(LedgerError::Damaged { line: at + 1 }))
        .collect()
}

fn trial(line: &str) -> Option<Trial> {
    let parts: Vec<&str> = line.splitn(11, ',').collect();
    let [board, elements, method, level, seed, measures @ .., failure] = &parts[..] else {
        return None;
    };
    let measures = <[&str; 5]>::try_from(measures).ok()?;
    // An empty field is an absent number; anything else has to be one.
    let number = |text: &&str| match *text {
        "" => Some(None),
        text => text.parse().ok().filter(|x: &f64| x.is_finite()).map(Some),
    };
    let outcome = match *failure {
        "" => {
            let measures: Option<Vec<Option<f64>>> = measures.iter().map(number).collect();
            Ok(Measures::from(<[_; 5]>::try_from(measures?).ok()?))
        }
        quoted => Err(quoted.strip_prefix('"')?.strip_suffix('"')?.to_owned()),
    };
    Some(Trial {
        board: board.parse().ok()?,
        elements: elements.parse().ok()?,
        method: method.parse().ok()?,
        level: level.parse().ok()?,
        seed: seed.parse().ok()?,
        outcome,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::Method;

    fn trials() -> Vec<Trial> {
        let measures = Measures {
            mtf_raw: Some(0.1 + 0.2),
            light_plus_dark: Some(-1e300),
            mtf_normalized: Some(-1.0 / 3.0),
            correlation: None,
            rmse: Some(5e-324),
        };
        let trial = |seed, outcome| Trial {
            board: 2,
            elements: 8,
            method: Method::JointUnbounded,
            level: 1e-9 / 3.0,
            seed,
            outcome,
        };
        vec![
            trial(1, Ok(measures)),
            trial(u64::MAX, Err("no signal, and none at all".to_owned())),
        ]
    }

    #[test]
    fn what_is_written_is_read_back_to_the_last_bit() {
        let mut reversed = trials();
        reversed.reverse();
        let text = write_ledger("a study", &reversed);
        assert_eq!(read_ledger("a study", &text), Ok(trials()));
        assert_eq!(write_ledger("a study", &trials()), text);
    }

    #[test]
    fn other_studies_and_damage_are_told() {
        let text = write_ledger("a study", &trials());
        assert!(matches!(
            read_ledger("b study", &text),
            Err(LedgerError::OtherStudy { .. })
        ));
        for (from, to, line) in [
            ("# a", "a", 1),
            ("board", "bard", 2),
            ("joint-unbounded,3", "joint-unbound,3", 3),
            ("e-1,", "e-1x,", 3),
            ("no signal", "no signal\n", 4),
        ] {
            assert!(text.contains(from), "{from}: {text}");
            let damaged = text.replacen(from, to, 1);
            assert_eq!(
                read_ledger("a study", &damaged),
                Err(LedgerError::Damaged { line }),
                "{damaged}"
            );
        }
    }
}
