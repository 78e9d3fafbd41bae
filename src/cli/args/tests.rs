use super::*;
use clap::CommandFactory;

#[test]
fn the_arguments_are_consistent() {
    Args::command().debug_assert();
}

/// Commands whose result is a picture, a program or a text to be kept as it is, or that speak
/// to Slurm or to a browser.
const NO_JSON: [&str; 10] = [
    "view",
    "target",
    "slurm",
    "serve",
    "show",
    "export",
    "new",
    "completions",
    "man",
    "notices",
];

#[test]
fn every_result_that_a_program_would_read_can_be_had_as_json() {
    fn walk(command: &clap::Command) {
        let name = command.get_name();
        let has = command.get_arguments().any(|a| a.get_id() == "json");
        let leads_on = command.has_subcommands();
        assert_eq!(has, !leads_on && !NO_JSON.contains(&name), "{name}");
        command.get_subcommands().for_each(walk);
    }
    Args::command().get_subcommands().for_each(walk);
}
