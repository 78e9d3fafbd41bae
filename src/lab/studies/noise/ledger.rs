//! Every trial as text: comma-separated values below a line that says what was studied. Numbers are
//! written with the fewest digits that bring back the same double.

use super::trial::Trial;

const COLUMNS: &str = "board,elements,method,level,seed,mtf_raw,light_plus_dark,mtf_normalized,correlation,rmse,failure";

/// The trials as text, sorted; `study` says what they are trials of.
pub(super) fn write_ledger(study: &str, trials: &[Trial]) -> String {
    let mut sorted: Vec<&Trial> = trials.iter().collect();
    sorted.sort_by(|a, b| a.order(b));
    let mut text = format!("# {study}\n{COLUMNS}\n");
    for t in sorted {
        let key = format!(
            "{},{},{},{:e},{}",
            t.picture, t.elements, t.method, t.level, t.seed
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

#[cfg(test)]
mod tests {
    use super::super::picture::Picture;
    use super::*;
    use crate::lab::recovered::measures::Measures;
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
            picture: Picture::Board(2),
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
    fn trials_are_sorted_and_keep_every_bit() {
        let mut reversed = trials();
        reversed.reverse();
        let text = write_ledger("a study", &reversed);
        assert_eq!(write_ledger("a study", &trials()), text);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[..2], ["# a study", COLUMNS]);
        let fields: Vec<&str> = lines[2].split(',').collect();
        assert_eq!(fields[..3], ["2", "8", "joint-unbounded"]);
        let numbers: Vec<Option<f64>> = fields[3..10].iter().map(|x| x.parse().ok()).collect();
        let measures = [
            Some(0.1 + 0.2),
            Some(-1e300),
            Some(-1.0 / 3.0),
            None,
            Some(5e-324),
        ];
        assert_eq!(numbers[0], Some(1e-9 / 3.0));
        assert_eq!(numbers[2..], measures);
        let failed = format!(",{},,,,,,\"no signal, and none at all\"", u64::MAX);
        assert!(lines[3].ends_with(&failed), "{}", lines[3]);
    }
}
