//! How a result was asked for, and how to ask for it again.

use super::page::framed;
use super::run::{is_builtin, scene_text};
use super::svg::escape;
use crate::scene::Scene;
use crate::store::shell_word;

/// How a finding was asked for.
#[derive(Clone, Debug)]
pub struct Invocation {
    /// The words of the command that are not options, without the program's name.
    pub command: Vec<String>,
    /// The scene.
    pub scene: Scene,
    /// Name of the scene's file without its folder; of a built-in scene its name.
    pub file: String,
    /// Every option with its values, given or not.
    pub options: Vec<(String, String)>,
    /// Version of the program.
    pub version: String,
}

impl Invocation {
    /// The command that repeats it.
    fn command(&self) -> String {
        let mut words = vec!["phicam".to_owned()];
        words.extend(self.command.iter().map(|word| shell_word(word)));
        for (option, value) in &self.options {
            words.extend([option.clone(), shell_word(value)]);
        }
        words.join(" ")
    }

    /// The scene's file: its name and its text.
    pub(super) fn scene_file(&self) -> (String, String) {
        let name = if is_builtin(&self.scene) {
            format!("{}.toml", self.file)
        } else {
            self.file.clone()
        };
        (name, self.scene.text.clone())
    }

    /// Scene, settings, version and command; the scene's text.
    pub(super) fn html(&self) -> String {
        let facts = [
            ("scene", &self.scene.name),
            ("scene hash", &self.scene.hash),
            ("version", &format!("phicam {}", self.version)),
        ];
        let options = self
            .options
            .iter()
            .map(|(option, value)| (option.as_str(), value));
        let row = |(key, value): (&str, &String)| {
            let [key, value] = [key, value].map(escape);
            format!("<tr><th scope=\"row\">{key}</th><td>{value}</td></tr>\n")
        };
        let rows: String = facts.into_iter().chain(options).map(row).collect();
        format!(
            "{}<h3>To repeat it</h3>\n<pre>{}</pre>\n{}",
            framed("Settings", &rows),
            escape(&self.command()),
            scene_text(&self.scene)
        )
    }
}
