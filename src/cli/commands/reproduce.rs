//! `phicam reproduce`: the published tables and figures, computed again; finished items are not
//! repeated.

use std::ops::Range;
use std::path::Path;

use super::tasks::Tasks;
use crate::cli::args::ReproduceArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::interrupt::control;
use crate::cli::output;
use crate::cli::process::{pool, version};
use crate::cli::run_folder::RunFolder;
use crate::cli::{Outcome, progress};
use crate::folder::ItemRecord;
use crate::lab::finding::Finding;
use crate::lab::published::{
    Item, ItemSummary, ReproducePlan, ReproduceTasks, overview, reproduce,
};
use crate::lab::{Study, Work, decode, encoded};
use crate::report::{self, ReproductionSettings};
use crate::store::{self, ensure_writable, write_whole};
use crate::transport::Control;

pub(in crate::cli) fn execute(args: &ReproduceArgs, console: Console) -> Result<Outcome, Failure> {
    let (items, plan) = asked(args)?;
    let pool = pool(args.threads)?;
    let _lock = RunFolder::lock(&args.output, "phicam reproduce")?;
    if !args.replace {
        items
            .iter()
            .try_for_each(|item| refuse_other(&args.output, *item, &plan))?;
    }
    let bar = progress::start(console, "published items", Work::Tasks(items.len() as u64));
    let mut kept = 0;
    for &item in &items {
        bar.set_message(item.name());
        let wanted = plan.settings(item);
        match ItemRecord::whole(&args.output, item) {
            Some(Ok(there)) if is_of(&there, item, &wanted) => {
                kept += 1;
                bar.inc(1);
                continue;
            }
            Some(Err(name)) => {
                let path = args.output.join(name);
                console.say(format!(
                    "warning: {} is not what was written; {item} is computed again",
                    path.display()
                ));
            }
            _ => {}
        }
        match pool.install(|| reproduce(item, &plan, control())) {
            Ok(found) => leave(&args.output, item, &found, &plan)?,
            Err(e) => {
                return Err(Failure::from(e).if_stopped(format!(
                    "finished items are kept in {}; go on with the same command",
                    args.output.display()
                )));
            }
        }
        pages(&args.output, &plan)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    if kept > 0 {
        console.say(format!(
            "{kept} of {} items were finished already in {}",
            items.len(),
            args.output.display()
        ));
    }
    print(&args.output, &items, &plan, args.json)?;
    Ok(Outcome::Done)
}

/// The items asked for, in the order in which they are computed, and what is free in them.
fn asked(args: &ReproduceArgs) -> Result<(Vec<Item>, ReproducePlan), Failure> {
    let asked: Vec<Item> = args
        .items
        .iter()
        .map(|n| n.parse())
        .collect::<Result<_, _>>()?;
    let asked = |item: &Item| asked.is_empty() || asked.contains(item);
    let plan = ReproducePlan {
        most_elements: args.most_elements as usize,
        seeds: args.seeds,
        first_seed: args.seed,
    };
    Ok((Item::ALL.into_iter().filter(asked).collect(), plan))
}

/// Leaves the files of a computed item.
fn leave(folder: &Path, item: Item, found: &Finding, plan: &ReproducePlan) -> Result<(), Failure> {
    write(folder, &report::reproduction_files(item, found)?, |files| {
        ItemSummary::new(item, found, plan.settings(item), files)
    })
}

/// Writes the pages and prints the table of the items asked for, or their JSON.
fn print(folder: &Path, items: &[Item], plan: &ReproducePlan, json: bool) -> Result<(), Failure> {
    let of = |i: &Item| finished(folder, *i, &plan.settings(*i));
    let found: Vec<ItemSummary> = items.iter().filter_map(of).collect();
    pages(folder, plan)?;
    output::print(&if json {
        output::json(&found)?
    } else {
        report::finding_text(&overview(&found))
    })
}

/// Writes the files of an item, last of all the summary that says that they are complete.
fn write(
    folder: &Path,
    files: &[(String, Vec<u8>)],
    summary: impl FnOnce(Vec<String>) -> ItemSummary,
) -> Result<(), Failure> {
    for (name, bytes) in files {
        write_whole(&folder.join(name), |w| w.write_all(bytes))?;
    }
    let summary = summary(files.iter().map(|f| f.0.clone()).collect());
    Ok(ItemRecord::write(folder, summary)?)
}

/// Refuses to replace an item that was computed with other settings.
fn refuse_other(folder: &Path, item: Item, plan: &ReproducePlan) -> Result<(), Failure> {
    let wanted = plan.settings(item);
    let there = ItemRecord::read(folder, item).filter(|there| !there.is_damaged());
    let there = there.map(|there| there.summary);
    let Some(there) = there.filter(|there| there.settings != wanted) else {
        return Ok(());
    };
    let cause = format!(
        "{} holds {item} with other settings ({}; now asked for: {wanted})",
        folder.display(),
        there.settings
    );
    let cure = "give the same settings, choose another folder (-o), or replace it (--replace)";
    Err(Failure::new(cause, cure))
}

/// Whether `summary` is of `item`, computed with these settings.
fn is_of(summary: &ItemSummary, item: Item, settings: &str) -> bool {
    summary.settings == settings && summary.item == item.name()
}

/// The whole item of `folder`, if it was computed with these settings.
fn finished(folder: &Path, item: Item, settings: &str) -> Option<ItemSummary> {
    let there = ItemRecord::whole(folder, item)?.ok()?;
    is_of(&there, item, settings).then_some(there)
}

/// The pages of every item that is finished, asked for or not.
fn pages(folder: &Path, plan: &ReproducePlan) -> Result<(), Failure> {
    let of = |i: &Item| finished(folder, *i, &plan.settings(*i));
    let found: Vec<ItemSummary> = Item::ALL.iter().filter_map(of).collect();
    let settings = ReproductionSettings {
        plan,
        version: version(),
    };
    let read = |file: &str| store::read(&folder.join(file), ItemRecord::LARGEST).ok();
    let html = report::reproduction_html(&found, settings, read);
    for (name, text) in [
        ("reproduction.md", report::reproduction_markdown(&found)),
        ("reproduction.html", html),
    ] {
        output::write(&folder.join(name), text)?;
    }
    Ok(())
}

/// The published items as tasks.
struct Published {
    study: ReproduceTasks,
    plan: ReproducePlan,
    items: Vec<Item>,
    json: bool,
}

/// The tasks of the items asked for.
pub(super) fn tasks(args: &ReproduceArgs) -> Result<Box<dyn Tasks>, Failure> {
    let (items, plan) = asked(args)?;
    Ok(Box::new(Published {
        study: ReproduceTasks::new(plan, items.clone()),
        plan,
        items,
        json: args.json,
    }))
}

impl Tasks for Published {
    fn count(&self) -> usize {
        self.study.tasks()
    }

    fn run(&self, tasks: Range<usize>, control: Control<'_>) -> Result<Vec<Vec<u8>>, Failure> {
        encoded(&self.study, &(), tasks, control).map_err(Failure::of)
    }

    fn deliver(&self, outputs: &[Vec<u8>], output: &Path) -> Result<Outcome, Failure> {
        let outputs = decode(&self.study, &(), outputs)?;
        ensure_writable(output)?;
        for (item, found) in self.study.finish(&(), outputs)? {
            leave(output, item, &found, &self.plan)?;
        }
        print(output, &self.items, &self.plan, self.json)?;
        Ok(Outcome::Done)
    }
}
