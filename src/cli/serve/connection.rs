//! Clients, as many at once as can be answered.

use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use hyper::header::{CONNECTION, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::sync::{Notify, Semaphore};
use tokio::time::{sleep, timeout};

use super::body::Place;
use super::pace::Paced;
use super::routes::{Site, respond};

/// Most connections at once. Each has one file open at most, so that both fit into the 1024 files
/// that a process is commonly allowed.
const CONNECTIONS: u32 = 256;
/// Connections that the system holds until they are accepted.
const BACKLOG: u32 = 4096;
/// What the system keeps, each way, of what a client does not take or the server has not read,
/// bytes.
const SOCKET_BUFFER: u32 = 128 * 1024;
/// Longest first line and headers of a request together, bytes.
const REQUEST_MAX: usize = 16 * 1024;
/// How long the headers of a request may take, and how long a connection may be idle.
const HEADERS: Duration = Duration::from_secs(10);
/// How often the server looks whether it shall end, and tries again to accept where the system has
/// no room.
const LOOK: Duration = Duration::from_millis(100);
/// How long answers under way may take after Ctrl-C.
const FAREWELL: Duration = Duration::from_millis(500);

/// A listener on `address`.
pub(super) fn listen(address: SocketAddr) -> io::Result<TcpListener> {
    let socket = match address {
        SocketAddr::V4(_) => TcpSocket::new_v4()?,
        SocketAddr::V6(_) => TcpSocket::new_v6()?,
    };
    // A server that has just ended leaves its port behind; on Windows this would mean that two can
    // have it.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.set_send_buffer_size(SOCKET_BUFFER)?;
    socket.set_recv_buffer_size(SOCKET_BUFFER)?;
    socket.bind(address)?;
    socket.listen(BACKLOG)
}

/// Answers whoever comes, until `stop` is set. More than [`CONNECTIONS`] clients wait for each
/// other, in the system's queue: whoever has had an answer then has to connect again for the next
/// one.
pub(super) async fn serve(listener: TcpListener, site: &'static Site, stop: &AtomicBool) {
    let room = Arc::new(Room {
        places: Arc::new(Semaphore::new(CONNECTIONS as usize)),
        crowded: Notify::new(),
    });
    let accept = async {
        loop {
            let places = room.places.clone();
            let place = match places.clone().try_acquire_owned() {
                Ok(place) => Ok(place),
                Err(_) => {
                    room.crowded.notify_waiters();
                    places.acquire_owned().await
                }
            };
            match (place, listener.accept().await) {
                (Ok(place), Ok((stream, _))) => {
                    let room = room.clone();
                    tokio::spawn(async move {
                        converse(stream, site, &room, Arc::new(place)).await;
                    });
                }
                // No file descriptors are left, or the client has gone.
                _ => sleep(LOOK).await,
            }
        }
    };
    let stopped = async {
        while !stop.load(Ordering::Relaxed) {
            sleep(LOOK).await;
        }
    };
    tokio::select! {
        () = accept => {}
        () = stopped => {}
    }
    room.crowded.notify_waiters();
    let _ = timeout(FAREWELL, room.places.acquire_many(CONNECTIONS)).await;
}

/// Where connections are.
struct Room {
    /// Those that are free.
    places: Arc<Semaphore>,
    /// Called when there are none.
    crowded: Notify,
}

/// One connection, until the client ends it or takes too long, or others wait and it has had an
/// answer.
async fn converse(stream: TcpStream, site: &'static Site, room: &Room, place: Place) {
    let asked = AtomicBool::new(false);
    let service = service_fn(|request| {
        let (place, asked) = (&place, &asked);
        async move {
            asked.store(true, Ordering::Relaxed);
            let mut response = respond(site, request, place).await;
            if room.places.available_permits() == 0 {
                let close = HeaderValue::from_static("close");
                response.headers_mut().insert(CONNECTION, close);
            }
            Ok::<_, Infallible>(response)
        }
    });
    let mut builder = http1::Builder::new();
    builder
        .timer(TokioTimer::new())
        .header_read_timeout(HEADERS)
        // Bytes that are shared are not copied to be sent.
        .writev(true)
        .max_buf_size(REQUEST_MAX);
    let stream = TokioIo::new(Paced::new(stream));
    let mut connection = pin!(builder.serve_connection(stream, service));
    let mut last = false;
    loop {
        tokio::select! {
            // What went wrong with a connection concerns nobody else, and there is nobody to tell.
            _ = connection.as_mut() => break,
            () = room.crowded.notified(), if !last => {
                // Whoever has not asked yet is not sent away without an answer.
                last = asked.load(Ordering::Relaxed);
                if last {
                    connection.as_mut().graceful_shutdown();
                }
            }
        }
    }
}
