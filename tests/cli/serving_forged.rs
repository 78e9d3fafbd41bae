//! Files and questions made to mislead `phicam serve`.

use std::fs::{self, File};
use std::io::Write;

use phicam::matrix::{Matrix, npy};

use crate::server::{Server, made_up, record};
use crate::workspace::Workspace;

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
        with(header("<f8", "Maybe\n\n\n", "(6, 5)"), 240),
        with(header("<f8", "False", "\n(6\n\r\x1b[2J, 5"), 240),
        with(header("<\nf8", "False", "(6, 5)"), 240),
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
        " ".repeat(65 << 20) + &record_text,
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
