//! The items in tasks: those that take seconds as a whole, the others cut where their time goes.

use serde::{Deserialize, Serialize};

use super::distance::{self, At};
use super::precision::{self, Line};
use super::spots::{self, Modulations};
use super::substitution::{self, Case, Trial};
use super::table1::{self, Lights, Made};
use super::{Item, ReproduceError, ReproducePlan, Reproduction, Watch, moving_view, whole_item};
use crate::num::linalg::Tolerance;
use crate::study::task::Division;
use crate::transport::Control;

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
    Whole(Box<Reproduction>),
    /// Light that was traced in place of modelled light.
    Trial(Trial),
    /// A number of spots.
    Modulations(Modulations),
    /// A curve over the distance of the spots.
    Curve(Vec<At>),
    /// What the methods make of modelled Φ.
    Made(Vec<Made>),
    /// What they make of the traced lights.
    Lights(Lights),
    /// A case of many digits.
    Lines(Vec<Line>),
    /// A configuration of the moving view.
    Modelled(moving_view::Modelled),
    /// Photographs of the moving view.
    Seen(moving_view::Seen),
}

/// Pieces of an item by their kind.
#[derive(Default)]
struct Sorted {
    whole: Option<Reproduction>,
    trials: Vec<Trial>,
    modulations: Vec<Modulations>,
    curves: Vec<Vec<At>>,
    made: Vec<Vec<Made>>,
    lights: Vec<Lights>,
    lines: Vec<Vec<Line>>,
    modelled: Vec<moving_view::Modelled>,
    seen: Vec<moving_view::Seen>,
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

    /// How many pieces an item has.
    fn pieces(&self, item: Item) -> usize {
        self.modelled(item)
            + match item {
                Item::Table1 => table1::TRACED.len(),
                Item::MovingView => moving_view::TRACED_CASES,
                _ => self.traced(item).len(),
            }
    }

    /// How many of them are not traced; they are the first.
    fn modelled(&self, item: Item) -> usize {
        match item {
            Item::Table1 => table1::modelled().len(),
            Item::Fig12 | Item::Fig13 | Item::Fig14 => spots::cases(item, &self.plan).len(),
            Item::Fig17 | Item::Fig20 => distance::curves(item).len(),
            Item::Precision => precision::cases(&self.plan).len(),
            Item::MovingView => moving_view::modelled_cases(),
            _ => 1,
        }
    }

    /// Cases that are traced in place of modelled.
    fn traced(&self, item: Item) -> Vec<Case> {
        match item {
            Item::Fig17 | Item::Fig20 => distance::cases(item),
            Item::Fig12 => spots::traced_cases(item, &self.plan),
            _ => Vec::new(),
        }
    }

    fn piece(&self, item: Item, k: usize, watch: Watch<'_>) -> Result<Piece, ReproduceError> {
        watch.go_on()?;
        let plan = &self.plan;
        let traced = k.checked_sub(self.modelled(item));
        Ok(match (item, traced) {
            (Item::Table1, None) => Piece::Made(table1::model(table1::modelled()[k], watch)?),
            (Item::Table1, Some(k)) => Piece::Lights(table1::trace(table1::TRACED[k], watch)?),
            (Item::Fig12 | Item::Fig13 | Item::Fig14, None) => {
                Piece::Modulations(spots::one(item, &spots::cases(item, plan)[k])?)
            }
            (Item::Fig17 | Item::Fig20, None) => {
                let (kernel, stagger) = distance::curves(item)[k];
                let rule = Tolerance::Spacing;
                Piece::Curve(distance::curve(kernel, stagger, rule, watch)?)
            }
            (Item::Precision, None) => {
                Piece::Lines(precision::one(&precision::cases(plan)[k], watch)?)
            }
            (Item::MovingView, None) => {
                Piece::Modelled(moving_view::Modelled::compute(k, plan, watch)?)
            }
            (Item::MovingView, Some(k)) => Piece::Seen(moving_view::Seen::compute(k, plan, watch)?),
            (_, Some(k)) => Piece::Trial(substitution::trial(&self.traced(item)[k], watch)?),
            (_, None) => Piece::Whole(Box::new(whole_item(item, plan, watch)?)),
        })
    }

