//! `phicam reproduce`: the published tables and figures, computed again; finished items are not repeated.

use std::fs;
use std::ops::Range;
use std::path::Path;

use super::args::ReproduceArgs;
use super::failure::Failure;
use super::interrupt::stop_flag;
use super::output::{self, Talk};
use super::record::version;
use super::tasks::{Cut, encoded};
use super::{Outcome, progress, settings};
use crate::report::{self, ItemSummary, ReproductionSettings};
use crate::store::{ensure_writable, write_whole};
use crate::study::reproduce::{
    Item, ReproduceError, ReproducePlan, ReproduceTasks, Reproduction, reproduce,
};
use crate::study::{Division, decode};
use crate::transport::Control;

pub(super) fn execute(args: &ReproduceArgs, talk: Talk) -> Result<Outcome, Failure> {
    let (items, plan) = asked(args)?;
    let pool = settings::pool(args.threads)?;
    ensure_writable(&args.output)?;
    let bar = progress::steps(talk, "published items");
    bar.set_length(items.len() as u64);
    let mut kept = 0;
    for &item in &items {
        bar.set_message(item.name());
        let wanted = plan.settings(item);
        if finished(&args.output, item, &wanted).is_some() {
            kept += 1;
        } else {
            match pool.install(|| reproduce(item, &plan, stop_flag())) {
                Ok(found) => leave(&args.output, &found, &plan)?,
                Err(ReproduceError::Stopped) => {
                    return Err(Failure::Stopped(format!(
                        "finished items are kept in {}; go on with the same command",
                        args.output.display()
                    )));
                }
                Err(e) => return Err(e.into()),
            }
            pages(&args.output, &plan)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if kept > 0 {
        talk.say(format!(
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
fn leave(folder: &Path, found: &Reproduction, plan: &ReproducePlan) -> Result<(), Failure> {
    write(folder, &report::reproduction_files(found)?, |files| {
        ItemSummary::new(found, plan.settings(found.item), files)
    })
}

/// Writes the pages and prints the table of the items asked for, or their JSON.
fn print(folder: &Path, items: &[Item], plan: &ReproducePlan, json: bool) -> Result<(), Failure> {
    let of = |i: &Item| finished(folder, *i, &plan.settings(*i));
    let found: Vec<ItemSummary> = items.iter().filter_map(of).collect();
    pages(folder, plan)?;
    output::print(&match json {
        true => output::json(&found)?,
        false => report::reproduction_table(&found),
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
    let path = folder.join(format!("{}.json", summary.item));
    output::deliver(&output::json(&summary)?, Some(&path))
}

/// The summary of an item that was computed with the same settings and whose files are all there.
fn finished(folder: &Path, item: Item, settings: &str) -> Option<ItemSummary> {
    let text = fs::read_to_string(folder.join(format!("{item}.json"))).ok()?;
    let found: ItemSummary = serde_json::from_str(&text).ok()?;
    let whole = found.files.iter().all(|f| folder.join(f).is_file());
    (whole && found.settings == settings && found.item == item.name()).then_some(found)
}

/// The pages of every item that is finished, asked for or not.
fn pages(folder: &Path, plan: &ReproducePlan) -> Result<(), Failure> {
    let of = |i: &Item| finished(folder, *i, &plan.settings(*i));
    let found: Vec<ItemSummary> = Item::ALL.iter().filter_map(of).collect();
    let settings = ReproductionSettings {
        plan,
        version: version(),
    };
    let read = |file: &str| fs::read(folder.join(file)).ok();
    let html = report::reproduction_html(&found, settings, read);
    for (name, text) in [
        ("reproduction.md", report::reproduction_markdown(&found)),
        ("reproduction.html", html),
    ] {
        output::deliver(&text, Some(&folder.join(name)))?;
    }
    Ok(())
}

/// The published items as tasks.
struct Published {
    division: ReproduceTasks,
    plan: ReproducePlan,
    items: Vec<Item>,
    json: bool,
}

/// The tasks of the items asked for.
pub(in crate::cli) fn cut(args: &ReproduceArgs) -> Result<Box<dyn Cut>, Failure> {
    let (items, plan) = asked(args)?;
    Ok(Box::new(Published {
        division: ReproduceTasks::new(plan, items.clone()),
        plan,
        items,
        json: args.json,
    }))
}

impl Cut for Published {
    fn tasks(&self) -> usize {
        self.division.tasks()
    }

    fn run(
        &self,
        tasks: Range<usize>,
        control: Control<'_>,
    ) -> Result<Option<Vec<Vec<u8>>>, Failure> {
        encoded(&self.division, &(), tasks, control)
    }

    fn deliver(
        &self,
        parts: &[Vec<u8>],
        _: Control<'_>,
        output: &Path,
    ) -> Result<Option<Outcome>, Failure> {
        let parts = decode(&self.division, &(), parts)?;
        ensure_writable(output)?;
        for found in self.division.finish(&(), parts)? {
            leave(output, &found, &self.plan)?;
        }
        print(output, &self.items, &self.plan, self.json)?;
        Ok(Some(Outcome::Done))
    }
}
