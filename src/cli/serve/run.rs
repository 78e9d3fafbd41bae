//! run.json of the folder.

use std::io::Read;

use super::answer::Refusal;
use super::folder::Served;
use crate::folder::Record;

/// Its bytes.
pub(super) fn bytes(folder: &Served) -> Result<Vec<u8>, Refusal> {
    let name = Record::FILE;
    let mut bytes = Vec::new();
    let file = folder.open(name)?.file;
    let read = file.take(Record::LARGEST).read_to_end(&mut bytes);
    read.map_err(|e| Refusal::broken(format!("cannot read {name}: {e}")))?;
    Ok(bytes)
}

/// What `bytes` say, with a number of pixels that is one.
pub(super) fn parsed(bytes: &[u8]) -> Result<Record, Refusal> {
    let damaged = |what: String| Refusal::broken(format!("{} is damaged: {what}", Record::FILE));
    let record: Record = Record::parse(bytes).map_err(damaged)?;
    match record.pixels {
        [columns, rows] if columns.checked_mul(rows).is_some() => Ok(record),
        [columns, rows] => Err(damaged(format!("{columns} × {rows} pixels"))),
    }
}

/// What was run.
pub(super) fn record(folder: &Served) -> Result<Record, Refusal> {
    parsed(&bytes(folder)?)
}
