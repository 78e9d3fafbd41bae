//! `phicam reproduce`: the published tables and figures, computed again; finished items are not repeated.

use std::fs;
use std::path::Path;

use super::args::ReproduceArgs;
use super::failure::Failure;
use super::interrupt::stop_flag;
use super::output::{self, Talk};
use super::{Outcome, progress, settings};
use crate::report::{self, ItemSummary};
use crate::store::{ensure_writable, write_whole};
use crate::study::reproduce::{Item, ReproduceError, ReproducePlan, reproduce};

pub(super) fn execute(args: &ReproduceArgs, talk: Talk) -> Result<Outcome, Failure> {
    let asked: Vec<Item> = args
        .items
        .iter()
        .map(|n| n.parse())
        .collect::<Result<_, _>>()?;
    let asked = |item: &Item| asked.is_empty() || asked.contains(item);
    let items: Vec<Item> = Item::ALL.into_iter().filter(asked).collect();
    let plan = ReproducePlan {
        most_elements: args.most_elements as usize,
        seeds: args.seeds,
        first_seed: args.seed,
    };
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
                Ok(found) => write(
                    &args.output,
                    &report::reproduction_files(&found)?,
                    |files| ItemSummary::new(&found, wanted, files),
                )?,
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
    let of = |i: &Item| finished(&args.output, *i, &plan.settings(*i));
    let found: Vec<ItemSummary> = items.iter().filter_map(of).collect();
    pages(&args.output, &plan)?;
    output::print(&match args.json {
        true => output::json(&found)?,
        false => report::reproduction_table(&found),
    })?;
    Ok(Outcome::Done)
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
    for (name, text) in [
        ("reproduction.md", report::reproduction_markdown(&found)),
        ("reproduction.html", report::reproduction_html(&found)),
    ] {
        output::deliver(&text, Some(&folder.join(name)))?;
    }
    Ok(())
}

pub(in crate::cli) fn cut(_: &ReproduceArgs) -> Result<Box<dyn super::tasks::Cut>, Failure> {
    Err(Failure::new("not yet", "wait"))
}
