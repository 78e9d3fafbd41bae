//! The page of a study: what it found in a sentence, its figures made interactive, its numbers, its files, and how to repeat it.

mod account;
mod brdf;
mod budget;
mod convergence;
mod coverage;
mod experiment;
mod indicator;
mod noise;
mod power;
mod tolerance;

use super::page::{Library, Page, Room};
use super::run::{is_builtin, scene_text};
use super::svg::escape;
use crate::scene::Scene;

pub use account::Account;
pub use brdf::brdf_account;
pub use budget::budget_account;
pub use convergence::convergence_account;
pub use coverage::coverage_account;
pub use experiment::experiment_account;
pub use indicator::indicator_account;
pub use noise::noise_account;
pub use power::power_account;
pub use tolerance::tolerance_account;

/// How a study was asked for.
#[derive(Clone, Debug)]
pub struct Asked {
    /// Name of the study, as the command has it.
    pub study: String,
    /// The scene.
    pub scene: Scene,
    /// Name of the scene's file without its folder; of a built-in scene its name.
    pub file: String,
    /// Every option with its values, given or not.
    pub options: Vec<(String, String)>,
    /// Version of the program.
    pub version: String,
}

impl Asked {
    /// The command that repeats it.
    fn command(&self) -> String {
        let mut words = vec![
            "phicam study".to_owned(),
            quoted(&self.study),
            quoted(&self.file),
        ];
        for (option, value) in &self.options {
            words.extend([option.clone(), quoted(value)]);
        }
        words.join(" ")
    }
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-+=./:,@%".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// The page of a study from what it found, how it was asked for, and the files that it leaves (name and text): figures are shown, the others are there to be saved.
pub fn study_html(account: &Account, asked: &Asked, files: &[(String, String)]) -> String {
    let mut page = Page::new(&account.title);
    page.verdict(account.tone, &account.sentence);
    page.needs(Library::Plot);
    let mut room = Room::new();
    let (drawings, others): (Vec<_>, Vec<_>) =
        files.iter().partition(|(name, _)| name.ends_with(".svg"));
    let figures: String = drawings
        .iter()
        .map(|(name, svg)| room.figure(name, svg))
        .collect();
    page.section("figures", "Figures", &figures);
    page.section("numbers", "Numbers", &account.html());
    let scene = match is_builtin(&asked.scene) {
        true => format!("{}.toml", asked.file),
        false => asked.file.clone(),
    };
    let text = |(name, text): &'_ (String, String)| (name.clone(), text.clone());
    let mut kept: Vec<(String, String)> = others.into_iter().map(text).collect();
    kept.push((scene, asked.scene.text.clone()));
    // Small ones first, so that one that is too large does not leave them out.
    kept.sort_by_key(|(_, text)| text.len());
    let kept = kept
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_bytes()));
    page.section("data", "Data", &room.files(kept));
    page.section("run", "What was run", &run(asked));
    page.html()
}

/// Scene, settings, version and command; the scene's text.
fn run(asked: &Asked) -> String {
    let scene = &asked.scene;
    let facts = [
        ("scene", scene.name.clone()),
        ("scene hash", scene.hash.clone()),
        ("version", format!("phicam {}", asked.version)),
    ];
    let options = asked
        .options
        .iter()
        .map(|(option, value)| (option.as_str(), value.clone()));
    let mut html =
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Settings\"><table>\n"
            .to_owned();
    for (key, value) in facts.into_iter().chain(options) {
        let [key, value] = [key, &value].map(escape);
        html += &format!("<tr><th scope=\"row\">{key}</th><td>{value}</td></tr>\n");
    }
    html += &format!(
        "</table></div>\n<h3>To repeat it</h3>\n<pre>{}</pre>\n",
        escape(&asked.command())
    );
    html + &scene_text(scene)
}

#[cfg(test)]
mod tests;
