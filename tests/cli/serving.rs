//! What `phicam serve` answers, and what it does not.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::server::{Ends, Server, made_up, request};
use crate::workspace::{Workspace, assert_same};

/// Columns, rows and spots of matrices: rows of 1040 bytes, which are read with what lies between,
/// and of 5600 bytes.
const SHAPES: [(usize, usize, usize); 2] = [(37, 29, 130), (21, 33, 700)];

/// A sequence without a pattern, below `limit`.
fn draw(state: &mut u64, limit: usize) -> usize {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize % limit
}

/// The middle of each block of `step` of the pixels `first` to `first + length − 1`, found by
/// listing the block.
fn middles(first: usize, length: usize, step: usize) -> Vec<usize> {
    let all: Vec<usize> = (first..first + length).collect();
    let middle = |block: &[usize]| *block.get(step / 2).unwrap_or(&block[block.len() - 1]);
    all.chunks(step).map(middle).collect()
}

#[test]
fn frames_and_rows_are_those_of_the_matrices() {
    let workspace = Workspace::new();
    let mut state = 9;
    for shape @ (columns, rows, spots) in SHAPES {
        let matrices = made_up(&workspace, "out", shape);
        let before = workspace.contents("");
        let server = Server::of(&workspace, "out");
        let about = server.get("/api/about");
        let about: serde_json::Value = serde_json::from_slice(&about.body).expect("JSON");
        let expected = serde_json::json!({
            "version": "0.1.0", "scene": "made up", "hash": "0", "seed": "18446744073709551615", "pixels": [columns, rows], "spots": spots,
            "matrices": ["traced", "stderr", "modelled", "z"]
        });
        assert_eq!(about, expected);
        for n in 0..90 {
            let matrix = &matrices[n % 4];
            let name = ["traced", "stderr", "modelled", "z"][n % 4];
            let (x, y) = (draw(&mut state, columns), draw(&mut state, rows));
            let w = 1 + draw(&mut state, columns - x);
            let h = 1 + draw(&mut state, rows - y);
            // The first are whole frames, one of them with what is not finite.
            let (x, y, w, h) = if n < 8 {
                (0, 0, columns, rows)
            } else {
                (x, y, w, h)
            };
            let step = if n < 4 { 1 } else { 1 + draw(&mut state, 9) };
            let spot = if n < 3 { 2 } else { draw(&mut state, spots) };
            let path =
                format!("/api/frame?matrix={name}&spot={spot}&x={x}&y={y}&w={w}&h={h}&step={step}");
            let reply = server.get(&path);
            let (across, up) = (middles(x, w, step), middles(y, h, step));
            let expected: Vec<u64> = up
                .iter()
                .flat_map(|r| across.iter().map(move |c| c + columns * r))
                .map(|p| matrix[(p, spot)].to_bits())
                .collect();
            assert!(reply.numbers() == expected, "{path}");
            let counts = [reply.header("x-columns"), reply.header("x-rows")];
            assert_eq!(
                counts,
                [across.len(), up.len()].map(|n| n.to_string()),
                "{path}"
            );

            let pixel = if n < 3 {
                n + 3
            } else {
                draw(&mut state, columns * rows)
            };
            let path = format!("/api/row?matrix={name}&pixel={pixel}");
            let expected: Vec<u64> = matrix.row(pixel).iter().map(|v| v.to_bits()).collect();
            assert!(server.get(&path).numbers() == expected, "{path}");
        }
        assert_same(&before, &workspace.contents(""), "served");
        server.ends();
    }
}

