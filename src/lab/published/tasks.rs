//! The items in tasks: those that take seconds as a whole, the others cut where their time goes.

use serde::{Deserialize, Serialize};

use super::case::Case;
use super::item::Item;
use super::moving_view::{self, Modelled, Seen};
use super::outcome::Trial;
use super::plan::ReproducePlan;
use super::sheet::is_whole;
use super::summary::judged;
use super::{distance, dual, indicators, noise, precision, spots, table1, tables};
use crate::lab::LabError;
use crate::lab::finding::Finding;
use crate::lab::study::{Study, run};
use crate::transport::{Control, Stopped};

/// Computes one item.
///
/// # Errors
/// [`LabError`].
pub fn reproduce(
    item: Item,
    plan: &ReproducePlan,
    control: Control<'_>,
) -> Result<Finding, LabError> {
    let found = run(&ReproduceTasks::new(*plan, vec![item]), control)?;
    let (_, finding) = found.into_iter().next().ok_or(Stopped)?;
    Ok(finding)
}

/// Published items in tasks.
#[derive(Debug)]
pub struct ReproduceTasks {
    plan: ReproducePlan,
    items: Vec<Item>,
    /// The item of each task, and its place among those of the item.
    tasks: Vec<(Item, usize)>,
}

/// What a task gives.
#[derive(Debug, Serialize, Deserialize)]
pub enum Piece {
    /// A whole item.
    Whole(Box<Finding>),
    /// What is recovered in a case.
    Trials(Vec<Trial>),
    /// A configuration of the moving view.
    Modelled(Modelled),
    /// Photographs of the moving view.
    Seen(Seen),
}

impl ReproduceTasks {
    /// These items by this plan.
    pub fn new(plan: ReproducePlan, items: Vec<Item>) -> Self {
        let mut own = Self {
            plan,
            tasks: Vec::new(),
            items,
        };
        for &item in &own.items {
            own.tasks.extend((0..own.pieces(item)).map(|k| (item, k)));
        }
        own
    }

    /// The cases of an item that is cut into such.
    fn cases(&self, item: Item) -> Vec<Case> {
        match item {
            Item::Table1 => table1::cases(),
            Item::Fig12 | Item::Fig13 | Item::Fig14 => spots::cases(item, &self.plan),
            Item::Fig17 | Item::Fig20 => distance::cases(item),
            Item::Precision => precision::cases(&self.plan),
            _ => Vec::new(),
        }
    }

    /// How many pieces an item has.
    fn pieces(&self, item: Item) -> usize {
        match item {
            Item::MovingView => moving_view::pieces().iter().sum(),
            Item::Table2 | Item::Table3 | Item::Table4 | Item::Fig15 | Item::Fig22 | Item::Dual => {
                1
            }
            _ => self.cases(item).len(),
        }
    }

    fn piece(&self, item: Item, k: usize, control: Control<'_>) -> Result<Piece, LabError> {
        let plan = &self.plan;
        let whole = |finding| Ok(Piece::Whole(Box::new(finding)));
        match item {
            Item::Table2 | Item::Table3 | Item::Table4 => whole(tables::figure(item)),
            Item::Fig15 => whole(indicators::figure(control)?),
            Item::Fig22 => whole(noise::figure(plan, control)?),
            Item::Dual => whole(dual::figure(plan, control)?),
            Item::MovingView => match k.checked_sub(moving_view::pieces()[0]) {
                None => Ok(Piece::Modelled(Modelled::compute(k, plan, control)?)),
                Some(k) => Ok(Piece::Seen(Seen::compute(k, plan, control)?)),
            },
            _ => {
                let case = &self.cases(item)[k];
                Ok(Piece::Trials(match item {
                    Item::Table1 => table1::trials(case, control)?,
                    Item::Precision => precision::trials(case, control)?,
                    _ => case.trials(control)?,
                }))
            }
        }
    }

