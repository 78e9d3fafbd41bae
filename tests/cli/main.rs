//! The `phicam` command as its user meets it: the binary is run, its exit code, its words and its
//! files are looked at.

mod bad_folders;
mod bad_frames;
mod bad_recoveries;
mod bad_scenes;
mod bad_settings;
mod calibrating;
mod digests;
mod exposing;
mod exposing_again;
mod foreign_files;
#[cfg(unix)]
mod forged_kinds;
mod import_round_trip;
mod importing;
mod interruption;
mod killing;
mod large_photographs;
mod locating;
mod machine_readable;
mod main_job;
mod many;
mod memory;
mod recovery;
mod recovery_own;
mod replacing;
mod reproducibility;
mod reproducing;
mod scenes;
mod server;
mod serving;
mod serving_deaf;
mod serving_forged;
mod serving_many;
mod shining;
mod small_doors;
mod small_scene;
mod stacking;
mod studies;
mod suspicious;
mod sweeps;
mod targets;
mod verdict;
mod views;
mod workspace;
mod writers;