    fn figure(&self, item: Item, found: Sorted) -> Result<Reproduction, ReproduceError> {
        let plan = &self.plan;
        let traced = self.traced(item).into_iter().zip(found.trials);
        let traced: Vec<(Case, Trial)> = traced.collect();
        Ok(match item {
            Item::Table1 => table1::table(&found.made, &found.lights),
            Item::Fig12 | Item::Fig13 | Item::Fig14 => {
                spots::modulation(item, plan, found.modulations, &traced)
            }
            Item::Fig17 | Item::Fig20 => distance::figure(item, found.curves, &traced),
            Item::Precision => precision::figure(plan, found.lines),
            Item::MovingView => moving_view::figure(plan, found.modelled, found.seen),
            _ => found.whole.ok_or(ReproduceError::Stopped)?,
        })
    }
}

impl Sorted {
    fn take(&mut self, piece: Piece) {
        match piece {
            Piece::Whole(found) => self.whole = Some(*found),
            Piece::Trial(found) => self.trials.push(found),
            Piece::Modulations(found) => self.modulations.push(found),
            Piece::Curve(found) => self.curves.push(found),
            Piece::Made(found) => self.made.push(found),
            Piece::Lights(found) => self.lights.push(found),
            Piece::Lines(found) => self.lines.push(found),
            Piece::Modelled(found) => self.modelled.push(found),
            Piece::Seen(found) => self.seen.push(found),
        }
    }
}

impl Division for ReproduceTasks {
    type Ground = ();
    type Part = Piece;
    type Finding = Vec<Reproduction>;
    type Error = ReproduceError;

    fn tasks(&self) -> usize {
        self.tasks.len()
    }

    fn ground(&self, _: Control<'_>) -> Result<Option<()>, ReproduceError> {
        Ok(Some(()))
    }

    fn task(
        &self,
        (): &(),
        index: usize,
        control: Control<'_>,
    ) -> Result<Option<Piece>, ReproduceError> {
        let (item, k) = self.tasks[index];
        match self.piece(item, k, Watch::new(control.stop)) {
            Err(ReproduceError::Stopped) => Ok(None),
            found => found.map(Some),
        }
    }

    fn fits(&self, (): &(), index: usize, piece: &Piece) -> bool {
        let (item, k) = self.tasks[index];
        let traced = k.checked_sub(self.modelled(item));
        match (item, traced, piece) {
            (Item::Table1, None, Piece::Made(made)) => table1::fits(made),
            (Item::Table1, Some(_), Piece::Lights(lights)) => lights.fits(),
            (Item::Fig12 | Item::Fig13 | Item::Fig14, None, Piece::Modulations(found)) => {
                spots::fits(item, &spots::cases(item, &self.plan)[k], found)
            }
            (Item::Fig17 | Item::Fig20, None, Piece::Curve(curve)) => distance::fits(curve),
            (Item::Precision, None, Piece::Lines(lines)) => {
                precision::fits(&precision::cases(&self.plan)[k], lines)
            }
            (Item::MovingView, None, Piece::Modelled(found)) => found.fits(),
            (Item::MovingView, Some(_), Piece::Seen(found)) => found.fits(),
            (Item::Fig12 | Item::Fig17 | Item::Fig20, Some(k), Piece::Trial(trial)) => {
                trial.fits(&self.traced(item)[k])
            }
            (_, None, Piece::Whole(found)) => {
                let cut = self.pieces(item) > 1;
                let rows = |r: &Vec<_>| r.len() == found.columns.len();
                !cut && found.item == item && found.rows.iter().all(rows) && found.pictured()
            }
            _ => false,
        }
    }

    fn finish(&self, (): &(), parts: Vec<Piece>) -> Result<Vec<Reproduction>, ReproduceError> {
        let mut parts = parts.into_iter();
        let item = |item: &Item| {
            let mut sorted = Sorted::default();
            for piece in parts.by_ref().take(self.pieces(*item)) {
                sorted.take(piece);
            }
            self.figure(*item, sorted)
        };
        self.items.iter().map(item).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::task::tests::{divides, unstopped};

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

    /// Of every item that is cut the first and the last piece, in the place of the other and of a whole item.
    #[test]
    fn pieces_are_of_their_item() {
        let plan = ReproducePlan {
            most_elements: 8,
            seeds: 2,
            first_seed: 1,
        };
        let tasks = ReproduceTasks::new(plan, vec![Item::Table2, Item::Fig12, Item::Fig17]);
        let at = |item: Item, k: usize| tasks.tasks.iter().position(|t| *t == (item, k)).unwrap();
        let last = |item: Item| tasks.pieces(item) - 1;
        let piece = |index| unstopped(|c| tasks.task(&(), index, c)).unwrap().unwrap();
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