#[test]
fn a_real_run_is_served_and_made_again_meanwhile() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o out --samples 32")
        .exits(0);
    let server = Server::of(&workspace, "out");
    // There is no report yet: the page is made of what is there, also of what comes later.
    let rendered = server.get("/").text();
    let _ = workspace.phicam("model tiny.toml -o out").exits(0);
    let reply = server.get("/");
    assert_eq!(reply.status, 200);
    let page = reply.text();
    assert_ne!(page, rendered, "with the model");
    assert_eq!(server.get("/").text(), page, "the same again");
    assert!(
        page.contains("6 pixels × 8 spots") && page.contains("class=\"explorer\""),
        "{page}"
    );
    assert_eq!(reply.header("content-type"), "text/html; charset=utf-8");
    let values = |name: &str| {
        let reply = server.get(&format!("/api/row?matrix={name}&pixel=5"));
        reply
            .numbers()
            .into_iter()
            .map(f64::from_bits)
            .collect::<Vec<_>>()
    };
    let row = |file: &str| {
        workspace
            .matrix(file)
            .row(5)
            .iter()
            .copied()
            .collect::<Vec<_>>()
    };
    let first = values("traced");
    assert_eq!(first, row("out/phi.npy"));
    assert_eq!(values("stderr"), row("out/phi.stderr.npy"));
    assert_eq!(values("modelled"), row("out/model/phi.npy"));
    let _ = workspace
        .phicam("render tiny.toml -o out --samples 32 --seed 2 --replace")
        .exits(0);
    let second = values("traced");
    assert_eq!(second, row("out/phi.npy"));
    assert_ne!(second, first);
    let page = server.get("/").text();
    assert!(page.contains("seed 2."), "the page of the run before");
    // A scene that is damaged, or not that of the record, has no page, until it has again.
    let (scene, record) = (
        workspace.text("out/scene.toml"),
        workspace.text("out/run.json"),
    );
    workspace.write("out/scene.toml", "[");
    workspace.write("out/run.json", record.clone() + "\n");
    server.get("/").refuses(500, "a damaged scene");
    workspace.write("out/scene.toml", &scene);
    assert!(server.get("/").text().contains("seed 2."));
    workspace.write(
        "out/run.json",
        record.replace("\"scene_hash\": \"", "\"scene_hash\": \"x"),
    );
    server.get("/").refuses(500, "another scene");
    workspace.write("out/run.json", &record);
    assert!(server.get("/").text().contains("seed 2."));

    for (name, page) in [("reproduction.html", "<p>2"), ("report.html", "<p>1")] {
        workspace.write(&format!("out/{name}"), page);
        for path in ["/".to_owned(), format!("/files/{name}")] {
            assert_eq!(server.get(&path).text(), page, "{path}");
        }
    }
    let reply = server.get("/");
    assert_eq!(reply.header("content-type"), "text/html; charset=utf-8");
    let policy = reply.header("content-security-policy");
    assert!(policy.contains("default-src 'none'") && policy.contains("script-src 'unsafe-inline'"));

    let words = server.ends();
    assert!(words.contains("serving out; Ctrl-C"), "{words}");
}

