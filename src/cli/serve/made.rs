//! The page of a run that has no report.

use std::path::PathBuf;

use hyper::StatusCode;
use hyper::body::Bytes;

use super::answer::Refusal;
use super::folder::Served;
use super::run;
use super::tiles::MODELLED;
use crate::cli::run_folder::SCENE;
use crate::folder::Record;
use crate::report::served_html;
use crate::scene::Scene;

/// A page, and what it was made of: the scene is known by its hash, which is in the record.
#[derive(Debug)]
struct Made {
    record: Vec<u8>,
    model: bool,
    page: Bytes,
}

/// The page that was made last, for as long as the folder has the run that it shows.
#[derive(Debug)]
pub(super) struct Kept {
    /// Folders that scenes may read besides their own.
    also_read: Vec<PathBuf>,
    made: Option<Made>,
}

impl Kept {
    /// No page yet.
    pub(super) fn new(also_read: &[PathBuf]) -> Self {
        Self {
            also_read: also_read.to_vec(),
            made: None,
        }
    }

    /// The page of what lies in the folder now: the one that is kept, or a new one. `None` without
    /// a run or its scene.
    ///
    /// # Errors
    /// 500 for a record or a scene that is damaged, or for a scene that is not that of the record;
    /// `why` is told the details. The next call tries again.
    pub(super) fn page(
        &mut self,
        folder: &Served,
        why: impl FnOnce(&str),
    ) -> Result<Option<Bytes>, Refusal> {
        let record = match run::bytes(folder) {
            Ok(record) if folder.has(SCENE) => record,
            Err(refusal) if refusal.status != StatusCode::NOT_FOUND => return Err(refusal),
            _ => return Ok(None),
        };
        let model = folder.has(MODELLED);
        match &self.made {
            Some(made) if made.record == record && made.model == model => {
                return Ok(Some(made.page.clone()));
            }
            _ => self.made = None,
        }
        let run = run::parsed(&record)?;
        let name = Record::FILE;
        let scene = Scene::load_with(
            &folder.path().join(SCENE).to_string_lossy(),
            &self.also_read,
        )
        .map_err(|e| {
            why(&e.to_string());
            Refusal::broken(format!("{SCENE} cannot be read, or is none; render again"))
        })?;
        if scene.hash != run.scene_hash {
            let words =
                format!("{SCENE} is not the scene of {name}: render again into another folder");
            return Err(Refusal::broken(words));
        }
        let plan = run.origin.plan().ok_or_else(|| {
            let words = "the photographs in this folder were imported: there is no report of them";
            Refusal::broken(words.to_owned())
        })?;
        let page = Bytes::from(served_html(&scene, plan, model));
        self.made = Some(Made {
            record,
            model,
            page: page.clone(),
        });
        Ok(Some(page))
    }
}
