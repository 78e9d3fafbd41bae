use super::*;

fn layout(text: &str) -> Result<Vec<[f64; 2]>, Fault> {
    places(&toml::from_str(text).unwrap())
}

/// The published order and offsets: o(i) = 0, −1, +1 for i mod 3 = 0, 1, 2, i from 1 along each
/// side.
#[test]
fn the_square_is_the_published_one() {
    let spots = layout(
        "layout = 'square'\ncentre = [5, 4]\nhalf_width = 6\nper_side = 30\nstagger = [-1, 1, 0]",
    )
    .unwrap();
    assert_eq!(spots.len(), 120);
    let (h, n) = (6.0, 30usize);
    let xs = |i: usize| 5.0 - h + 2.0 * h * (i as f64 - 1.0) / (n as f64 - 1.0);
    let ys = |i: usize| 4.0 + h - 2.0 * h * (i as f64 - 1.0) / (n as f64 - 1.0);
    let o = |i: usize| [0.0, -1.0, 1.0][i % 3];
    for i in 1..=n {
        let published = [
            [xs(i), 4.0 - h + o(i)],
            [5.0 + h + o(i), ys(n + 1 - i)],
            [xs(n + 1 - i), 4.0 + h + o(i)],
            [5.0 - h + o(i), ys(i)],
        ];
        for (side, want) in published.iter().enumerate() {
            let got = spots[side * n + i - 1];
            assert!((got[0] - want[0]).abs() < 1e-12 && (got[1] - want[1]).abs() < 1e-12);
        }
    }
}

#[test]
fn the_other_layouts_are_where_they_should_be() {
    let grid = layout("layout = 'grid'\ncentre = [1, 2]\nhalf_width = 1\nper_side = 3").unwrap();
    assert_eq!(
        (grid.len(), grid[0], grid[1], grid[8]),
        (9, [0.0, 1.0], [1.0, 1.0], [2.0, 3.0])
    );
    let ring = layout("layout = 'ring'\ncentre = [1, 2]\nradius = 2\ncount = 4").unwrap();
    for (got, want) in ring
        .iter()
        .zip([[3.0, 2.0], [1.0, 4.0], [-1.0, 2.0], [1.0, 0.0]])
    {
        assert!((got[0] - want[0]).abs() < 1e-12 && (got[1] - want[1]).abs() < 1e-12);
    }
    let lines = layout(
        "layout = 'lines'\nstagger = [0, 0.5]\nlines = [{ from = [0, 0], to = [4, 0], count = 3 }]",
    )
    .unwrap();
    assert_eq!(lines, [[0.0, 0.0], [2.0, 0.5], [4.0, 0.0]]);
    let text = "layout = 'random'\ncentre = [1, 2]\nhalf_width = 3\ncount = 50\nseed = 4";
    let random = layout(text).unwrap();
    assert_eq!(random, layout(text).unwrap());
    assert!(
        random
            .iter()
            .all(|p| (p[0] - 1.0).abs() <= 3.0 && (p[1] - 2.0).abs() <= 3.0)
    );
    assert_eq!(
        layout("layout = 'list'\npoints = [[1, 2]]").unwrap(),
        [[1.0, 2.0]]
    );
}

#[test]
fn nonsense_is_refused_with_its_key() {
    for (text, word) in [
        (
            "layout = 'square'\ncentre = [1, 2]\nhalf_width = 1",
            "per_side",
        ),
        (
            "layout = 'square'\ncentre = [1, 2]\nhalf_width = 1\nper_side = 1",
            "per_side",
        ),
        (
            "layout = 'square'\ncentre = [1, 2]\nhalf_width = -1\nper_side = 4",
            "half_width",
        ),
        (
            "layout = 'square'\ncentre = [nan, 2]\nhalf_width = 1\nper_side = 4",
            "finite",
        ),
        ("layout = 'list'\npoints = []", "no spot"),
        ("layout = 'list'\npoints = [[1, 2]]\nseed = 3", "seed"),
        (
            "layout = 'grid'\ncentre = [1, 2]\nhalf_width = 1\nper_side = 4000000000",
            "per_side",
        ),
        (
            "layout = 'lines'\nlines = [{ from = [0, 0], to = [0, 0], count = 3 }]",
            "length",
        ),
    ] {
        let fault = layout(text).unwrap_err();
        assert!(fault.cause.contains(word), "{text}: {}", fault.cause);
    }
}