#[test]
fn nothing_outside_the_folder_is_shown() {
    let workspace = Workspace::new();
    made_up(&workspace, "out", (3, 2, 5));
    let secret = b"nobody outside may read this";
    workspace.write("secret.txt", secret);
    fs::create_dir(workspace.path("out/deep")).expect("a folder");
    for name in [
        "out/.hidden",
        "out/half.part",
        "out/deep/a b.txt",
        "out/back\\slash",
    ] {
        workspace.write(
            name,
            if name.contains("a b") {
                &b"shown"[..]
            } else {
                secret
            },
        );
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        let absolute = workspace.path("secret.txt");
        for (to, link) in [
            (absolute.as_path(), "out/absolute.txt"),
            (Path::new("../secret.txt"), "out/relative.txt"),
            (Path::new(".."), "out/up"),
            (Path::new("/"), "out/root"),
            (Path::new("/proc/self/root"), "out/magic"),
            (Path::new("loop"), "out/loop"),
            (Path::new("deep/a b.txt"), "out/inside.txt"),
            (Path::new("../out/deep/a b.txt"), "out/around.txt"),
        ] {
            symlink(to, workspace.path(link)).expect("a link");
        }
        let fifo = std::process::Command::new("mkfifo")
            .arg(workspace.path("out/pipe"))
            .status();
        assert!(fifo.expect("mkfifo").success());
    }
    let server = Server::of(&workspace, "out");
    for path in [
        "/files/deep/a%20b.txt",
        "/files/%64eep/a%20b.txt",
        "/files/deep/a%20b.txt?v=1",
    ] {
        assert_eq!(server.get(path).body, b"shown", "{path}");
    }
    let absolute = workspace.path("secret.txt");
    let absolute = absolute.display();
    let mut paths: Vec<String> = vec![format!("/files/{absolute}"), format!("{absolute}")];
    for up in [
        "..",
        "%2e%2e",
        "%2E.",
        ".%2e",
        "%252e%252e",
        "..%2f..",
        "%2e%2e%2f..",
        "..%5c..",
        "..\\..",
        "%c0%ae%c0%ae",
        "%uff0e%uff0e",
        "..%00",
        "....",
        "..;",
        "deep/../..",
        "deep/%2e%2e/..",
        "deep/..%2f..",
        ".",
        "%2e/..",
        "up",
        "magic",
        "root",
        "",
        "deep//..",
    ] {
        for slash in ["/", "%2f", "%5c", "\\", "//"] {
            paths.push(format!("/files/{up}{slash}secret.txt"));
            paths.push(format!("/files/{up}{slash}{up}{slash}secret.txt"));
            paths.push(format!("/{up}{slash}secret.txt"));
        }
        paths.push(format!("/files/{up}{absolute}"));
    }
    for name in [
        ".hidden",
        "%2ehidden",
        "half.part",
        "absolute.txt",
        "relative.txt",
        "loop",
        "pipe",
        "deep",
        "deep/",
        "",
        "/",
        "%00",
        "phi.npy%00.txt",
        "phi.npy/",
        "phi.npy/.",
        "deep/phi.npy",
        "C:%5cphi.npy",
        "phi.npy%0d%0aX: y",
        "back%5cslash",
        "%ff",
        "%",
    ] {
        paths.push(format!("/files/{name}"));
    }
    paths.push(format!("/files/{}", "a/".repeat(4000)));
    paths.push(format!("/files/{}", "a".repeat(8000)));
    paths.extend(
        [
            "/files",
            "/etc/passwd",
            "/phi.npy",
            "/api",
            "/api/",
            "/api/about/",
            "*",
            "/./files/phi.npy",
        ]
        .map(str::to_owned),
    );
    for path in &paths {
        let reply = server.get(path);
        assert!(
            [400, 404].contains(&reply.status),
            "{path}: {}",
            reply.status
        );
        assert!(!reply.text().contains("nobody outside"), "{path}");
    }
    for path in ["/files/inside.txt", "/files/phi.npy"]
        .into_iter()
        .filter(|_| cfg!(unix))
    {
        assert_eq!(server.get(path).status, 200, "{path}");
    }
    // What is refused on disk is refused as a matrix too.
    #[cfg(unix)]
    {
        fs::rename(workspace.path("out/phi.npy"), workspace.path("phi.npy")).expect("moved");
        std::os::unix::fs::symlink("../phi.npy", workspace.path("out/phi.npy")).expect("a link");
        server
            .get("/api/row?matrix=traced&pixel=0")
            .refuses(404, "a matrix outside");
        fs::rename(workspace.path("phi.npy"), workspace.path("out/phi.npy")).expect("moved");
    }
    server.ends();
}

/// Counts the answers to `path` while `swap` goes on beside them: inside, refused, outside.
#[cfg(unix)]
fn seen_meanwhile(server: &Server, path: &str, swap: impl Fn() + Sync) -> [usize; 3] {
    let done = AtomicBool::new(false);
    let mut seen = [0; 3];
    std::thread::scope(|scope| {
        let _ends = Ends(&done);
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                swap();
            }
        });
        for _ in 0..1500 {
            let reply = server.get(path);
            seen[match (reply.status, &reply.body[..]) {
                (200, b"inside") => 0,
                (404, _) => 1,
                _ => 2,
            }] += 1;
        }
    });
    seen
}

#[test]
#[cfg(unix)]
fn what_is_swapped_for_a_link_does_not_lead_out() {
    use std::os::unix::fs::symlink;

    let workspace = Workspace::new();
    made_up(&workspace, "out", (3, 2, 5));
    fs::create_dir(workspace.path("out/inner")).expect("a folder");
    fs::create_dir(workspace.path("outer")).expect("a folder");
    workspace.write("out/inner/a.txt", "inside");
    workspace.write("outer/a.txt", "outside");
    symlink("../outer", workspace.path("out/link")).expect("a link");
    symlink("inner", workspace.path("out/way")).expect("a link");
    let server = Server::of(&workspace, "out");
    let [inner, link, place, next, way] =
        ["inner", "link", "place", "next", "way"].map(|n| workspace.path(&format!("out/{n}")));
    // A folder and a link in turns; in between nothing is there.
    let seen = seen_meanwhile(&server, "/files/place/a.txt", || {
        for from in [&inner, &link] {
            fs::rename(from, &place).expect("swapped in");
            fs::rename(&place, from).expect("swapped out");
        }
    });
    assert!(seen[0] > 0 && seen[2] == 0, "{seen:?}");
    // A link that always is there, so that a refusal means that it led out at that moment.
    let seen = seen_meanwhile(&server, "/files/way/a.txt", || {
        for to in ["../outer", "inner"] {
            symlink(to, &next).expect("a link");
            fs::rename(&next, &way).expect("replaced");
        }
    });
    assert!(seen[0] > 0 && seen[1] > 0 && seen[2] == 0, "{seen:?}");
    server.ends();
}

