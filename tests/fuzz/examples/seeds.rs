//! Writes the seeds of all targets below the folder that is named.

use std::path::PathBuf;

use libfuzzer_sys as _;
use phicam_fuzz::{readers, seeds};

fn main() -> std::io::Result<()> {
    let folder: PathBuf = std::env::args_os().nth(1).unwrap_or_default().into();
    for reader in readers::ALL {
        let folder = folder.join(reader.name);
        std::fs::create_dir_all(&folder)?;
        for (i, seed) in seeds::of(reader.name).iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{i:02}")), seed)?;
        }
    }
    Ok(())
}
