//! The error budget in a sentence and tables.

use super::super::page::Tone;
use super::account::{Account, Table, figure};
use crate::study::{ErrorBudget, Estimate};

/// Whether the parts add up, and every part.
pub fn budget_account(budget: &ErrorBudget) -> Account {
    let c = &budget.closure;
    let both = |e: Estimate| format!("{} ± {}", figure(e.value, 3), figure(e.stderr, 2));
    let in_sum = budget.terms.iter().filter(|t| t.in_sum);
    let largest = in_sum.max_by(|a, b| a.size.value.total_cmp(&b.size.value));
    let largest = largest.map_or(String::new(), |t| {
        format!(
            "; the largest of them is {}, {}",
            t.name,
            figure(t.size.value, 2)
        )
    });
    let sentence = format!(
        "Relative to the flux, frames and matrix model of {} differ by {}, and the parts {} to {}{largest}. What is left, {}, is to be compared with {} expected from noise (z = {}, within ±3 if \
         the budget closes).",
        budget.scene,
        both(c.total),
        if c.closes {
            "add up"
        } else {
            "DO NOT ADD UP: they come"
        },
        both(c.sum),
        figure(c.rest, 2),
        figure(c.expected, 2),
        figure(c.z, 2)
    );
    let mut table = Table::new(
        "What the matrix model leaves out, relative to the flux (norm over all entries of Φcam)",
        1,
        &[
            "cause",
            "size",
            "± standard error",
            "after the best single scale",
            "of the object's signal",
        ],
    );
    table.rows = budget
        .terms
        .iter()
        .map(|t| {
            let aside = if t.in_sum { "" } else { " *" };
            vec![
                format!("{}{aside}", t.name),
                figure(t.size.value, 3),
                figure(t.size.stderr, 2),
                figure(t.after_scale.value, 3),
                figure(t.of_signal, 3),
            ]
        })
        .collect();
    table.note = format!(
        "* not in the sum: a model without étendue per pixel would add it. The object's signal, the part of Φcam that its pattern causes, is {} of the flux.",
        figure(budget.signal, 3)
    );
    Account {
        title: format!("Error budget: {}", budget.scene),
        tone: if c.closes { Tone::Good } else { Tone::Bad },
        sentence,
        words: String::new(),
        tables: vec![table],
    }
}