#[test]
fn a_range_is_that_part_of_the_file() {
    let workspace = Workspace::new();
    made_up(&workspace, "out", (30, 20, 50));
    let bytes = workspace.read("out/phi.npy");
    let all = bytes.len();
    assert!(all > 3 * 64 * 1024, "several pieces");
    workspace.write("out/empty.csv", "");
    let server = Server::of(&workspace, "out");
    let get = |range: &str| server.get_with("/files/phi.npy", &[&format!("Range: {range}")]);
    let huge = "9".repeat(30);
    for (range, first, last) in [
        ("bytes=0-9", 0, 9),
        ("bytes=100000-170000", 100_000, 170_000),
        ("bytes=-5", all - 5, all - 1),
        ("bytes=77-", 77, all - 1),
        (&format!("bytes=77-{huge}"), 77, all - 1),
    ] {
        let reply = get(range);
        assert_eq!(reply.status, 206, "{range}");
        assert!(reply.body == bytes[first..=last], "{range}");
        let said = format!("bytes {first}-{last}/{all}");
        assert_eq!(reply.header("content-range"), said, "{range}");
    }
    for range in [
        "bytes=9-5",
        "bytes=--5",
        "bytes=-",
        "bytes=a-b",
        "bytes=0-1,3-4",
        "spots=0-1",
        "bytes=-1-2",
        "bytes=0x1-2",
        &"bytes=0-1,".repeat(500),
    ] {
        let reply = get(range);
        assert!(reply.status == 200 && reply.body == bytes, "{range}");
    }
    for range in [
        format!("bytes={all}-"),
        format!("bytes={huge}-{huge}"),
        "bytes=-0".to_owned(),
    ] {
        let reply = get(&range);
        reply.refuses(416, &range);
        assert_eq!(reply.header("content-range"), format!("bytes */{all}"));
    }
    let twice = ["Range: bytes=0-1", "Range: bytes=3-4"];
    assert_eq!(server.get_with("/files/phi.npy", &twice).status, 200);
    let conditional = ["Range: bytes=0-1", "If-Range: \"a\""];
    assert_eq!(server.get_with("/files/phi.npy", &conditional).status, 200);
    let empty = server.get_with("/files/empty.csv", &["Range: bytes=-1"]);
    assert_eq!((empty.status, empty.body.len()), (200, 0));
    let head = server.ask(request("HEAD", "/files/phi.npy", &["Range: bytes=0-1"]).as_bytes());
    let length = head.header("content-length").parse();
    assert_eq!((head.status, length), (200, Ok(all)));
    server.ends();
}

