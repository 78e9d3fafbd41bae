//! Does the fixed view lose anything, and does the moving one?

use super::super::Check;
use super::layout::View;
use super::modelled::Configuration;
use super::traced::{Photographs, SIGNIFICANCE};
use super::{BOARDS, HALF_WIDTHS, KEPT, is_physical};

/// Noises nearer to each other than by this factor are one: the mean of few draws tells no more.
const SAME: f64 = 1.5;

pub(super) fn checks(modelled: &[Configuration], traced: &[Photographs]) -> Vec<Check> {
    let agreeing: [usize; 2] =
        std::array::from_fn(|i| traced.iter().map(|t| t.agreeing[i]).sum::<usize>());
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
fn loses(name: &str, modelled: &[Configuration], less: fn(f64, f64) -> bool) -> Check {
    let (mut cases, mut lost, mut worst) = (0, 0, 1.0f64);
    for (_, half_width) in HALF_WIDTHS {
        let own = || {
            let own = move |c: &&Configuration| is_physical(c) && c.half_width == half_width;
            modelled.iter().filter(own)
        };
        let fixed = own().find(|c| c.view == View::Fixed);
        for moving in own().filter(|c| c.view.moves()) {
            for k in 0..BOARDS.len() {
                let borne = |c: &Configuration| c.courses[k].borne().unwrap_or(0.0);
                let pair = [fixed.map_or(0.0, borne), borne(moving)];
                cases += 1;
                if less(pair[0], pair[1]) {
                    lost += 1;
                    worst = worst.max((pair[0] / pair[1]).max(pair[1] / pair[0]));
                }
            }
        }
    }
    let computed = match lost {
        0 => format!("bears less noise in none of {cases} cases"),
        _ => {
            format!("bears less noise in {lost} of {cases} cases, by up to a factor of {worst:.1}")
        }
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
fn same_order(modelled: &[Configuration], traced: &[Photographs]) -> Check {
    let condition = |view: View| {
        let own = |c: &&Configuration| {
            is_physical(c) && c.half_width == HALF_WIDTHS[0].1 && c.view == view
        };
        modelled.iter().find(own).map(Configuration::condition)
    };
    let (mut words, mut same) = (Vec::new(), true);
    for checks in BOARDS {
        let of = |fixed: bool| {
            let own = |t: &&Photographs| t.checks == checks && (t.view == View::Fixed) == fixed;
            traced.iter().find(own)
        };
        let (Some(fixed), Some(moving)) = (of(true), of(false)) else {
            same = false;
            continue;
        };
        words.push(format!(
            "{checks} × {checks} board: fixed {}, moving {}",
            fixed.effective_rank, moving.effective_rank
        ));
        let better = condition(moving.view) < condition(View::Fixed);
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
