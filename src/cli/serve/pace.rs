//! A socket whose other end has to keep pace.

use std::io::{self, ErrorKind, IoSlice};
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Sleep, sleep};

/// How long a client may take for [`ENOUGH`] bytes, or for all that is to be sent if that is less.
pub(super) const PATIENCE: Duration = Duration::from_secs(15);
/// After so many bytes its time starts anew.
pub(super) const ENOUGH: usize = 64 * 1024;

/// A socket on which bytes wait [`PATIENCE`] for the client and no longer: then writing fails,
/// whatever is being sent and whoever sends it. The time runs while the system takes no more bytes,
/// until it has taken [`ENOUGH`] or the writer flushes, which is to say that it has nothing left.
/// What the server needs to have its bytes ready does not count.
pub(super) struct Paced<S> {
    socket: S,
    waiting: Option<Waiting>,
}

/// That bytes wait.
struct Waiting {
    until: Pin<Box<Sleep>>,
    /// Bytes taken since it began.
    taken: usize,
}

impl<S> Paced<S> {
    pub(super) fn new(socket: S) -> Self {
        let waiting = None;
        Self { socket, waiting }
    }

    /// What is to be said of a write of which the system says `written`.
    fn judged(
        &mut self,
        context: &mut Context<'_>,
        written: Poll<io::Result<usize>>,
    ) -> Poll<io::Result<usize>> {
        match (written, &mut self.waiting) {
            (Poll::Pending, waiting) => {
                let waiting = waiting.get_or_insert_with(|| Waiting {
                    until: Box::pin(sleep(PATIENCE)),
                    taken: 0,
                });
                let over = waiting.until.as_mut().poll(context);
                over.map(|()| Err(ErrorKind::TimedOut.into()))
            }
            (Poll::Ready(Ok(count)), Some(waiting)) => {
                waiting.taken += count;
                if waiting.taken >= ENOUGH {
                    self.waiting = None;
                }
                Poll::Ready(Ok(count))
            }
            (written, _) => written,
        }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Paced<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.socket).poll_read(context, buffer)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Paced<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.socket).poll_write(context, bytes);
        self.judged(context, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.socket).poll_write_vectored(context, slices);
        self.judged(context, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.socket.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.waiting = None;
        Pin::new(&mut self.socket).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.socket).poll_shutdown(context)
    }
}