#[test]
fn only_reading_by_this_host_is_allowed() {
    let workspace = Workspace::new();
    made_up(&workspace, "out", (3, 2, 5));
    let before = workspace.contents("");
    let server = Server::of(&workspace, "out");
    let reply = server.get("/");
    reply.refuses(404, "no page");
    assert!(reply.text().contains("phicam run"), "{}", reply.text());
    let address = server.address();
    for method in [
        "POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PROPFIND", "get",
    ] {
        for path in ["/files/phi.npy", "/files/new.txt", "/api/about"] {
            // CONNECT has no path.
            let path = if method == "CONNECT" {
                "localhost:80"
            } else {
                path
            };
            let reply = server.ask(request(method, path, &[]).as_bytes());
            reply.refuses(405, method);
            assert_eq!(reply.header("allow"), "GET, HEAD", "{method}");
        }
    }
    let raw = |text: &str| server.ask(text.as_bytes());
    raw(&request("PUT", "/files/new.txt", &["Content-Length: 3"])).refuses(405, "a body");
    raw(&request("GET", "/api/about", &["Content-Length: 3"])).refuses(413, "a body");
    raw(&request(
        "GET",
        "/api/about",
        &["Transfer-Encoding: chunked"],
    ))
    .refuses(413, "a body");
    for host in [
        format!("127.0.0.1:{}", address.port()),
        "localhost".to_owned(),
        "[::1]:1".to_owned(),
    ] {
        let reply = raw(&format!("GET /api/about HTTP/1.1\r\nHost: {host}\r\n\r\n"));
        assert_eq!(reply.status, 200, "{host}");
    }
    for host in [
        "example.org",
        "localhost.example.org",
        "10.0.0.1",
        "0.0.0.0",
        "a@localhost",
    ] {
        raw(&format!("GET /api/about HTTP/1.1\r\nHost: {host}\r\n\r\n")).refuses(403, host);
    }
    raw("GET http://example.org/api/about HTTP/1.1\r\nHost: localhost\r\n\r\n")
        .refuses(403, "a proxy");
    raw("GET /api/about HTTP/1.1\r\n\r\n").refuses(400, "no host");
    raw("GET /api/about HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n")
        .refuses(400, "two hosts");
    // What is no HTTP, or too much of it.
    for (text, statuses) in [
        ("\r\n\r\nnonsense\r\n\r\n".to_owned(), [400, 400]),
        (
            "GET /\0 HTTP/1.1\r\nHost: localhost\r\n\r\n".to_owned(),
            [400, 400],
        ),
        (
            "GET / HTTP/9.9\r\nHost: localhost\r\n\r\n".to_owned(),
            [400, 505],
        ),
        (
            request("GET", &format!("/{}", "a".repeat(60_000)), &[]),
            [414, 431],
        ),
        (
            request("GET", "/", &[&format!("A: {}", "a".repeat(60_000))]),
            [431, 431],
        ),
        (request("GET", "/", &["A: a"; 1000]), [431, 431]),
        (
            request("GET", "/", &["Content-Length: 99999999999999999999"]),
            [400, 413],
        ),
    ] {
        let status = raw(&text).status;
        assert!(
            statuses.contains(&status),
            "{status}: {:?}",
            &text[..text.len().min(80)]
        );
    }
    for (path, status) in [
        ("/", 404),
        ("/api/about", 200),
        ("/files/phi.npy", 200),
        ("/nothing", 404),
    ] {
        let get = server.get(path);
        let head = raw(&request("HEAD", path, &[]));
        assert_eq!([get.status, head.status], [status; 2], "{path}");
        for name in ["content-length", "content-type"] {
            assert_eq!(get.header(name), head.header(name), "{path}");
        }
        for (name, value) in [
            ("x-content-type-options", "nosniff"),
            ("cache-control", "no-store"),
            ("cross-origin-resource-policy", "same-origin"),
        ] {
            assert_eq!(get.header(name), value, "{path}");
        }
        let policy = get.header("content-security-policy");
        assert!(
            policy.contains("default-src 'none'") && policy.contains("sandbox"),
            "{path}"
        );
        let cross = get.headers.keys().any(|k| k.starts_with("access-control"));
        assert!(!cross, "{path}");
    }
    assert_same(&before, &workspace.contents(""), "served");
    server.ends();
}

#[test]
fn what_cannot_be_served_is_said() {
    let workspace = Workspace::new();
    made_up(&workspace, "out", (3, 2, 5));
    fs::create_dir(workspace.path("other")).expect("a folder");
    workspace.write("other/notes.txt", "nothing of phicam");
    workspace.refuses("serve nowhere", &["nowhere", "cure: give the folder"]);
    workspace.refuses(
        "serve out/phi.npy",
        &["out/phi.npy", "cure: give the folder"],
    );
    workspace.refuses("serve other", &["not the folder of a run", "report.html"]);
    workspace.refuses("serve out --port 70000", &["70000"]);
    workspace.refuses("serve out --address example.org", &["example.org"]);
    let server = Server::of(&workspace, "out");
    let port = server.address().port();
    let busy = format!("serve out --port {port}");
    workspace.refuses(&busy, &[&format!("127.0.0.1:{port}"), "--port 0"]);
    // An address for documentation, which no machine has.
    workspace.refuses(
        "serve out --address 192.0.2.1",
        &["192.0.2.1:8017", "own addresses"],
    );
    assert_eq!(server.get("/api/about").status, 200);
}
