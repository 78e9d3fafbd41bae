//! What the shares of a budget divide, and which results they refuse.

use super::*;
use crate::lab::study::tests::{divides, refuses, small};

#[test]
#[ignore = "slow"]
fn it_divides() {
    for name in ["bench", "corner"] {
        let plan = BudgetPlan {
            seed: 1,
            ensemble_samples: 256,
            run_samples: 32,
        };
        let tasks = BudgetTasks::new(&small(name), plan);
        assert!(divides(&tasks).terms.len() > 8);
    }
}

/// The last tasks are shares of the run, the first an integral.
#[test]
fn results_of_another_kind_are_refused() {
    let plan = BudgetPlan {
        seed: 1,
        ensemble_samples: 64,
        run_samples: 32,
    };
    let tasks = BudgetTasks::new(&small("bench"), plan);
    let integral = tasks.context(Control::none()).unwrap();
    let last = tasks.tasks() - 1;
    for (index, at) in [(0, last), (last, 0)] {
        let output = tasks.task(&integral, at, Control::none()).unwrap();
        refuses(&tasks, index, &output);
    }
}
