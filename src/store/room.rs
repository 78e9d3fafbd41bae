//! How much memory may be taken.
//!
//! ```text
//! room = least of  ¾·MemAvailable,  ¾·(limit − use) of each control group,  limit − mapped − reserve
//! ```
//!
//! The last is that of the address space and of data (`ulimit -v`, `ulimit -d`). What the system
//! does not say bounds nothing.

use std::path::{Path, PathBuf};

const MIB: f64 = (1u64 << 20) as f64;

/// Of what others may take meanwhile as well.
const SHARE: f64 = 0.75;
/// Address space of a thread: its stack, and the arena of 64 MiB that glibc reserves for it,
/// aligned by as much again.
const THREAD: f64 = 132.0 * MIB;
/// What of that counts as data: the stack, and what the arena begins with.
const THREAD_DATA: f64 = 4.0 * MIB;
/// Pools at work at once: the one that a command asks for, and the one of all others.
const POOLS: f64 = 2.0;

/// The memory that may be taken, and what bounds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// How many bytes.
    pub bytes: f64,
    /// What bounds them, in words.
    pub by: &'static str,
}

impl Room {
    /// At this moment, beside what pools of so many threads take; `None` where the system does not
    /// say.
    pub fn now(threads: usize) -> Option<Self> {
        Self::of(Path::new("/"), threads)
    }

    /// As the files below `root` say, for so many threads a pool.
    fn of(root: &Path, threads: usize) -> Option<Self> {
        let free = number(&root.join("proc/meminfo"), "MemAvailable:", 1024.0)
            .map(|free| (SHARE * free, "the memory that is free"));
        let group = groups(root)
            .iter()
            .filter_map(|group| group_room(group))
            .reduce(f64::min)
            .map(|free| (SHARE * free, "the limit of its control group"));
        let limit = limits(root)
            .map(|(left, thread)| left - POOLS * thread * threads as f64)
            .reduce(f64::min)
            .map(|left| (left, "the limit of its address space"));
        let rooms = [free, group, limit].into_iter().flatten();
        let (bytes, by) = rooms.reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        Some(Self {
            bytes: bytes.max(0.0),
            by,
        })
    }
}

/// Threads that fit a limit on the address space, a pool of them: half of what is left is theirs.
pub fn threads_that_fit(wanted: usize) -> usize {
    let fit = |(left, thread): (f64, f64)| (0.5 * left / (POOLS * thread)) as usize;
    let most = limits(Path::new("/")).map(fit).min();
    most.map_or(wanted, |most| wanted.min(most.max(1)))
}

/// Most bytes of what the system says of itself.
const SAID: u64 = 1 << 20;

/// What the system says in one of its files.
fn said(path: &Path) -> Option<String> {
    String::from_utf8(super::read(path, SAID).ok()?).ok()
}

/// The number behind `key`, times `unit`.
fn number(path: &Path, key: &str, unit: f64) -> Option<f64> {
    let said = said(path)?;
    let rest = said.lines().find_map(|line| line.strip_prefix(key))?;
    let value: f64 = rest.split_whitespace().next()?.parse().ok()?;
    Some(unit * value)
}

/// What is left of the limits on the address space and on data, if there are any, and what a thread
/// takes of each.
fn limits(root: &Path) -> impl Iterator<Item = (f64, f64)> {
    let [limits, status] = ["limits", "status"].map(|f| root.join("proc/self").join(f));
    let left = |limit, used| Some(number(&limits, limit, 1.0)? - number(&status, used, 1024.0)?);
    [
        left("Max address space", "VmSize:").map(|left| (left, THREAD)),
        left("Max data size", "VmData:").map(|left| (left, THREAD_DATA)),
    ]
    .into_iter()
    .flatten()
}

/// The control groups of the process, of both versions, each with those around it.
fn groups(root: &Path) -> Vec<PathBuf> {
    let said = said(&root.join("proc/self/cgroup")).unwrap_or_default();
    let mounted = root.join("sys/fs/cgroup");
    let mut found = Vec::new();
    for line in said.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(kinds), Some(path)) = (parts.next(), parts.next()) else {
            continue;
        };
        let mounts = match kinds {
            "" => vec![mounted.clone(), mounted.join("unified")],
            kinds if kinds.split(',').any(|k| k == "memory") => vec![mounted.join("memory")],
            _ => continue,
        };
        let path = Path::new(path.trim_start_matches('/'));
        for mount in mounts {
            // In a container the group's own path may not be mounted; what is around it is.
            found.extend(path.ancestors().map(|part| mount.join(part)));
        }
    }
    found
}

/// Limit − use of one control group, what it holds of files not counted, for that gives way.
fn group_room(group: &Path) -> Option<f64> {
    let read = |name: &str| number(&group.join(name), "", 1.0);
    let limit = read("memory.max").or_else(|| read("memory.limit_in_bytes"))?;
    let used = read("memory.current").or_else(|| read("memory.usage_in_bytes"))?;
    let stat = |key: &str| number(&group.join("memory.stat"), key, 1.0);
    let files = ["inactive_file ", "active_file "].map(|key| stat(key).unwrap_or(0.0));
    Some(limit - (used - files[0] - files[1]).max(0.0))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const GIB: f64 = 1024.0 * MIB;

    const MEMINFO: &str = "MemTotal:       8388608 kB\nMemAvailable:    4194304 kB\n";
    const STATUS: &str = "VmSize:\t 1048576 kB\nVmData:\t  524288 kB\n";

    fn machine(files: &[(&str, &str)]) -> Option<Room> {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        Room::of(root.path(), 1)
    }

    /// By hand from the numbers in the files: the least counts, whichever it is.
    #[test]
    fn the_least_bounds() {
        let limits = "Limit  Soft Limit  Hard Limit  Units\nMax data size             unlimited   unlimited  bytes\nMax address space         2147483648  2147483648 bytes\n";
        let none = "Max address space         unlimited            unlimited            bytes\n";
        let meminfo = ("proc/meminfo", MEMINFO);
        let status = ("proc/self/status", STATUS);
        let free = machine(&[meminfo, status, ("proc/self/limits", none)]).unwrap();
        assert_eq!(
            (free.bytes, free.by),
            (3.0 * GIB, "the memory that is free")
        );
        let bound = machine(&[meminfo, status, ("proc/self/limits", limits)]).unwrap();
        assert_eq!(bound.bytes, GIB - 2.0 * 132.0 * MIB);
        assert!(bound.by.contains("address space"));
        let group = [
            meminfo,
            ("proc/self/cgroup", "3:cpu:/\n0::/job/step\n"),
            ("sys/fs/cgroup/job/memory.max", "2147483648\n"),
            ("sys/fs/cgroup/job/memory.current", "1610612736\n"),
            (
                "sys/fs/cgroup/job/memory.stat",
                "anon 1\ninactive_file 536870912\nactive_file 0\n",
            ),
            ("sys/fs/cgroup/job/step/memory.max", "max\n"),
            ("sys/fs/cgroup/job/step/memory.current", "1\n"),
        ];
        assert_eq!(machine(&group).unwrap().bytes, 0.75 * GIB);
        let first = [
            meminfo,
            ("proc/self/cgroup", "4:memory:/elsewhere/x\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "1073741824\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "536870912\n"),
        ];
        assert_eq!(machine(&first).unwrap().bytes, 0.375 * GIB);
        assert_eq!(machine(&[]), None);
    }
}
