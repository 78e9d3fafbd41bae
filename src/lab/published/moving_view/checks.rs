//! Does the fixed view lose anything, and does the moving one?

use super::layout::{BOARDS, HALF_WIDTHS, KEPT, View};
use super::modelled::{Configuration, Modelled, Models};
use super::traced::{SIGNIFICANCE, Traces};
use crate::lab::check::Check;

/// Noises nearer to each other than by this factor are one: the mean of few draws tells no more.
const SAME: f64 = 1.5;

pub(super) fn checks(modelled: &Models, traced: &Traces) -> Vec<Check> {
    let agreeing: [usize; 2] =
        std::array::from_fn(|i| traced.iter().map(|(_, t)| t.agreeing[i]).sum::<usize>());
    vec![
        Check::trend(
            "layout of the moving view",
            "none given",
            "a view of the fixed one's size, its centre 2 in. left of, above or below the spot, or on it",
            "holds where the published text states the layout that is computed",
            false,
        ),
        Check::trend(
            "traced photographs against the converged integral of their own view, every tenth",
            "–",
            format!("{} of {} agree", agreeing[0], agreeing[1]),
            format!("all agree at a significance of {SIGNIFICANCE} for each view and board"),
            agreeing[0] == agreeing[1],
        ),
        loses("fixed", modelled, |fixed, moving| fixed * SAME < moving),
        loses("moving", modelled, |fixed, moving| moving * SAME < fixed),
        same_order(modelled, traced),
    ]
}

/// Whether a view bears less noise than the other anywhere.
fn loses(name: &str, modelled: &Models, less: fn(f64, f64) -> bool) -> Check {
    let (mut cases, mut lost, mut worst) = (0, 0, 1.0f64);
    for (_, half_width) in HALF_WIDTHS {
        let own = || {
            modelled
                .iter()
                .filter(move |(c, _)| c.is_physical(half_width))
        };
        let fixed = own().find(|(c, _)| c.view == View::Fixed);
        for (_, moving) in own().filter(|(c, _)| c.view.moves()) {
            for k in 0..BOARDS.len() {
                let borne = |m: &Modelled| m.courses[k].borne().unwrap_or(0.0);
                let pair = [fixed.map_or(0.0, |(_, m)| borne(m)), borne(moving)];
                cases += 1;
                if less(pair[0], pair[1]) {
                    lost += 1;
                    worst = worst.max((pair[0] / pair[1]).max(pair[1] / pair[0]));
                }
            }
        }
    }
    let computed = if lost == 0 {
        format!("bears less noise in none of {cases} cases")
    } else {
        format!("bears less noise in {lost} of {cases} cases, by up to a factor of {worst:.1}")
    };
    Check::trend(
        format!("the {name} view loses nothing against the other, modelled"),
        "–",
        computed,
        format!(
            "the noise at which the raw MTF falls below {KEPT} is nowhere less than the other's by more than a factor of {SAME}: both half-widths, both boards, every offset"
        ),
        lost == 0,
    )
}

/// Whether trace and model put the two views into the same order.
fn same_order(modelled: &Models, traced: &Traces) -> Check {
    let condition = |view: View| {
        let own = |c: &Configuration| c.is_physical(HALF_WIDTHS[0].1) && c.view == view;
        let found = modelled.iter().find(|(c, _)| own(c));
        found.map(|(_, m)| m.condition())
    };
    let (mut words, mut same) = (Vec::new(), true);
    for checks in BOARDS {
        let of = |fixed: bool| {
            let own =
                |(board, view): (usize, View)| board == checks && (view == View::Fixed) == fixed;
            traced.iter().find(|(case, _)| own(*case))
        };
        let (Some((_, fixed)), Some(((_, view), moving))) = (of(true), of(false)) else {
            same = false;
            continue;
        };
        words.push(format!(
            "{checks} × {checks} board: fixed {}, moving {}",
            fixed.effective_rank, moving.effective_rank
        ));
        let better = condition(*view) < condition(View::Fixed);
        same &= (moving.effective_rank > fixed.effective_rank) == better;
    }
    Check::trend(
        "effective rank of traced photographs under the noise of their own render, half-width 3 in.",
        "–",
        words.join("; "),
        "on both boards it is larger for the view with the smaller condition number, at equal paths",
        same,
    )
}
