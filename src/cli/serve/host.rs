//! Whom a request may be addressed to.
//!
//! A page from anywhere can make its own host name stand for 127.0.0.1 after it was loaded (DNS
//! rebinding), and then read this server as its own. Its requests still carry that name.

use std::net::IpAddr;

use hyper::header::HOST;
use hyper::http::uri::Authority;
use hyper::{Request, StatusCode};

use super::answer::Refusal;

/// Refuses a request that does not name this server, which listens on `address`: by `localhost`, a
/// loopback address, `address` itself, or any number where `address` stands for all of this
/// machine. Ports do not matter: a tunnel has another one.
///
/// # Errors
/// 400 for no name or several, 403 for another name.
pub(super) fn check<B>(request: &Request<B>, address: IpAddr) -> Result<(), Refusal> {
    let mut hosts = request.headers().get_all(HOST).iter();
    let (Some(host), None) = (hosts.next(), hosts.next()) else {
        return Err(Refusal::meaningless("a request has to have one Host"));
    };
    let host = Authority::try_from(host.as_bytes()).ok();
    // A request to a proxy has the name in its first line too.
    let also = request.uri().authority();
    if host.iter().chain(also).all(|h| is_own(h, address)) && host.is_some() {
        return Ok(());
    }
    let words = format!("this server is localhost or {address}, not the host that was asked for");
    Err(Refusal::new(StatusCode::FORBIDDEN, words))
}

fn is_own(host: &Authority, address: IpAddr) -> bool {
    let name = host.host();
    let number = name.strip_prefix('[').and_then(|n| n.strip_suffix(']'));
    let user = host.as_str().contains('@');
    let own = match number.unwrap_or(name).parse::<IpAddr>() {
        Ok(ip) => ip.is_loopback() || ip == address || address.is_unspecified(),
        Err(_) => name.eq_ignore_ascii_case("localhost"),
    };
    own && !user
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(uri: &str, hosts: &[&str], address: &str) -> Option<u16> {
        let mut request = Request::builder().uri(uri);
        for host in hosts {
            request = request.header(HOST, *host);
        }
        let request = request.body(()).unwrap();
        let checked = check(&request, address.parse().unwrap());
        checked.err().map(|r| r.status.as_u16())
    }

    #[test]
    fn a_request_names_this_server() {
        for host in [
            "localhost",
            "LocalHost:8017",
            "127.0.0.1",
            "127.0.0.1:1",
            "[::1]",
            "[::1]:8017",
        ] {
            assert_eq!(status("/", &[host], "127.0.0.1"), None, "{host}");
        }
        for host in [
            "example.org",
            "example.org:8017",
            "localhost.example.org",
            "127.0.0.1.example.org",
            "localhost@example.org",
            "example.org@localhost",
            "10.0.0.7",
            "0.0.0.0",
            "",
            "a b",
        ] {
            assert_eq!(status("/", &[host], "127.0.0.1"), Some(403), "{host}");
        }
        assert_eq!(status("/", &[], "127.0.0.1"), Some(400));
        let both = ["localhost", "localhost"];
        assert_eq!(status("/", &both, "127.0.0.1"), Some(400));
        let line = "http://example.org/";
        assert_eq!(status(line, &["localhost"], "127.0.0.1"), Some(403));
        assert_eq!(
            status("http://localhost/", &["localhost"], "127.0.0.1"),
            None
        );
    }

    #[test]
    fn an_address_that_was_given_is_its_own() {
        assert_eq!(status("/", &["10.0.0.7"], "10.0.0.7"), None);
        assert_eq!(status("/", &["10.0.0.8"], "10.0.0.7"), Some(403));
        for all in ["0.0.0.0", "::"] {
            assert_eq!(status("/", &["10.0.0.8:8017"], all), None);
            assert_eq!(status("/", &["example.org"], all), Some(403));
        }
    }
}
