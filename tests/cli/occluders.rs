//! What stands between object and wall: its study, and what a misplaced one does.

use phicam::matrix::Matrix;

use crate::small_scene::{SMALL, TINY, altered};
use crate::workspace::Workspace;

/// The hidden surface of the bench, and its albedo.
const BOARD: [&str; 2] = [
    "rectangle = { corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }",
    "material = { lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 } }",
];
/// Elements along u and v of the board.
const SIDE: usize = 3;

/// A black plate between the view and the board, its lower left corner at (x, y, z).
fn plate([x, y, z]: [f64; 3], side: f64, albedo: f64) -> String {
    format!(
        "\n[[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
         rectangle = {{ corner = [{x:?}, {y:?}, {z:?}], u = [{side:?}, 0, 0], v = [0, {side:?}, 0] }}\n\
         material = {{ lambertian = {albedo:?} }}\n"
    )
}

/// Where `study occluder` begins: around the line from the middle of the view to that of the board,
/// 0.36 of the way.
fn begun(side: f64) -> [f64; 3] {
    let (view, board) = (
        [4.875, 4.375, 0.0],
        [5.0, 9.936738404065472, 5.563261595934528],
    );
    let middle = |d: usize| view[d] + 0.36 * (board[d] - view[d]);
    [middle(0) - 0.5 * side, middle(1) - 0.5 * side, middle(2)]
}

/// Traced light of each of the board's elements alone, white, past `surfaces`: one after the other
/// the columns of the linear map from reflectances to Φcam, all entries of each.
fn traced_columns(workspace: &Workspace, surfaces: &str) -> Matrix {
    let element = |j: usize| {
        let part = 1.0 / SIDE as f64;
        let [iu, iv] = [j % SIDE, j / SIDE].map(|k| k as f64 * part);
        let tilt = 2.0 * std::f64::consts::SQRT_2;
        let corner = [
            3.0 + 4.0 * iu,
            11.350951966438567 - tilt * iv,
            4.149048033561433 + tilt * iv,
        ];
        let one = format!(
            "rectangle = {{ corner = {corner:?}, u = [{:?}, 0, 0], v = [0, {:?}, {:?}] }}",
            4.0 * part,
            -tilt * part,
            tilt * part
        );
        let white = [
            (BOARD[0], one.as_str()),
            (BOARD[1], "material = { lambertian = 1.0 }"),
        ];
        let name = format!("element-{j}");
        let scene = altered(TINY.iter().chain(&white)) + surfaces;
        workspace.write(&format!("{name}.toml"), scene);
        let line = format!("render {name}.toml -o {name} --replace --estimator factored");
        let _ = workspace
            .phicam(&format!("{line} --samples 2048 -q"))
            .exits(0);
        workspace.matrix(&format!("{name}/phi.npy"))
    };
    let columns: Vec<Matrix> = (0..SIDE * SIDE).map(element).collect();
    Matrix::from_fn(columns[0].len(), columns.len(), |entry, j| {
        columns[j][entry]
    })
}

/// Directions of a prior ½ ± ½ whose signal is above 10 %, 1 % and 0.1 % of the grey surface's
/// light, and the share of the prior's variance that is left at 1 %: (1/n) Σ_i 1/(1 + (s_i/0.01)²),
/// s_i half the singular values of what each element adds over the light of all of them, half as
/// bright.
fn known(columns: &Matrix) -> ([usize; 3], f64) {
    let grey: Vec<f64> = columns.row_iter().map(|row| 0.5 * row.sum()).collect();
    let (entries, elements) = columns.shape();
    let relative = Matrix::from_fn(entries, elements, |e, j| columns[(e, j)] / grey[e]);
    let signal = relative.singular_values() * 0.5;
    let above = |level: f64| signal.iter().filter(|s| **s > level).count();
    let left = |s: &f64| 1.0 / (1.0 + (s / 0.01).powi(2));
    let risk = signal.iter().map(left).sum::<f64>() / elements as f64;
    ([0.1, 0.01, 1e-3].map(above), risk)
}