    fn finding(&self, item: Item, pieces: Vec<Piece>) -> Result<Finding, LabError> {
        let (mut trials, mut modelled, mut seen) = (Vec::new(), Vec::new(), Vec::new());
        for piece in pieces {
            match piece {
                Piece::Whole(finding) => return Ok(*finding),
                Piece::Trials(found) => trials.push(found),
                Piece::Modelled(found) => modelled.push(found),
                Piece::Seen(found) => seen.push(found),
            }
        }
        let cases = self.cases(item);
        match item {
            Item::Table1 => Ok(table1::figure(&cases, &trials)),
            Item::Fig12 | Item::Fig13 | Item::Fig14 => Ok(spots::figure(item, &cases, &trials)),
            Item::Fig17 | Item::Fig20 => Ok(distance::figure(item, &cases, &trials)),
            Item::Precision => Ok(precision::figure(&cases, &trials)),
            Item::MovingView => Ok(moving_view::figure(&self.plan, modelled, seen)),
            _ => Err(Stopped.into()),
        }
    }
}

impl Study for ReproduceTasks {
    type Context = ();
    type Output = Piece;
    type Result = Vec<(Item, Finding)>;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.tasks.len()
    }

    fn context(&self, _: Control<'_>) -> Result<(), LabError> {
        Ok(())
    }

    fn task(&self, (): &(), index: usize, control: Control<'_>) -> Result<Piece, LabError> {
        let (item, k) = self.tasks[index];
        self.piece(item, k, control)
    }

    fn fits(&self, (): &(), index: usize, piece: &Piece) -> bool {
        let (item, k) = self.tasks[index];
        let seen = k >= moving_view::pieces()[0];
        match (item, piece) {
            (Item::MovingView, Piece::Modelled(found)) => !seen && found.fits(),
            (Item::MovingView, Piece::Seen(found)) => seen && found.fits(),
            (_, Piece::Trials(found)) => {
                let ways = match item {
                    Item::Table1 => table1::METHODS.len(),
                    Item::Precision => precision::WAYS.len(),
                    _ => 1,
                };
                let cases = self.cases(item);
                cases.get(k).is_some_and(|case| case.fits(found, ways))
            }
            (_, Piece::Whole(found)) => {
                let file = |f: &Option<String>| f.as_deref() == Some(&format!("{item}.csv"));
                let own = |f: &Finding| f.tables.iter().any(|t| file(&t.file));
                self.pieces(item) == 1 && own(found) && is_whole(found)
            }
            _ => false,
        }
    }

    fn finish(&self, (): &(), pieces: Vec<Piece>) -> Result<Self::Result, LabError> {
        let mut pieces = pieces.into_iter();
        let item = |item: &Item| {
            let own = pieces.by_ref().take(self.pieces(*item)).collect();
            Ok((*item, judged(self.finding(*item, own)?)))
        };
        self.items.iter().map(item).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::study::tests::divides;

    /// Whole items and one in pieces.
    #[test]
    fn it_divides() {
        let plan = ReproducePlan {
            most_elements: 8,
            seeds: 2,
            first_seed: 1,
        };
        let items = vec![Item::Table2, Item::Fig13, Item::Fig15];
        let found = divides(&ReproduceTasks::new(plan, items));
        assert_eq!(found.len(), 3);
    }

    /// Of every item that is cut the first and the last piece, in the place of the other and of a
    /// whole item.
    #[test]
    #[ignore = "slow"]
    fn pieces_are_of_their_item() {
        let plan = ReproducePlan {
            most_elements: 8,
            seeds: 2,
            first_seed: 1,
        };
        let tasks = ReproduceTasks::new(plan, vec![Item::Table2, Item::Fig12, Item::Fig17]);
        let at = |item: Item, k: usize| tasks.tasks.iter().position(|t| *t == (item, k)).unwrap();
        let last = |item: Item| tasks.pieces(item) - 1;
        let piece = |index| tasks.task(&(), index, Control::none()).unwrap();
        let kinds = [
            at(Item::Table2, 0),
            at(Item::Fig12, 0),
            at(Item::Fig12, last(Item::Fig12)),
            at(Item::Fig17, 0),
        ];
        let pieces = kinds.map(piece);
        for (index, own) in kinds.into_iter().zip(&pieces) {
            for other in &pieces {
                assert_eq!(tasks.fits(&(), index, other), std::ptr::eq(own, other));
            }
        }
    }
}
