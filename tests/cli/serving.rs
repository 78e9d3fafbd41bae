//! What `phicam serve` answers, and what it does not.

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use phicam::matrix::{Matrix, npy};

use crate::server::{Server, record, request};
use crate::workspace::{Workspace, assert_same};

/// Columns, rows and spots of matrices: rows of 1040 bytes, which are read with what lies between, and of 5600 bytes.
const SHAPES: [(usize, usize, usize); 2] = [(37, 29, 130), (21, 33, 700)];

/// A run's folder `name` with made-up matrices, in which no two numbers are equal; some are not finite.
fn made_up(workspace: &Workspace, name: &str, shape: (usize, usize, usize)) -> [Matrix; 4] {
    let (columns, rows, spots) = shape;
    let folder = workspace.path(name);
    record(&folder, columns, rows, spots);
    let files = ["phi.npy", "phi.stderr.npy", "model/phi.npy", "model/z.npy"];
    [0, 1, 2, 3].map(|kind| {
        let matrix = Matrix::from_fn(columns * rows, spots, |p, s| match (p, s) {
            (3, 2) => f64::NAN,
            (4, 2) => f64::NEG_INFINITY,
            (5, 2) => -0.0,
            _ => (kind * 10_000_000 + p * 1000 + s) as f64 * 1e-15,
        });
        npy::write(&folder.join(files[kind]), &matrix).expect("written");
        matrix
    })
}

/// A sequence without a pattern, below `limit`.
fn draw(state: &mut u64, limit: usize) -> usize {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize % limit
}

/// The middle of each block of `step` of the pixels `first` to `first + length − 1`, found by listing the block.
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
            "version": "0.1.0", "scene": "made up", "pixels": [columns, rows], "spots": spots,
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
    let _ = workspace.phicam("model tiny.toml -o out").exits(0);
    let server = Server::of(&workspace, "out");
    // There is no report yet: the page is made of what is there.
    let reply = server.get("/");
    assert_eq!(reply.status, 200);
    let page = reply.text();
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
        .phicam("render tiny.toml -o out --samples 32 --seed 2")
        .exits(0);
    let second = values("traced");
    assert_eq!(second, row("out/phi.npy"));
    assert_ne!(second, first);

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
        let refused = [400, 404, 500].contains(&reply.status);
        // A link that leads to itself is the one case in which the system says more.
        let refused = refused && (reply.status != 500 || path.ends_with("loop"));
        assert!(refused, "{path}: {}", reply.status);
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

#[test]
#[cfg(unix)]
fn what_is_swapped_for_a_link_does_not_lead_out() {
    use std::os::unix::fs::symlink;
    use std::sync::atomic::{AtomicBool, Ordering};

    let workspace = Workspace::new();
    made_up(&workspace, "out", (3, 2, 5));
    fs::create_dir(workspace.path("out/inner")).expect("a folder");
    fs::create_dir(workspace.path("outer")).expect("a folder");
    workspace.write("out/inner/a.txt", "inside");
    workspace.write("outer/a.txt", "outside");
    symlink("../outer", workspace.path("out/link")).expect("a link");
    let server = Server::of(&workspace, "out");
    let done = AtomicBool::new(false);
    let [inner, link, place] =
        ["inner", "link", "place"].map(|n| workspace.path(&format!("out/{n}")));
    // Inside, refused, outside.
    let mut seen = [0; 3];
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                for from in [&inner, &link] {
                    fs::rename(from, &place).expect("swapped in");
                    fs::rename(&place, from).expect("swapped out");
                }
            }
        });
        for _ in 0..1500 {
            let reply = server.get("/files/place/a.txt");
            seen[match (reply.status, &reply.body[..]) {
                (200, b"inside") => 0,
                (404, _) => 1,
                _ => 2,
            }] += 1;
        }
        done.store(true, Ordering::Relaxed);
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
fn forged_questions_are_refused() {
    let workspace = Workspace::new();
    made_up(&workspace, "out", (30, 20, 5));
    record(&workspace.path("large"), 1030, 1, 2);
    npy::write(&workspace.path("large/phi.npy"), &Matrix::zeros(1030, 2)).expect("written");
    let server = Server::of(&workspace, "out");
    let right = "matrix=traced&spot=0&x=0&y=0&w=30&h=20&step=1";
    assert_eq!(
        server.get(&format!("/api/frame?{right}")).body.len(),
        30 * 20 * 8
    );
    let mut queries = vec![
        String::new(),
        "?".to_owned(),
        format!("?{right}&"),
        format!("?{right}&step=1"),
        format!("?{right}&z=1"),
    ];
    let huge = "9".repeat(40);
    for (pair, values) in [
        (
            "matrix=traced",
            vec!["", "phi", "../phi", "Traced", "traced%00"],
        ),
        (
            "spot=0",
            vec![
                "",
                "5",
                "-1",
                "+1",
                "NaN",
                "1e0",
                "0.0",
                "%30",
                "18446744073709551615",
                &huge,
            ],
        ),
        (
            "x=0",
            vec!["", "1", "30", "-1", "NaN", "18446744073709551615", &huge],
        ),
        ("y=0", vec!["1", "20", "18446744073709551615"]),
        (
            "w=30",
            vec!["", "0", "31", "18446744073709551615", "inf", &huge],
        ),
        ("h=20", vec!["0", "21", "18446744073709551615"]),
        ("step=1", vec!["", "0", "-1", "NaN", "0.5", &huge]),
    ] {
        let (key, _) = pair.split_once('=').expect("a pair");
        queries.push(format!(
            "?{}",
            right
                .replace(&format!("{pair}&"), "")
                .replace(&format!("&{pair}"), "")
        ));
        queries.extend(
            values
                .into_iter()
                .map(|v| format!("?{}", right.replace(pair, &format!("{key}={v}")))),
        );
    }
    for query in queries {
        server
            .get(&format!("/api/frame{query}"))
            .refuses(400, &query);
    }
    for query in [
        "",
        "?matrix=traced",
        "?pixel=0",
        "?matrix=traced&pixel=600",
        "?matrix=traced&pixel=-1",
        "?matrix=truth&pixel=0",
    ] {
        server.get(&format!("/api/row{query}")).refuses(400, query);
    }
    server.get("/api/about?x=1").refuses(400, "about");
    // A step larger than everything is one pixel.
    let one = right.replace("step=1", "step=18446744073709551615");
    assert_eq!(server.get(&format!("/api/frame?{one}")).body.len(), 8);
    server.ends();

    let server = Server::of(&workspace, "large");
    let tile = |w: usize, step: usize| {
        server.get(&format!(
            "/api/frame?matrix=traced&spot=1&x=0&y=0&w={w}&h=1&step={step}"
        ))
    };
    tile(513, 1).refuses(400, "513 columns");
    tile(1025, 2).refuses(400, "513 columns of two");
    assert_eq!(tile(512, 1).numbers().len(), 512);
    assert_eq!(tile(1024, 2).numbers().len(), 512);
}

