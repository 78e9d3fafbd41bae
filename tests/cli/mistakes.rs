//! Mistakes that somebody makes who is new to the program, and what each is answered with.

use crate::workspace::Workspace;

/// Command line, and what must stand in the message: the cause, and the cure. `tiny.toml` is a
/// scene, `done` a finished run of it, `plain.txt` an empty file.
const MISTAKES: &[(&str, &[&str])] = &[
    // Words in the wrong place.
    (
        "run tiny.toml new",
        &["unexpected argument 'new'", "cure: ", "-o new"],
    ),
    (
        "render tiny.toml new",
        &["unexpected argument 'new'", "-o new"],
    ),
    (
        "run -o new tiny.toml small.toml",
        &["'small.toml'", "cure: "],
    ),
    (
        "run tiny.toml -o new --occlusion off",
        &["'off'", "--occlusion takes no value"],
    ),
    (
        "validate tiny.toml done",
        &[
            "'done'",
            "takes the folder of a run",
            "`phicam validate done`",
        ],
    ),
    (
        "run tiny.toml -o new D camera.pixels=[4,4]",
        &["unexpected argument", "cure: "],
    ),
    ("render tiny.toml", &["--output", "cure: ", "-o FOLDER"]),
    ("model tiny.toml", &["--output", "-o FOLDER"]),
    ("render -o new", &["<SCENE>", "phicam scene list"]),
    ("recover", &["<DIR>", "`phicam recover out`"]),
    // Commands.
    ("rum tiny.toml", &["'rum'", "run"]),
    ("guide", &["'guide'", "src/cli/guide", "phicam help scene"]),
    ("bench", &["'bench'", "`phicam run bench`"]),
    ("tiny.toml", &["'tiny.toml'", "`phicam run tiny.toml`"]),
    ("noise bench", &["'noise'", "`phicam study noise`"]),
    ("check tiny.toml", &["'check'", "`phicam scene check`"]),
    ("scene chekc tiny.toml", &["'chekc'", "check"]),
    ("study nois tiny.toml", &["'nois'", "noise"]),
    // Scenes.
    (
        "run tiny -o new",
        &["tiny", "did you mean the file `tiny.toml`"],
    ),
    (
        "run bensh -o new",
        &["bensh", "did you mean the built-in scene `bench`"],
    ),
    (
        "run bench.toml -o new",
        &["bench.toml", "built-in scene `bench`"],
    ),
    (
        "run nowhere.toml -o new",
        &["nowhere.toml", "cure: ", "bench, thesis"],
    ),
    ("run done -o new", &["folder", "done/scene.toml"]),
    ("scene check done", &["folder", "done/scene.toml"]),
    (
        "run plain.txt -o new",
        &["plain.txt", "missing field", "phicam help scene"],
    ),
    // Folders.
    (
        "validate tiny.toml",
        &[
            "tiny.toml",
            "that is a scene",
            "`phicam run tiny.toml -o out`",
        ],
    ),
    (
        "validate bench",
        &["bench", "that is a scene", "`phicam run bench -o out`"],
    ),
    ("recover tiny.toml", &["that is a scene", "phicam run"]),
    (
        "recover done/phi.npy",
        &["done/phi.npy", "give its folder: `done`"],
    ),
    (
        "stack nowhere",
        &["nowhere", "give the output folder of a run"],
    ),
    ("expose tiny.toml", &["that is a scene", "phicam run"]),
    ("locate bench", &["that is a scene", "phicam run"]),
    (
        "run tiny.toml -o plain.txt",
        &["plain.txt is a file, not a folder", "another output folder"],
    ),
    ("run tiny.toml --output=", &["--output", "value"]),
    (
        "scene show tiny.toml -o nowhere/deep.svg",
        &["nowhere", "folder"],
    ),
    // Options of other commands, and misspelled ones.
    (
        "run tiny.toml -o new --elements 8x8",
        &["--elements", "`phicam model`", "`phicam recover`"],
    ),
    ("recover done --samples 100", &["--samples", "`phicam run`"]),
    (
        "render tiny.toml -o new --method pinv",
        &["--method", "`phicam recover`"],
    ),
    (
        "run tiny.toml -o new --sample 64",
        &["--sample", "--samples"],
    ),
    ("recover done --methods pinv", &["--methods", "--method"]),
    ("recover done --method pinvv", &["pinvv", "pinv"]),
    (
        "run tiny.toml -o new --estimator factord",
        &["factord", "factored"],
    ),
    (
        "run tiny.toml -o new --kernel thesis",
        &["thesis", "physical, published"],
    ),
    // Numbers.
    (
        "render tiny.toml -o new --spots 5-10",
        &["5-10", "5..11", "A..B"],
    ),
    ("render tiny.toml -o new --spots 5..2", &["5..2", "A < B"]),
    (
        "run tiny.toml -o new --samples 0",
        &["--samples 0", "at least 1"],
    ),
    (
        "run tiny.toml -o new --samples 1.5",
        &["1.5", "--samples", "whole number", "1e4"],
    ),
    (
        "run tiny.toml -o new --samples -5",
        &["-5", "--samples", "whole number"],
    ),
    (
        "run tiny.toml -o new --seed abc",
        &["abc", "--seed", "whole number"],
    ),
    (
        "run tiny.toml -o new --threads 0",
        &["--threads", "1 to 4096"],
    ),
    (
        "run tiny.toml -o new --threads all",
        &["all", "--threads", "whole number"],
    ),
    (
        "model tiny.toml -o new --elements 8,8",
        &["8,8", "--elements", "8x6"],
    ),
    (
        "expose done --exposure 5mW",
        &["5mW", "--exposure", "seconds", "100ms"],
    ),
    (
        "expose done --frames 2.5",
        &["2.5", "--frames", "whole number"],
    ),
    ("expose done --sensor nikon", &["nikon", "ideal, ccd, dslr"]),
    ("validate done --significance 5%", &["5%", "--significance"]),
    ("validate done --shift-spots 1", &["--shift-spots", "DX,DY"]),
    ("locate done --range 2..1", &["2..1", "LOW below HIGH"]),
    (
        "study noise tiny.toml -o new --noise 0.01..0.1",
        &["0.01..0.1", "--noise", "separated by commas"],
    ),
    (
        "study power tiny.toml -o new --samples 1.5",
        &["1.5", "whole number"],
    ),
    // Keys of the scene.
    (
        "run tiny.toml -o new -D camera.pixel=[4,4]",
        &[
            "`pixel`",
            "did you mean `pixels`",
            "phicam help scene camera.pixels",
        ],
    ),
    (
        "run tiny.toml -o new -D camera.pixels",
        &["camera.pixels", "KEY=VALUE"],
    ),
    (
        "run tiny.toml -o new --also-read absent",
        &["'absent'", "--also-read", "no such folder"],
    ),
    (
        "run tiny.toml -o new -D camera.pixels=4",
        &["pixels", "2 whole numbers"],
    ),
    (
        "run tiny.toml -o new -D laser.power=5mm",
        &["a length", "a power", "mW"],
    ),
    (
        "run tiny.toml -o new -D laser.power=strong",
        &["\"strong\"", "number, W", "phicam help scene laser.power"],
    ),
    (
        "run tiny.toml -o new -D surface.wal.sides=two",
        &["`wal`", "wall"],
    ),
    (
        "run tiny.toml -o new -D surface.wall.material.lambertian=1.5",
        &["1.5", "phicam help scene surface.material.lambertian"],
    ),
    (
        "recover done -D camera.pixels=[4,4]",
        &["camera.pixels", "render it with -D"],
    ),
    (
        "help scene camera.vew",
        &["camera.vew", "phicam help scene camera.view"],
    ),
    ("help scene zzzzzzzz", &["zzzzzzzz", "lists all keys"]),
    // What the new commands take.
    ("new tiny", &["tiny.toml is there already", "--force"]),
    ("new mine --from bensh", &["bensh", "bench"]),
    ("completions tcsh", &["tcsh", "bash"]),
    ("help nonsense", &["'nonsense'", "`phicam --help`"]),
    (
        "scene show tiny.toml -o tiny.png",
        &["be svg", "name it tiny.svg"],
    ),
    ("target edge -o edge.jpg", &["be png", "name it edge.png"]),
    (
        "validate done --shift-spots 100,0",
        &["--shift-spots 100,0", "every spot on the wall"],
    ),
    (
        "recover done --laser-side d.npy --phi done/phi.npy",
        &["--camera-side", "`--camera-side C.npy`"],
    ),
    ("man plain.txt", &["plain.txt is a file, not a folder"]),
];

#[test]
fn every_mistake_is_answered_with_cause_and_cure_and_nothing_is_written() {
    let workspace = Workspace::with_scenes();
    workspace.write("plain.txt", "");
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    for (line, words) in MISTAKES {
        workspace.refuses(line, words);
    }
}