/// Directions above a noise and the Bayes risk are those of light that was traced element by
/// element, past nothing and past a plate; a plate too small to be in the way is as nothing; plate
/// and mask tell more than nothing does, from photographs through a sensor too.
#[test]
fn the_study_counts_what_traced_light_tells() {
    let workspace = Workspace::with_scenes();
    let line = "study occluder tiny.toml --elements 3 --search 0 --boards 3 --draws 2 --json";
    let line = format!("{line} --misplaced 0.1 --samples 1024 --frames 4");
    let study = |options: &str| -> serde_json::Value {
        let ended = workspace.phicam(&format!("{line} {options}")).exits(0);
        serde_json::from_str(&ended.stdout).unwrap()
    };
    let found = study("-o o --kinds none,plate,random");
    assert_eq!(found, workspace.json("o/occluder.json"));
    let speck = study("-o p --kinds plate --size 1e-6");
    let as_traced = |row: &serde_json::Value, columns: &Matrix, most: f64| {
        let (above, risk) = known(columns);
        let told = row["directions"].as_array().unwrap()[..3].iter();
        let told: Vec<u64> = told.map(|n| n.as_u64().unwrap()).collect();
        assert_eq!(told, above.map(|n| n as u64), "{row}");
        let told = row["risk"].as_f64().unwrap();
        assert!((told / risk - 1.0).abs() < most, "{told}, traced {risk}");
    };
    let rows = found["rows"].as_array().unwrap();
    let free = traced_columns(&workspace, "");
    // With nothing in the way at all the study's elements are points: of 3 × 3 that is 2 %.
    as_traced(&rows[0], &free, 0.05);
    as_traced(&speck["rows"][0], &free, 0.01);
    let plate = plate(begun(1.0), 1.0, 0.0);
    as_traced(&rows[1], &traced_columns(&workspace, &plate), 0.01);
    let number = |row: usize, at: &str| rows[row].pointer(at).unwrap().as_f64().unwrap();
    for better in [1, 2] {
        assert!(
            number(better, "/risk") < 0.2 * number(0, "/risk"),
            "{found}"
        );
        assert!(
            number(better, "/limits/0") > 10.0 * number(0, "/limits/0"),
            "{found}"
        );
        let seen = "/seen/0/recovery/likeness";
        assert!(number(better, seen) > number(0, seen) + 0.3, "{found}");
        assert!(number(better, "/misplaced/0/recovery/p") < 1e-6, "{found}");
    }
    assert_eq!(rows[0]["misplaced"].as_array().unwrap().len(), 0);
    for (table, lines) in [("occluder", 4), ("traced", 4), ("misplaced", 3)] {
        let text = workspace.text(&format!("o/{table}.csv"));
        assert_eq!(text.lines().count(), lines, "{text}");
    }
    assert!(workspace.text("o/occluder.svg").contains("random, 8 spots"));
    let page = workspace.text("o/report.html");
    for words in ["of the variance at a noise of", "download=\"traced.csv\""] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn what_no_study_of_occluders_is_is_refused() {
    let workspace = Workspace::with_scenes();
    for (option, words) in [
        ("--spots 9", ["--spots 9", "8"]),
        ("--kinds grid", ["grid", "mura"]),
        ("--level 0", ["--level", "cure"]),
        ("--height 1", ["--height", "between"]),
        ("--size 0", ["--size", "length"]),
        ("--boards 1", ["--boards", "2"]),
    ] {
        workspace.refuses(&format!("study occluder tiny.toml -o o {option}"), &words);
    }
    let ended = workspace.phicam("study occluder furnace -o o").exits(2);
    assert!(ended.stderr.contains("hidden"), "{}", ended.account());
}

/// Traced photographs past a plate, recovered with the plate where it stood and a tenth of its side
/// away: the picture is there, then spoilt, and the fit says so.
#[test]
fn a_misplaced_occluder_does_not_fit() {
    let few = [
        ("pixels = [16, 16]", "pixels = [4, 4]"),
        ("per_side = 30", "per_side = 3"),
    ];
    let workspace = Workspace::new();
    let at = begun(1.0);
    workspace.write("bench.toml", altered(&few) + &plate(at, 1.0, 0.0));
    for line in [
        "render bench.toml -o run --estimator factored --samples 4096",
        "expose run --sensor machine-vision --exposure 0.002 --frames 16",
    ] {
        let _ = workspace.phicam(line).exits(0);
    }
    let recovered = |x: f64, code: i32| -> serde_json::Value {
        let folder = format!("at-{x}");
        std::fs::create_dir(workspace.path(&folder)).unwrap();
        let scene = altered(&few) + &plate([x, at[1], at[2]], 1.0, 0.0);
        workspace.write(&format!("{folder}/scene.toml"), scene);
        let files = "--phi run/exposed/phi.npy --stderr run/exposed/phi.stderr.npy";
        let line = format!("recover {folder} {files} --method joint --json");
        serde_json::from_str(&workspace.phicam(&line).exits(code).stdout).unwrap()
    };
    let modulation = |found: &serde_json::Value| found[0]["mtf_raw"].as_f64().unwrap();
    let right = recovered(at[0], 0);
    assert_eq!(right[0]["fit"]["fits"], true, "{right}");
    assert!(modulation(&right) > 0.9, "{right}");
    let wrong = recovered(at[0] + 0.1, 1);
    assert_eq!(wrong[0]["fit"]["fits"], false, "{wrong}");
    assert!(
        wrong[0]["warnings"]
            .to_string()
            .contains("DOES NOT FIT, by any method"),
        "{wrong}"
    );
    assert!(
        modulation(&wrong) < modulation(&right) - 0.1,
        "{right} {wrong}"
    );
}

/// Errors against the quadrature fall as those of random numbers do, past a plate too; an occluder
/// that reflects is refused, for its light is in no quadrature.
#[test]
fn errors_fall_past_an_occluder_as_past_nothing() {
    let workspace = Workspace::new();
    workspace.write("plate.toml", altered(&SMALL) + &plate(begun(1.0), 1.0, 0.0));
    workspace.write("grey.toml", altered(&SMALL) + &plate(begun(1.0), 1.0, 0.3));
    let line = "study convergence plate.toml -o c --samples 64,256,1024 --json";
    let json: serde_json::Value =
        serde_json::from_str(&workspace.phicam(line).exits(0).stdout).unwrap();
    let own = &json["curves"][0];
    assert_eq!([&own["estimator"], &own["sampler"]], ["independent", "pcg"]);
    // Over 1536 entries each error is known to 1.8 %, the slope over ln 16 to 0.01.
    let slope = own["slope"].as_f64().unwrap();
    assert!((slope + 0.5).abs() < 0.05, "{json}");
    // What the quadrature may be off by is stated, and does not matter for these errors.
    let bound = json["quadrature_bound"].as_f64().unwrap();
    assert!(bound > 0.0 && bound < 1e-2, "{json}");
    assert!(own["slope_bound"].as_f64().unwrap() < 0.1, "{json}");
    let page = workspace.text("c/report.html");
    assert!(page.contains("± by the quadrature") && page.contains("own bound is"));
    workspace.refuses(
        "study convergence grey.toml -o d --samples 64,256",
        &["an occluder reflects", "lambertian = 0"],
    );
}
