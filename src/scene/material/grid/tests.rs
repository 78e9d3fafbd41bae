use super::*;
use crate::scene::material::tests::directions;

pub(in crate::scene::material) fn written(
    theta: &[f64],
    phi: &[f64],
    f: impl Fn(f64, f64, f64) -> f64,
) -> String {
    let mut text = format!("# made for a test\n{HEADER}\n\n");
    for i in theta {
        for o in theta {
            for p in phi {
                let value = f(i.to_radians(), o.to_radians(), p.to_radians());
                text += &format!("{i}, {o}, {p}, {value:e}\n");
            }
        }
    }
    text
}

const THETA: [f64; 7] = [0.0, 11.0, 25.0, 45.0, 60.0, 80.0, 90.0];
const PHI: [f64; 5] = [0.0, 30.0, 90.0, 145.0, 180.0];

/// A spreadsheet begins its CSV files with a byte-order mark.
#[test]
fn a_byte_order_mark_is_read_over() {
    let text = written(&THETA, &PHI, |i, o, _| 0.1 + 0.01 * (i + o));
    let text = text.strip_prefix("# made for a test\n").unwrap();
    let marked = format!("\u{feff}{text}");
    assert_eq!(
        Grid::read(marked.as_bytes()).unwrap(),
        Grid::read(text.as_bytes()).unwrap()
    );
}

/// A function linear in each angle is its own multilinear interpolation.
#[test]
fn a_multilinear_function_is_given_back() {
    let f = |i: f64, o: f64, p: f64| 0.1 + 0.02 * (i + o) + 0.01 * i * o * (1.0 + 0.3 * p);
    let grid = Grid::read(written(&THETA, &PHI, f).as_bytes()).unwrap();
    for (i, o) in directions(3000) {
        let phi = (i.x * o.y - i.y * o.x).abs().atan2(i.x * o.x + i.y * o.y);
        let want = f(i.z.acos(), o.z.acos(), phi);
        assert!((grid.brdf(i, o) - want).abs() < 1e-8, "{i} {o}");
    }
}

#[test]
fn beyond_the_outermost_angles_it_is_constant() {
    let grid = Grid::read(b"theta_i,theta_o,phi,value\n30,30,90,0.25\n").unwrap();
    for (i, o) in directions(100) {
        assert_eq!(grid.brdf(i, o), 0.25);
    }
}

/// f_r = 0.3/π reflects 0.3 from everywhere; θ_i + θ_o, linear in both, 2π (θ_i/2 + π/8):
/// ∫ θ sinθ cosθ dθ over a right angle is π/8. So does a table that leaves out the outermost angles
/// of a constant.
#[test]
fn what_is_reflected_is_the_closed_form() {
    let near = |theta: &[f64], phi: &[f64], f: fn(f64, f64, f64) -> f64, share: fn(f64) -> f64| {
        let grid = Grid::read(written(theta, phi, f).as_bytes()).unwrap();
        let found = grid.albedos();
        assert_eq!(found.len(), theta.len());
        for ([degrees, found], theta) in found.into_iter().zip(theta) {
            let exact = share(theta.to_radians());
            assert!((degrees - theta).abs() < 1e-12);
            assert!((found - exact).abs() < 1e-9, "{theta}: {found} {exact}");
        }
    };
    near(&THETA, &PHI, |_, _, _| 0.3 / PI, |_| 0.3);
    near(&[10.0, 40.0], &[20.0, 50.0], |_, _, _| 0.3 / PI, |_| 0.3);
    near(
        &THETA,
        &PHI,
        |i, o, _| i + o,
        |i| 2.0 * PI * (0.5 * i + PI / 8.0),
    );
}

#[test]
fn small_differences_between_exchanged_directions_are_averaged() {
    let f = |i: f64, o: f64, _: f64| if i > o { 0.204 } else { 0.2 };
    let grid = Grid::read(written(&THETA, &PHI, f).as_bytes()).unwrap();
    for (i, o) in directions(500) {
        assert_eq!(grid.brdf(i, o), grid.brdf(o, i));
    }
}

#[test]
fn wrong_tables_are_refused_with_their_line() {
    let h = HEADER;
    for (text, cause) in [
        (String::new(), "empty"),
        ("\u{1}\n".to_owned(), "line 1"),
        ("10,10,0,0.1\n".to_owned(), "line 1: `10,10,0,0.1`"),
        (format!("{h}\n"), "no values"),
        (format!("{h}\n0,0,0\n"), "line 2"),
        (format!("{h}\n0,0,0,0.1,7\n"), "line 2"),
        (format!("{h}\n0,0,zero,0.1\n"), "line 2"),
        (format!("{h}\n0,91,0,0.1\n"), "line 2: θ_o is 91°"),
        (format!("{h}\n0,0,200,0.1\n"), "line 2: φ is 200°"),
        (
            format!("{h}\n0,0,0,0.1\n0,1.57,0,0.1\n1.57,0,0,0.1\n1.57,1.57,0,0.1\n"),
            "polar angles end at 1.57, as if they were in radians",
        ),
        (format!("{h}\n0,0,NaN,0.1\n"), "line 2: φ is NaN°"),
        (format!("{h}\n0,0,0,-0.1\n"), "line 2: a BRDF of -0.1"),
        (format!("{h}\n0,0,0,inf\n"), "line 2: a BRDF of inf"),
        (
            format!("{h}\n0,0,0,0.1\n\n-0,0,0,0.1\n"),
            "line 4: θ_i = 0, θ_o = 0, φ = 0 was stated in line 2",
        ),
        (
            format!("{h}\n0,0,0,0.1\n0,40,0,0.1\n40,0,0,0.1\n"),
            "up to the last, 4, states θ_i = 40, θ_o = 40, φ = 0",
        ),
        (
            format!("{h}\n0,0,0,0.1\n0,40,0,0.1\n40,0,0,0.2\n40,40,0,0.1\n"),
            "lines 4 and 3",
        ),
        (
            format!("{h}\n0,10,20,.1\n30,40,50,.1\n60,70,80,.1\n"),
            "make 6 × 6 × 3",
        ),
    ] {
        let fault = Grid::read(text.as_bytes()).unwrap_err();
        assert!(fault.cause.contains(cause), "{}", fault.cause);
    }
    assert!(
        Grid::read(&[0xff, 0xfe])
            .unwrap_err()
            .cause
            .contains("not text")
    );
}
