//! Files that a scene names: meshes, pictures, measured materials.
//!
//! A scene may come from anyone. It reads ordinary files in its own folder and below, and nothing
//! else; links that lead out of it included. Who starts phicam may name further folders. What was
//! read is remembered with its digest, so that the scene's hash speaks of the contents, and a run
//! can keep a copy.

use std::path::{Component, Path, PathBuf};

use crate::store::{self, digest_of};

/// Folder of copies beside a scene file: looked into for what is not there itself.
pub const COPIES: &str = "files";

/// A file that a scene names, of any kind, is not read if it is larger: 1 GiB.
pub(super) const LARGEST: u64 = 1 << 30;

/// A file that a scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Referenced {
    /// As the scene names it.
    pub name: String,
    /// Where it was read.
    pub path: PathBuf,
    /// SHA-256 of its bytes (hex).
    pub digest: String,
}

impl Referenced {
    /// The name of its copy in [`COPIES`]: a part of the digest of its name, so that no two
    /// collide, and its last component.
    pub fn copy_name(&self) -> String {
        copy_name(&self.name)
    }

    /// Its bytes once more: those that were read before.
    ///
    /// # Errors
    /// Cause and cure, where it has changed meanwhile or cannot be read.
    pub fn again(&self) -> Result<Vec<u8>, (String, &'static str)> {
        let bytes = store::read(&self.path, LARGEST).map_err(|e| {
            let cause = format!("cannot read `{}` again: {}", self.name, e.fault);
            let cure = "leave the scene's files in place while phicam starts";
            (cause, cure)
        })?;
        if digest_of(&bytes) == self.digest {
            return Ok(bytes);
        }
        let cause = format!("`{}` has changed since the scene was read", self.name);
        Err((cause, "start again"))
    }
}

fn copy_name(name: &str) -> String {
    let last: String = name
        .rsplit(['/', '\\'])
        .next()
        .unwrap_or_default()
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() || ".-_".contains(c) {
                c
            } else {
                '_'
            }
        })
        .collect();
    format!("{}-{last}", &digest_of(name.as_bytes())[..12])
}

/// Where a scene may read files.
#[derive(Clone, Debug, Default)]
pub(super) struct Folders {
    /// The scene's folder; none for a scene that is only text.
    own: Option<PathBuf>,
    /// Further folders, named by whoever started the program.
    also: Vec<PathBuf>,
}

/// What a scene may read, and has read.
#[derive(Debug, Default)]
pub(super) struct Files {
    pub folders: Folders,
    pub read: Vec<Referenced>,
}

impl From<Folders> for Files {
    fn from(folders: Folders) -> Self {
        let read = Vec::new();
        Self { folders, read }
    }
}

impl Files {
    pub(super) fn of(folder: &Path, also: &[PathBuf]) -> Self {
        let (own, also) = (Some(folder.to_owned()), also.to_vec());
        Self::from(Folders { own, also })
    }

    /// The bytes of the file that the scene calls `name`, at most `most` of them; or what is wrong,
    /// and the cure.
    pub(super) fn bytes(&mut self, name: &str, most: u64) -> Result<Vec<u8>, (String, String)> {
        let path = self.find(name)?;
        let bytes = store::read(&path, most).map_err(|e| {
            let copy = format!("{COPIES}/{}", copy_name(name));
            let place = if path.ends_with(&copy) {
                format!(", its copy {copy}")
            } else {
                String::new()
            };
            let cause = format!("cannot read `{name}`{place}: {}", e.fault);
            (cause, e.fault.cure().to_owned())
        })?;
        let digest = digest_of(&bytes);
        if let Some(earlier) = self.read.iter().find(|r| r.name == name) {
            if earlier.digest != digest {
                let cause = format!("`{name}` changed while the scene was read");
                return Err((
                    cause,
                    "leave the scene's files in place, and start again".to_owned(),
                ));
            }
        } else {
            self.read.push(Referenced {
                name: name.to_owned(),
                path,
                digest,
            });
        }
        Ok(bytes)
    }

    /// The same for readers that put their own cure beside what was wrong.
    pub(super) fn bytes_or_words(&mut self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        self.bytes(name, most)
            .map_err(|(cause, cure)| format!("{cause}; {cure}"))
    }