#[test]
fn forged_files_are_refused() {
    let workspace = Workspace::new();
    made_up(&workspace, "out", (3, 2, 5));
    let server = Server::of(&workspace, "out");
    let row = || server.get("/api/row?matrix=traced&pixel=5");
    let frame = || server.get("/api/frame?matrix=traced&spot=4&x=0&y=0&w=3&h=2&step=1");
    let whole = workspace.read("out/phi.npy");
    let header = |descr: &str, fortran: &str, shape: &str| {
        let mut text =
            format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
        text += &" ".repeat(117 - text.len());
        [b"\x93NUMPY\x01\x00\x76\x00", text.as_bytes(), b"\n"].concat()
    };
    let with = |start: Vec<u8>, bytes: usize| [start, vec![7; bytes]].concat();
    let forged = [
        Vec::new(),
        b"\x93NUMPY".to_vec(),
        whole[..100].to_vec(),
        whole[..whole.len() - 1].to_vec(),
        [&whole[..], b"x"].concat(),
        b"PK\x03\x04 not one".repeat(40),
        with(header("<f8", "False", "(5, 6)"), 240),
        with(header("<f8", "False", "(30,)"), 240),
        with(header("<f8", "False", "(6, 5)"), 232),
        with(header("<f8", "True", "(6, 5)"), 240),
        with(header(">f8", "False", "(6, 5)"), 240),
        with(header("<f4", "False", "(6, 5)"), 120),
        with(header("<i8", "False", "(6, 5)"), 240),
        with(header("|O", "False", "(6, 5)"), 240),
        with(header("<f8", "False", "(4294967296, 4294967296)"), 240),
        with(header("<f8", "False", "(-6, -5)"), 240),
        with(header("<f8", "False", "(0, 5)"), 0),
        with(header("<f8", "False", "((((((((((6, 5))))))))))"), 240),
        with(b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec(), 4000),
    ];
    for (n, bytes) in forged.iter().enumerate() {
        workspace.write("out/phi.npy", bytes);
        for reply in [row(), frame()] {
            reply.refuses(500, &format!("forgery {n}"));
            assert!(reply.text().contains("phi.npy"), "{}", reply.text());
        }
        let about: serde_json::Value =
            serde_json::from_slice(&server.get("/api/about").body).expect("JSON");
        assert_eq!(
            about["matrices"],
            serde_json::json!(["stderr", "modelled", "z"]),
            "forgery {n}"
        );
    }
    fs::remove_file(workspace.path("out/phi.npy")).expect("removed");
    row().refuses(404, "no matrix");
    workspace.write("out/phi.npy", &whole);
    assert_eq!(row().numbers().len(), 5);

    let record_text = workspace.text("out/run.json");
    let with = |old: &str, new: &str| record_text.replace(old, new);
    for text in [
        String::new(),
        "{}".to_owned(),
        "[".repeat(100_000),
        with("[3,2]", "[18446744073709551615,18446744073709551615]"),
        with("[3,2]", "[4294967296,4294967296]"),
        with("[3,2]", "[-3,2]"),
        with("[3,2]", "[1e300,2]"),
        with("[3,2]", "[3]"),
        with("[3,2]", "[3,3]"),
        with("\"spots\":5", "\"spots\":18446744073709551615"),
        " ".repeat(3 << 20) + &record_text,
    ] {
        assert_ne!(text, record_text);
        workspace.write("out/run.json", &text);
        row().refuses(500, &text[..text.len().min(300)]);
    }
    fs::remove_file(workspace.path("out/run.json")).expect("removed");
    row().refuses(404, "no record");
    server.get("/api/about").refuses(404, "no record");

    // The longest row, and one more; the file is all holes.
    for (spots, status) in [(1_000_000, 200), (1_000_001, 400)] {
        record(&workspace.path("out"), 1, 1, spots);
        let mut file = File::create(workspace.path("out/phi.npy")).expect("a file");
        file.write_all(&header("<f8", "False", &format!("(1, {spots})")))
            .expect("written");
        file.set_len(128 + 8 * spots as u64).expect("longer");
        let reply = server.get("/api/row?matrix=traced&pixel=0");
        assert_eq!(reply.status, status);
        assert!(status != 200 || reply.numbers() == vec![0; spots]);
    }
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
