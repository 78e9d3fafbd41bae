//! `phicam view` and `phicam scene view`.

use phicam::image::{Channel, Image, decode};

use crate::workspace::Workspace;

const FRAME: &str = "done/frames/spot-0003.exr";

fn with_run() -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 32")
        .exits(0);
    workspace
}

/// A PNG of the workspace, decoded.
fn picture(workspace: &Workspace, name: &str) -> Image {
    let image = decode(name, &workspace.read(name)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        image.channels,
        [Channel::Red, Channel::Green, Channel::Blue]
    );
    image
}

/// The colour at a pixel from the upper left corner.
fn at(image: &Image, x: usize, y: usize) -> [f32; 3] {
    let values = &image.values[3 * (x + y * image.width)..];
    [values[0], values[1], values[2]]
}

/// The 3 × 2 pixels of a frame on a grey scale from 0 to the largest: each is its share of that,
/// row 0 at the bottom.
#[test]
fn a_frame_is_shown_as_the_camera_sees_it() {
    let workspace = with_run();
    let ended = workspace
        .phicam(&format!(
            "view {FRAME} -o bare.png --bare --map grey --exposure 0"
        ))
        .exits(0);
    assert_eq!(ended.stdout, "", "{}", ended.account());
    let image = picture(&workspace, "bare.png");
    let side = image.width / 3;
    assert_eq!([image.width, image.height], [3 * side, 2 * side]);
    let phi = workspace.matrix("done/phi.npy");
    let spot = phi.column(3);
    let largest = spot.max();
    for pixel in 0..6 {
        let [column, row] = [pixel % 3, pixel / 3];
        let [r, g, b] = at(
            &image,
            column * side + side / 2,
            (1 - row) * side + side / 2,
        );
        let want = spot[pixel] / largest;
        assert!(
            r == g && g == b && (f64::from(r) - want).abs() < 0.5 / 255.0 + 1e-6,
            "{pixel}: {r} {want}"
        );
    }
    // The same column of the matrix is the same picture.
    let _ = workspace
        .phicam("view done/phi.npy --spot 3 -o column.png --bare --map grey --exposure 0")
        .exits(0);
    assert_eq!(workspace.read("column.png"), workspace.read("bare.png"));
}

#[test]
fn without_a_terminal_the_picture_goes_beside_the_file() {
    let workspace = with_run();
    let ended = workspace.phicam(&format!("view {FRAME}")).exits(0);
    assert_eq!(ended.stdout, "", "{}", ended.account());
    assert!(
        ended.stderr.contains("spot-0003.exr.png"),
        "{}",
        ended.account()
    );
    assert!(picture(&workspace, &format!("{FRAME}.png")).width > 600);
    // One EV more halves the scale's end: the largest value at least is above.
    let ended = workspace
        .phicam(&format!(
            "view {FRAME} --exposure 1 --channel flux.stderr --force"
        ))
        .exits(0);
    assert!(
        ended.stderr.contains("of 6 values above"),
        "{}",
        ended.account()
    );
    let ended = workspace.phicam("view done/phi.npy --scale log").exits(0);
    assert!(ended.stderr.contains("phi.npy.png"), "{}", ended.account());
}

