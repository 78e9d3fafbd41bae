//! Arguments of `phicam serve`.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;

use clap::Args as Arguments;

#[derive(Debug, Arguments)]
#[command(
    after_help = "The address is printed on standard output; Ctrl-C ends the server. It reads, it never writes, and it shows nothing outside DIR. \
    To look at a folder on another machine, run it there and `ssh -L 8017:localhost:8017 MACHINE` here."
)]
pub(in crate::cli) struct ServeArgs {
    /// Folder of a run or of a study
    pub dir: PathBuf,
    /// Port to listen on; 0: any that is free
    #[arg(long, default_value_t = 8017)]
    pub port: u16,
    /// Address of this machine to listen on; by any but a loopback address others on the network
    /// can read DIR; by a loopback address whoever has an account on this machine
    #[arg(long, value_name = "IP", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    pub address: IpAddr,
}
