use std::io;
use std::sync::Mutex;

use indicatif::TermLike;

use super::*;

/// A terminal that remembers what was drawn last.
#[derive(Clone, Debug)]
struct Paper {
    width: u16,
    written: Arc<Mutex<String>>,
}

impl TermLike for Paper {
    fn width(&self) -> u16 {
        self.width
    }
    /// Before anything is drawn.
    fn move_cursor_up(&self, _: usize) -> io::Result<()> {
        self.written.lock().unwrap().clear();
        Ok(())
    }
    fn move_cursor_down(&self, _: usize) -> io::Result<()> {
        Ok(())
    }
    fn move_cursor_right(&self, _: usize) -> io::Result<()> {
        Ok(())
    }
    fn move_cursor_left(&self, _: usize) -> io::Result<()> {
        Ok(())
    }
    fn write_line(&self, line: &str) -> io::Result<()> {
        self.write_str(&format!("{line}\n"))
    }
    fn write_str(&self, text: &str) -> io::Result<()> {
        self.written.lock().unwrap().push_str(text);
        Ok(())
    }
    fn clear_line(&self) -> io::Result<()> {
        Ok(())
    }
    fn flush(&self) -> io::Result<()> {
        Ok(())
    }
}

/// The two lines of a bar at `done` of 1000 after some time, on a terminal so wide.
fn drawn(width: u16, words: &str, done: u64, rate: &'static str) -> Vec<String> {
    let paper = Paper {
        width,
        written: Arc::default(),
    };
    let target = ProgressDrawTarget::term_like(Box::new(paper.clone()));
    let bar = ProgressBar::with_draw_target(Some(1000), target);
    bar.set_style(style(move |_, w| w.write_str(rate).unwrap()).unwrap());
    bar.set_message(shortened(words));
    bar.set_position(done);
    bar.force_draw();
    let text: Vec<char> = paper.written.lock().unwrap().chars().collect();
    // Every line is filled up with blanks.
    let lines = text.chunks(usize::from(width)).map(String::from_iter);
    lines.map(|l| l.trim_end().to_owned()).collect()
}

#[test]
fn a_bar_fits_into_forty_columns_and_fills_eighty() {
    let rate = "13.1 M samples/s, standard error 0.093 %";
    let name = "tracing a scene with a long name";
    for (width, words) in [(40, "tracing bench"), (80, "tracing bench"), (40, name)] {
        let lines = drawn(width, words, 430, rate);
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert_eq!(lines[0].chars().count(), usize::from(width), "{lines:?}");
        assert!(lines[0].contains(" 43 % ") && lines[0].ends_with(" left"));
        assert!(lines[0].starts_with(&shortened(words)), "{lines:?}");
        assert_eq!(lines[1], rate);
    }
}

#[test]
fn numbers_have_two_or_three_digits_and_a_unit() {
    for (seconds, text) in [
        (0.0, "0 s"),
        (99.4, "99 s"),
        (99.6, "2 min"),
        (5960.0, "99 min"),
        (7200.0, "2 h"),
        (200_000.0, "2 days"),
    ] {
        assert_eq!(duration(seconds), text);
    }
    for (rate, text) in [
        (0.0, "0 samples/s"),
        (999.0, "999 samples/s"),
        (999.7, "1.00 k samples/s"),
        (9_996.0, "10.0 k samples/s"),
        (130_400.0, "130 k samples/s"),
        (999_700.0, "1.00 M samples/s"),
        (2.5e9, "2.50 G samples/s"),
    ] {
        assert_eq!(per_second(rate), text);
    }
    for (error, text) in [
        (0.2, "20 %"),
        (0.0996, "10 %"),
        (0.012, "1.2 %"),
        (0.000_926, "0.093 %"),
        (4.7e-8, "4.7e-8"),
    ] {
        assert_eq!(share(error), text);
    }
}

#[test]
fn the_error_of_finished_columns_is_that_of_all_of_them_together() {
    let mut tracing = Tracing::start(
        Console {
            quiet: false,
            also_read: &[],
            define: &[],
        },
        "test",
        10,
    );
    let paper = Paper {
        width: 80,
        written: Arc::default(),
    };
    let target = ProgressDrawTarget::term_like(Box::new(paper));
    tracing.bar.set_draw_target(target);
    // Two pixels, light of two orders, then the standard error and its code: Φ = 3, 4 and 12, 0; σ
    // = 0.3, 0.4 and 0, 1.2.
    tracing.finished(&Matrix::from_row_slice(
        2,
        4,
        &[1.0, 2.0, 0.3, 0.0, 4.0, 0.0, 0.4, 0.0],
    ));
    let shown = |t: &Tracing| f64::from_bits(t.shown.load(Ordering::Relaxed));
    assert!((shown(&tracing) - 0.1).abs() < 1e-15);
    tracing.finished(&Matrix::from_row_slice(
        2,
        4,
        &[7.0, 5.0, 0.0, 0.0, 0.0, 0.0, 1.2, 0.0],
    ));
    assert!((shown(&tracing) - 0.1).abs() < 1e-15);
    tracing.end();
}
