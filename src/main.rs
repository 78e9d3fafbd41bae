//! phicam
fn main() {}
