//! How long a client may take.

use std::future::pending;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;
use tokio::time::{Instant, timeout_at};

/// How long the headers of a request may take, and how long a connection may be idle.
pub(super) const HEADERS: Duration = Duration::from_secs(10);
/// How long a client may take for one piece of an answer.
const PIECE: Duration = Duration::from_secs(15);

/// By when the client of a connection has to take something of its answer: the connection waits for that time to pass, and the bodies of its answers
/// move it on.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    until: Arc<watch::Sender<Option<Instant>>>,
}

impl Pace {
    pub(super) fn new() -> Self {
        let until = Arc::new(watch::Sender::new(None));
        Self { until }
    }

    /// Something was taken, or begins.
    pub(super) fn step(&self) {
        self.until.send_replace(Some(Instant::now() + PIECE));
    }

    /// Nothing is to be taken.
    pub(super) fn rest(&self) {
        self.until.send_replace(None);
    }

    /// Returns when the client has taken too long.
    pub(super) async fn lost(&self) {
        let mut until = self.until.subscribe();
        loop {
            let now = *until.borrow_and_update();
            let changed = match now {
                Some(time) => timeout_at(time, until.changed()).await,
                None => Ok(until.changed().await),
            };
            match changed {
                Err(_) => return,
                Ok(Ok(())) => {}
                // `self` has the sender.
                Ok(Err(_)) => pending().await,
            }
        }
    }
}
