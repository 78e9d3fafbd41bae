//! What was recovered, in words and tables.

use super::objects::RecoveredObject;
use crate::lab::finding::{Cell, Column, Finding, Table};
use crate::num::digits::{figure, significant};
use crate::recovery::Method;

/// What was recovered of each surface, in the order in which they first appear: a run lists it
/// method by method.
pub fn by_surface(recovered: &[RecoveredObject]) -> Vec<Vec<&RecoveredObject>> {
    let mut groups: Vec<Vec<&RecoveredObject>> = Vec::new();
    for object in recovered {
        let same = |group: &&mut Vec<&RecoveredObject>| {
            group[0].surface == object.surface && group[0].elements == object.elements
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(object),
            None => groups.push(vec![object]),
        }
    }
    groups
}

/// A table for each hidden surface.
pub(in crate::lab) fn recoveries(recovered: &[RecoveredObject]) -> Vec<Table> {
    by_surface(recovered)
        .iter()
        .flat_map(|group| [recovery(group), fits(group)])
        .collect()
}

/// What speaks against believing what was recovered; each warning once, after the methods that it
/// concerns.
pub fn warnings(recovered: &[RecoveredObject]) -> Vec<String> {
    let mut told: Vec<(&str, Vec<&str>)> = Vec::new();
    for object in recovered {
        for warning in &object.warnings {
            let at = match told.iter().position(|(text, _)| text == warning) {
                Some(at) => at,
                None => {
                    told.push((warning, Vec::new()));
                    told.len() - 1
                }
            };
            // The surfaces of a method share its warnings.
            if !told[at].1.contains(&object.method.as_str()) {
                told[at].1.push(&object.method);
            }
        }
    }
    let line = |(text, methods): (&str, Vec<&str>)| format!("{}: {text}.", methods.join(", "));
    told.into_iter().map(line).collect()
}

/// What was recovered of each hidden surface.
pub fn describe_recovery(recovered: &[RecoveredObject]) -> Finding {
    Finding {
        notes: warnings(recovered),
        tables: recoveries(recovered),
        ..Finding::default()
    }
}

/// How good each method is on one surface, and what it chose; of a single element what it found.
pub fn recovery(group: &[&RecoveredObject]) -> Table {
    let [nu, nv] = group.first().map_or([0; 2], |first| first.elements);
    let surface = group.first().map_or("", |first| &first.surface);
    let known = group.first().is_some_and(|first| first.truth.is_some());
    let (names, caption) = if [nu, nv] == [1, 1] {
        let names = ["reflectance", "standard error", "truth"];
        let names = &names[..2 + usize::from(known)];
        (names.to_vec(), format!("recovered: {surface}, one element"))
    } else {
        let names = ["MTF raw", "MTF normalized", "correlation", "RMSE"];
        let names = if known { names.to_vec() } else { Vec::new() };
        (names, format!("recovered: {surface}, {nu} × {nv} elements"))
    };
    let numbers = |r: &RecoveredObject| -> Vec<Option<f64>> {
        if [nu, nv] == [1, 1] {
            let stderr = r.standard_error.as_ref().map(|s| s[0]);
            let truth = r.truth.as_ref().map(|t| t[0]);
            vec![Some(r.reflectance[0]), stderr, truth]
        } else {
            vec![r.mtf_raw, r.mtf_normalized, r.correlation, r.rmse]
        }
    };
    let row = |r: &&RecoveredObject| {
        let numbers = numbers(r).into_iter().take(names.len()).map(Cell::from);
        let method = std::iter::once(r.method.as_str().into());
        let chosen = std::iter::once(r.parameter.as_str().into());
        method.chain(numbers).chain(chosen).collect()
    };
    let numbers = names.iter().map(|name| Column::number(name, "", "", 3));
    Table {
        caption,
        columns: std::iter::once(Column::text("method", ""))
            .chain(numbers)
            .chain([Column::text("parameter", "")])
            .collect(),
        rows: group.iter().map(row).collect(),
        ..Table::default()
    }
}