    /// Where that file is.
    fn find(&self, name: &str) -> Result<PathBuf, (String, String)> {
        let Some(folder) = &self.folders.own else {
            let cause = format!("`{name}` is named by a scene that is no file and has no folder");
            return Err((cause, "read the scene from a file beside it".to_owned()));
        };
        let copy = folder.join(COPIES).join(copy_name(name));
        let outside = || {
            let cause = format!("`{name}` lies outside the scene's folder");
            let cure = "copy it beside the scene file, or allow its folder with --also-read DIR";
            (cause, cure.to_owned())
        };
        let plain = |c: Component<'_>| matches!(c, Component::Normal(_) | Component::CurDir);
        let inside = Path::new(name).components().all(plain);
        // The file itself comes before a copy of it, which may be older.
        let candidates = [(folder.join(name), folder.clone()), (copy, folder.clone())];
        let own = candidates.into_iter().skip(if inside { 0 } else { 1 });
        let also = self
            .folders
            .also
            .iter()
            .map(|a| (folder.join(name), a.clone()));
        let mut found_outside = !inside;
        for (path, root) in own.chain(also) {
            let (Ok(path), Ok(root)) = (path.canonicalize(), root.canonicalize()) else {
                continue;
            };
            if path.starts_with(&root) {
                return Ok(path);
            }
            found_outside = true;
        }
        if found_outside {
            return Err(outside());
        }
        let cause = format!("there is no file `{name}` beside the scene");
        let cure = "check the name: paths are relative to the scene file's folder";
        Err((cause, cure.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn place() -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir_all(dir.path().join("scene/below")).unwrap();
        fs::write(dir.path().join("secret"), "no").unwrap();
        fs::write(dir.path().join("scene/own"), "yes").unwrap();
        fs::write(dir.path().join("scene/below/own"), "deep").unwrap();
        dir
    }

    #[test]
    fn what_lies_in_the_folder_is_read_and_remembered() {
        let dir = place();
        let mut files = Files::of(&dir.path().join("scene"), &[]);
        assert_eq!(files.bytes("own", 10).unwrap(), b"yes");
        assert_eq!(files.bytes("./below/own", 10).unwrap(), b"deep");
        assert_eq!(files.bytes("own", 10).unwrap(), b"yes");
        assert_eq!(files.read.len(), 2);
        // The digest of "yes", from another program.
        assert!(
            files.read[0]
                .digest
                .starts_with("8a798890fe93817163b10b5f7bd2ca4d")
        );
        assert!(files.bytes("own", 2).unwrap_err().0.contains("at most 2"));
        assert!(files.bytes("below", 10).unwrap_err().0.contains("ordinary"));
        assert!(files.bytes("absent", 10).unwrap_err().0.contains("no file"));
    }

    #[test]
    fn nothing_outside_is_read_unless_asked() {
        let dir = place();
        let folder = dir.path().join("scene");
        let absolute = dir.path().join("secret");
        let absolute = absolute.to_str().unwrap();
        let mut names = vec!["../secret", absolute, "below/../../secret", "/etc/passwd"];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(absolute, folder.join("link")).unwrap();
            names.push("link");
        }
        let mut files = Files::of(&folder, &[]);
        for name in &names {
            let (cause, cure) = files.bytes(name, 10).unwrap_err();
            assert!(
                cause.contains("outside") && cure.contains("--also-read"),
                "{name}: {cause}"
            );
        }
        assert!(files.read.is_empty());
        let mut files = Files::of(&folder, &[dir.path().to_owned()]);
        for name in names.iter().filter(|n| **n != "/etc/passwd") {
            assert_eq!(files.bytes(name, 10).unwrap(), b"no", "{name}");
        }
        assert!(files.bytes("/etc/passwd", 10).is_err());
        assert!(Files::default().bytes("own", 10).is_err());
    }

    /// A run keeps copies under names of their own, whatever the scene calls them.
    #[test]
    fn copies_stand_in_for_what_is_gone() {
        let dir = place();
        let folder = dir.path().join("scene");
        fs::create_dir(folder.join(COPIES)).unwrap();
        for (name, text) in [("../secret", "copy"), ("gone", "kept")] {
            let path = folder.join(COPIES).join(copy_name(name));
            fs::write(path, text).unwrap();
            let mut files = Files::of(&folder, &[]);
            assert_eq!(files.bytes(name, 10).unwrap(), text.as_bytes());
            assert_eq!(files.read[0].copy_name(), copy_name(name));
        }
        fs::write(folder.join(COPIES).join(copy_name("own")), "old").unwrap();
        let mut files = Files::of(&folder, &[]);
        assert_eq!(files.bytes("own", 10).unwrap(), b"yes");
        assert!(!copy_name("a/../b\\c d:é").contains(['/', '\\', ' ', ':']));
    }
}
