//! What follows the headers of an answer, a piece at a time.

use std::io::{self, ErrorKind};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use hyper::body::{Body, Bytes, Frame, SizeHint};
use tokio::sync::OwnedSemaphorePermit;
use tokio::task::{JoinError, JoinHandle, spawn_blocking};

/// Most bytes of a piece: what an answer holds in memory, however long it is.
pub(super) const PIECE: usize = 64 * 1024;

/// The place of a connection among those that may be open at once. What is done for it on another
/// thread keeps the place until it is done, whether or not the client is still there: so that what
/// is begun is bounded too.
pub(super) type Place = Arc<OwnedSemaphorePermit>;

/// Reads the next bytes of an answer: at least one and at most [`PIECE`]. Called while some are
/// left; may wait for a device.
pub(super) type Source = Box<dyn FnMut() -> io::Result<Vec<u8>> + Send>;

/// A source, back from the thread that has read from it, and what it has read.
type Read = (Source, io::Result<Vec<u8>>);

/// The bytes of an answer, of a length known before.
pub(super) enum Content {
    Bytes(Bytes),
    Pieces(Pieces),
}

/// Bytes that are read when the client has taken those before.
pub(super) struct Pieces {
    left: u64,
    state: State,
    /// Of the connection on which they are sent.
    pub place: Option<Place>,
}

enum State {
    Waiting(Source),
    Reading(JoinHandle<Read>),
    /// The source was cut short or could not be read: the connection ends, so that nobody takes
    /// what was sent for the whole.
    Broken,
}

impl Pieces {
    /// `length` bytes of `source`.
    pub(super) fn new(source: Source, length: u64) -> Self {
        Self {
            left: length,
            state: State::Waiting(source),
            place: None,
        }
    }

    fn poll_piece(&mut self, context: &mut Context<'_>) -> Poll<Option<io::Result<Bytes>>> {
        if self.left == 0 {
            return Poll::Ready(None);
        }
        let mut reading = match std::mem::replace(&mut self.state, State::Broken) {
            State::Waiting(mut source) => {
                let place = self.place.clone();
                spawn_blocking(move || {
                    let piece = source();
                    drop(place);
                    (source, piece)
                })
            }
            State::Reading(reading) => reading,
            State::Broken => return Poll::Ready(None),
        };
        match Pin::new(&mut reading).poll(context) {
            Poll::Pending => {
                self.state = State::Reading(reading);
                Poll::Pending
            }
            Poll::Ready(read) => Poll::Ready(Some(self.take(read))),
        }
    }

    fn take(&mut self, read: Result<Read, JoinError>) -> io::Result<Bytes> {
        let (source, piece) = read?;
        let piece = piece?;
        let length = piece.len() as u64;
        if length == 0 || length > self.left {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        self.left -= length;
        self.state = State::Waiting(source);
        Ok(piece.into())
    }
}

impl Body for Content {
    type Data = Bytes;
    type Error = io::Error;

    fn poll_frame(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, io::Error>>> {
        let bytes = match self.get_mut() {
            Self::Bytes(bytes) if bytes.is_empty() => Poll::Ready(None),
            Self::Bytes(bytes) => Poll::Ready(Some(Ok(std::mem::take(bytes)))),
            Self::Pieces(pieces) => pieces.poll_piece(context),
        };
        bytes.map(|next| next.map(|piece| piece.map(Frame::data)))
    }

    fn is_end_stream(&self) -> bool {
        self.left() == 0
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(self.left())
    }
}

impl Content {
    fn left(&self) -> u64 {
        match self {
            Self::Bytes(bytes) => bytes.len() as u64,
            Self::Pieces(pieces) => pieces.left,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use tokio::sync::Semaphore;

    use super::*;

    #[test]
    fn what_is_read_for_a_client_that_has_gone_keeps_its_place() {
        let runtime = tokio::runtime::Builder::new_multi_thread().build().unwrap();
        let _inside = runtime.enter();
        let places = Arc::new(Semaphore::new(1));
        let place = Arc::new(places.clone().try_acquire_owned().unwrap());
        let (began, begins) = channel();
        let (ends, ended) = channel();
        // Says that it reads, and reads until it hears that it has.
        let slow = move || {
            began.send(()).unwrap();
            ended.recv().unwrap();
            Ok(vec![1])
        };
        let mut pieces = Pieces::new(Box::new(slow), 2);
        pieces.place = Some(place.clone());
        let mut context = Context::from_waker(std::task::Waker::noop());
        assert!(pieces.poll_piece(&mut context).is_pending());
        begins.recv().unwrap();
        drop((pieces, place));
        assert_eq!(places.available_permits(), 0, "while it reads");
        ends.send(()).unwrap();
        let free = places.acquire();
        drop(runtime.block_on(free).unwrap());
    }
}
