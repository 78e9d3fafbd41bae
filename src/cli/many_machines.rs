//! Many machines: plan, shard, merge, resume.
#![doc = include_str!("many_machines.md")]