/// Whether each method's picture explains the photographs.
pub fn fits(group: &[&RecoveredObject]) -> Table {
    let fits = |r: &RecoveredObject| match &r.fit {
        Some(fit) if fit.is_open() || fit.is_blind() => "open",
        Some(fit) if fit.fits => "yes",
        Some(_) => "NO",
        None => "not known",
    };
    let judged = group.iter().map(|r| (fits(r), *r, r.fit.as_ref()));
    Table {
        caption: "does what each would photograph fit the photographs?".to_owned(),
        note: pooled(group) + &likelier(group) + &determined(group.get(..1).unwrap_or_default()),
        ..Table::of(
            judged,
            [
                Column::text("method", "").of(|(_, r, _)| (&r.method).into()),
                Column::text("fits", "").of(|(fits, ..)| (*fits).into()),
                Column::number("χ²/dof", "", "", 4)
                    .of(|(.., fit)| fit.map(|f| f.chi2_per_dof).into()),
                Column::number("dof", "", "", 5).of(|(.., fit)| fit.map(|f| f.dof).into()),
                Column::number("P", "", "", 2).of(|(.., fit)| fit.map(|f| f.p).into()),
            ],
        )
    }
}

/// That standard errors were pooled, where they were.
fn pooled(group: &[&RecoveredObject]) -> String {
    let replicates = group.iter().find_map(|r| r.fit.as_ref()?.pooled);
    replicates.map_or(String::new(), |n| {
        format!(
            "Standard errors were pooled over pixels and spots, so that chance does not weigh one \
             entry more than others: they are known as from {n} replicates. "
        )
    })
}

/// Under which assumption the photographs are likelier, where two were tried; that none was, where
/// errors rest on one.
fn likelier(group: &[&RecoveredObject]) -> String {
    let words = group.iter().find_map(|r| r.likelier.as_ref());
    if let Some(words) = words {
        return format!("{words} ");
    }
    let rests =
        |r: &&RecoveredObject| r.method == Method::JointGp.name() && r.standard_error.is_some();
    if !group.iter().any(rests) {
        return String::new();
    }
    "Errors and bands of joint-gp hold on average over pictures that vary as photographs do (two of three by ± 0.04 \
     to 0.3) and whose neighbours resemble one another; whether another assumption (joint-two-valued) makes the \
     photographs likelier was not compared. "
        .to_owned()
}

/// How much of some surfaces, each recovered by the same method, the photographs determine, in
/// words.
pub fn determined(surfaces: &[&RecoveredObject]) -> String {
    let Some(first) = surfaces.first() else {
        return String::new();
    };
    let all = first.unknowns;
    let shares = surfaces.iter().map(|r| r.determined_share.as_deref());
    match (first.determined, shares.collect::<Option<Vec<_>>>()) {
        (Some(rank), Some(shares)) => {
            let shares = shares.concat();
            let mut errors: Vec<f64> = shares.iter().map(|s| 0.5 * (1.0 - s).sqrt()).collect();
            errors.sort_by(f64::total_cmp);
            let error = |k: usize| errors.get(k).map_or(String::new(), |e| figure(*e, 2));
            let last = errors.len().saturating_sub(1);
            format!(
                "At their noise the photographs determine {} of {all} directions of the picture, by any \
                 method: an element of which 0.5 ± 0.5 is known beforehand is known to ± {} afterwards \
                 (median; {} to {}). The rest of a picture is what its method assumes.",
                significant(rank, 3),
                error(last / 2),
                error(0),
                error(last),
            )
        }
        _ => format!("It is not known how many of {all} elements the photographs determine."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::finding::Describe;
    use crate::lab::sample::run;

    /// A warning is told once, after all methods that it concerns, and the table beside it says how
    /// much of the pictures the photographs determine.
    #[test]
    fn doubts_are_told_once_and_for_all_their_methods() {
        let mut results = run("bench");
        let found = results.describe();
        let all = "pinv, tsvd, tikhonov, joint, joint-bounded: DOES NOT FIT";
        assert!(
            found.notes.len() == 1 && found.notes[0].starts_with(all),
            "{:?}",
            found.notes
        );
        results.recovered[1].warnings.push("another".to_owned());
        let told = warnings(&results.recovered);
        assert_eq!(told[1], "tsvd: another.");
        let table = &results.describe().tables[1];
        assert_eq!(table.rows[0][1], "yes".into());
        let words = "determine 4.50 of 64 directions of the picture, by any method";
        assert!(table.note.contains(words), "{}", table.note);
        let judged = results.recovered[0].fit.as_mut().unwrap();
        judged.fits = false;
        results.recovered[1].fit = None;
        results.recovered[0].determined = None;
        let group: Vec<&RecoveredObject> = results.recovered.iter().collect();
        let table = fits(&group);
        assert_eq!(table.rows[0][1], "NO".into());
        assert_eq!(table.rows[1][1], "not known".into());
        assert!(
            table.note.contains("not known how many of 64"),
            "{}",
            table.note
        );
    }
}
