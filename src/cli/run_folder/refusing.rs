//! What is not written over.

use std::fs;
use std::path::Path;

use super::RunFolder;
use super::{
    IMPORT, IMPORT_PNG, LEFT_OUT, MODEL, PHI, RECOVERED, REPORT, SCENE, STDERR, SUMMARY, TAILS,
};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::partial::PARTIAL;
use crate::folder::Record;
use crate::scene::{COPIES, Scene};

impl RunFolder {
    /// What stands in the way of a run's files shows before anything is written.
    pub(in crate::cli) fn refuse_obstacles(path: &Path) -> Result<(), Failure> {
        output::refuse_obstacles(path, &OWN_FOLDERS, &OWN_FILES)
    }

    /// Whether the import that `record` describes is in the folder, whole. Another import is
    /// refused unless it is to be replaced; a render is not replaced by photographs.
    pub(in crate::cli) fn holds_import(
        &self,
        record: &Record,
        replace: bool,
    ) -> Result<bool, Failure> {
        let Some(there) = Record::read(&self.path)? else {
            return Ok(false);
        };
        let path = self.path.display();
        if !there.is_imported() {
            let cause = format!("{path} holds a rendered run, which photographs do not replace");
            return Err(Failure::new(cause, "choose another folder (-o)"));
        }
        if there.same_settings(record) {
            return Ok(there.check_all(&self.path, SCENE).is_ok());
        }
        if replace {
            return Ok(false);
        }
        let cause = format!("{path} holds photographs that were imported with other settings");
        let cure = "give the same, choose another folder (-o), or replace them (--replace)";
        Err(Failure::new(cause, cure))
    }

    /// A folder that holds another scene, or frames of unknown origin, or something else under the
    /// name of an output, is not written to.
    pub(in crate::cli) fn refuse_foreign(
        &self,
        scene: &Scene,
        console: Console,
    ) -> Result<(), Failure> {
        output::refuse_obstacles(&self.path, &OWN_FOLDERS, &OWN_FILES)?;
        let path = self.path.display();
        let cure = "choose another folder (-o), or remove this one";
        if let Some(record) = Record::read(&self.path)? {
            if record.scene_hash != scene.hash {
                let cause = format!("{path} holds a run of another scene (`{}`)", record.scene);
                return Err(Failure::new(cause, cure));
            }
            return Ok(());
        }
        let own = self.path.join(SCENE);
        if own.exists() {
            // What cannot be read as a scene is not this one either.
            if !console
                .of_folders()
                .load_any_scene(&own.to_string_lossy())
                .is_ok_and(|s| s.hash == scene.hash)
            {
                return Err(Failure::new(
                    format!("{path} belongs to another scene ({SCENE})"),
                    cure,
                ));
            }
        }
        let holds =
            |dir: &str| fs::read_dir(self.path.join(dir)).is_ok_and(|mut d| d.next().is_some());
        if holds("frames") || holds(PARTIAL) || self.path.join(PHI).exists() {
            let cause = format!(
                "{path} holds frames or a {PHI}, but no {} that says of which scene",
                Record::FILE
            );
            return Err(Failure::new(cause, cure));
        }
        Ok(())
    }
}

/// Names of a run's folders and files, under which nothing else may stand.
const OWN_FOLDERS: [&str; 5] = ["frames", PARTIAL, MODEL, RECOVERED, COPIES];
const OWN_FILES: [&str; 10] = [
    SCENE,
    PHI,
    STDERR,
    TAILS,
    Record::FILE,
    SUMMARY,
    REPORT,
    LEFT_OUT,
    IMPORT,
    IMPORT_PNG,
];

/// That a folder holds a run that is not to be replaced.
pub(super) fn other_run(path: &Path, there: &Record, scene: &Scene) -> Failure {
    let path = path.display();
    if there.is_imported() {
        let cause = format!("{path} holds imported photographs, which nothing replaces");
        return Failure::new(cause, "choose another folder (-o)");
    }
    let cause = if there.scene_hash == scene.hash {
        format!("{path} holds a run with other settings ({})", there.origin)
    } else {
        format!("{path} holds a run of another scene (`{}`)", there.scene)
    };
    let cure = "give the same settings, choose another folder (-o), or replace it (--replace)";
    Failure::new(cause, cure)
}