#[test]
fn in_a_terminal_the_legend_is_text() {
    let workspace = with_run();
    let before = workspace.contents("");
    let ended = workspace
        .phicam(&format!("view {FRAME} --terminal=blocks --range 0,1e-30"))
        .exits(0);
    assert!(
        ended.stdout.contains('▀') && ended.stdout.contains("\x1b[38;2;"),
        "{}",
        ended.account()
    );
    assert!(
        ended.stdout.contains("orange: 6 of 6 values above") && ended.stdout.contains(" W\n"),
        "{}",
        ended.account()
    );
    for (how, start) in [
        ("kitty", "\x1b_Ga=T,f=100"),
        ("iterm", "\x1b]1337;File=inline=1"),
    ] {
        let ended = workspace
            .phicam(&format!("view {FRAME} --terminal={how}"))
            .exits(0);
        assert!(ended.stdout.starts_with(start), "{how}");
    }
    assert!(before == workspace.contents(""), "a file was written");
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let workspace = with_run();
    workspace.refuses(
        &format!("view {FRAME} --channel blue"),
        &["no channel `blue`", "flux", "flux.stderr"],
    );
    workspace.refuses(&format!("view {FRAME} --spot 1"), &["no matrix", "--spot"]);
    workspace.refuses("view done/phi.npy --spot 8", &["no spot 8", "0 to 7"]);
    workspace.refuses("view done/phi.npy --channel flux", &["no channels"]);
    workspace.refuses("view nothing.exr", &["nothing.exr", "check"]);
    workspace.refuses("view tiny.toml", &["neither OpenEXR nor .npy"]);
    workspace.refuses(&format!("view {FRAME} --range 2,1"), &["LOW,HIGH"]);
    workspace.refuses(
        &format!("view {FRAME} --range 0,1 --scale log"),
        &["LOW above 0"],
    );
    workspace.write("lonely.npy", workspace.read("done/phi.npy"));
    workspace.refuses("view lonely.npy --spot 0", &["lonely.npy", "run.json"]);
}

/// A gigabyte is not read to see that it is no picture, or too large a one.
#[cfg(target_os = "linux")]
#[test]
fn what_is_large_is_refused_by_its_first_bytes() {
    let workspace = with_run();
    for (start, words) in [
        (vec![0], "neither OpenEXR nor .npy"),
        (workspace.read(FRAME), "may be taken"),
    ] {
        workspace.write("large.exr", start);
        let path = workspace.path("large.exr");
        let file = std::fs::File::options().write(true).open(path).unwrap();
        file.set_len(1_000_000_000).unwrap();
        let ended = workspace.answers("view large.exr -o seen.png").exits(2);
        let told = ended.stderr.contains("large.exr") && ended.stderr.contains(words);
        assert!(told, "{}", ended.account());
    }
}

#[test]
fn a_scene_is_drawn_in_the_size_that_is_asked_for() {
    let workspace = Workspace::with_scenes();
    let ended = workspace
        .phicam("scene view bench -o bench.png --size 60,40 --samples 4")
        .exits(0);
    assert!(ended.stderr.contains("--from"), "{}", ended.account());
    let image = picture(&workspace, "bench.png");
    assert_eq!([image.width, image.height], [60, 40]);
    // From straight before the wall, whose albedo is even, its lower left corner in the middle:
    // grey to the upper right, backdrop (bluish) elsewhere.
    let _ = workspace
        .phicam("scene view bench -o corner.png --size 60,40 --samples 4 --from=0,0,9 --to=0,0,0 --mark=no")
        .exits(0);
    let image = picture(&workspace, "corner.png");
    let [r, _, b] = at(&image, 45, 10);
    assert!((r - b).abs() < 0.01 && r > 0.3, "{r} {b}");
    for (x, y) in [(15, 10), (15, 30), (45, 30)] {
        let [r, _, b] = at(&image, x, y);
        assert!(b - r > 0.02, "{x} {y}: {r} {b}");
    }
}

#[test]
fn a_place_without_a_view_is_refused() {
    let workspace = Workspace::new();
    let view = |more: &str| format!("scene view bench -o view.png {more}");
    workspace.refuses(
        &view("--from 1,2,3 --to 1,2,3"),
        &["cannot look at", "two different"],
    );
    workspace.refuses(&view("--from 0,9,0 --to 0,0,0"), &["cannot point up"]);
    workspace.refuses(&view("--fov 180"), &["180 degrees"]);
    workspace.refuses(&view("--size 0,9"), &["W,H"]);
    workspace.refuses(&view("--from 1,2"), &["X,Y,Z"]);
    workspace.refuses("scene view nowhere -o view.png", &["nowhere"]);
}
