use super::super::limits::thresholds;
use super::*;

#[test]
fn numbers_are_said_with_two_digits_and_a_prefix() {
    for (x, unit, said) in [
        (0.02, "s", "20 ms"),
        (1.26, "s", "1.3 s"),
        (3.2e-14, "W", "32 fW"),
        (4.04e-7, "W", "404 nW"),
    ] {
        assert_eq!(prefixed(x, unit), said);
    }
}

fn setting(glare: f64, mean: f64) -> Setting {
    let reading = |analysis: &str, mean| Reading {
        analysis: analysis.to_owned(),
        mtf: None,
        mtf_normalized: Spread::of(&[mean]),
        correlation: None,
        failed: 0,
        reason: None,
    };
    Setting {
        spread: "even".to_owned(),
        glare,
        fraction: 0.1,
        exposure: 0.02,
        electrons: 900.0,
        saturated: 0,
        noise: 0.1,
        readings: vec![reading("published", mean), reading("joint", 0.9)],
    }
}

/// The same of so many draws that all read as much.
fn of_draws(mut sweep: Vec<Setting>, draws: usize) -> Vec<Setting> {
    for reading in sweep.iter_mut().flat_map(|s| &mut s.readings) {
        reading.mtf_normalized = Spread::of(&vec![reading.mtf_normalized.unwrap().mean; draws]);
    }
    sweep
}

/// The strength of the glare and what the published analysis finds under it come first; every
/// reading has a line in the file.
#[test]
fn the_findings_are_told_in_words() {
    let by_glare = vec![setting(0.0, 0.4), setting(1.0, -0.1)];
    let mut found = Experiment {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        sensor: "ccd".to_owned(),
        seeds: 1,
        traced: 1,
        signal: 3e-14,
        direct_over_signal: 50.0,
        thresholds: thresholds([&by_glare; 2], 1.0, 1),
        own_modulation: 1.0,
        by_exposure: by_glare.clone(),
        by_glare,
        words: Vec::new(),
    };
    found.words = words(&found, "`board`");
    assert_eq!(found.words.len(), 4);
    assert!(found.words[0].contains("gets 30 fW from `board`; 50 times"));
    assert!(found.words[1].ends_with("modulation of −0.10, `joint` 0.90."));
    assert!(found.words[2].ends_with("0.40: glare is not the only cause of its failure."));
    assert!(found.words[3].contains(
        "1.0 times the signal, by `joint`; not even at the least glare studied by `published`;"
    ));
    assert!(
        found.words[3]
            .ends_with("single frames of 20 ms already, the shortest studied, by `joint`.")
    );
    let said = found.describe();
    assert!(said.sentence.ends_with("0.90.") && said.notes.len() == 2);
    let file = said.tables.iter().find(|t| t.file.is_some()).unwrap();
    assert_eq!(
        (file.rows.len(), file.rows[0].len()),
        (8, file.columns.len())
    );
}

/// Of a picture of more than two values half of its own modulation is readable, and the reading
/// that is the closest to that is the best one, not the one of the most contrast.
#[test]
fn a_picture_of_many_values_is_measured_by_its_own() {
    let by_glare = vec![setting(0.0, 0.55), setting(1.0, 0.35)];
    let own_modulation = 0.6;
    let mut found = Experiment {
        scene: "greys".to_owned(),
        scene_hash: String::new(),
        sensor: "ccd".to_owned(),
        seeds: 1,
        traced: 1,
        signal: 3e-14,
        own_modulation,
        direct_over_signal: 50.0,
        thresholds: thresholds([&by_glare; 2], own_modulation, 1),
        by_exposure: by_glare.clone(),
        by_glare,
        words: Vec::new(),
    };
    found.words = words(&found, "`greys`");
    assert!(found.words[1].ends_with("modulation of 0.35, `published` 0.35."));
    assert!(found.words[2].ends_with("finds 0.55."));
    let reach = &found.words[3];
    assert!(reach.contains(
        "the picture is readable (normalized modulation 0.30 and more, half of its own)"
    ));
    assert!(reach.contains("1.0 times the signal, by `published`, `joint`;"));
}

/// A threshold between settings that are far apart is told with them, and so is what ± is of.
#[test]
fn what_is_interpolated_is_told() {
    // A loss of 0.25 and one of 1: of 0.5 half way in the logarithms.
    let by_glare = vec![setting(1.0, 0.75), setting(100.0, 0.0)];
    let short = |share: f64, mean: f64| Setting {
        exposure: share,
        ..setting(1.0, mean)
    };
    let by_exposure = vec![short(0.01, 0.0), short(1.0, 0.75)];
    let [by_glare, mut by_exposure] = [by_glare, by_exposure].map(|sweep| of_draws(sweep, 20));
    for (own, mean) in by_exposure.iter_mut().zip([0.1, 0.2]) {
        own.readings[1].mtf_normalized = Spread::of(&[mean; 20]);
    }
    let mut found = Experiment {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        sensor: "ccd".to_owned(),
        seeds: 20,
        traced: 16,
        signal: 3e-14,
        own_modulation: 1.0,
        direct_over_signal: 50.0,
        thresholds: thresholds([&by_glare, &by_exposure], 1.0, 20),
        by_exposure,
        by_glare,
        words: Vec::new(),
    };
    found.words = words(&found, "`board`");
    let [.., reach, of] = found.words.as_slice() else {
        unreachable!()
    };
    assert!(
        reach.contains("`published` (10, between 1.0 and 100 nothing was studied)"),
        "{reach}"
    );
    assert!(
        reach.ends_with(
            "at least 100 ms, between 10 ms and 1.0 s nothing was studied, by `published`."
        ),
        "{reach}"
    );
    assert!(
        of.contains("over 20 seeds") && of.contains("16 times in all"),
        "{of}"
    );
}

/// A modulation that one draw of six has, the pictures of the others being constant, reads nothing,
/// and its table says of how many it is; an exposure that suffices may lie beyond those studied.
#[test]
fn a_modulation_of_some_draws_reads_nothing() {
    let mut by_glare = of_draws(vec![setting(0.0, 0.9), setting(1.0, 0.8)], 6);
    let mut by_exposure = vec![by_glare[1].clone()];
    for reading in &mut by_exposure[0].readings {
        reading.mtf_normalized = Spread::of(&[1.0]);
    }
    by_glare[0].readings[0].mtf_normalized = Spread::of(&[1.0, 0.8]);
    let mut found = Experiment {
        scene: "bench".to_owned(),
        scene_hash: String::new(),
        sensor: "ccd".to_owned(),
        seeds: 6,
        traced: 6,
        signal: 3e-14,
        own_modulation: 1.0,
        direct_over_signal: 50.0,
        thresholds: thresholds([&by_glare, &by_exposure], 1.0, 6),
        by_exposure,
        by_glare,
        words: Vec::new(),
    };
    assert!(found.thresholds.iter().all(|t| t.exposure.is_none()));
    let glares: Vec<_> = found.thresholds.iter().map(|t| t.glare).collect();
    assert_eq!(glares, [None, Some(1.0)]);
    found.words = words(&found, "`board`");
    let all = found.words.join(" ");
    for said in [
        "finds 0.90 ± 0.14 (in 2 of 6 draws): glare is not the only cause",
        "none of the exposures studied, single frames of up to 20 ms, is long enough.",
        "some of the draws alone",
    ] {
        assert!(all.contains(said), "{all}");
    }
    let tables = found.describe().tables;
    assert_eq!(tables[1].rows[0][1], "1.0 (1 of 6)".into());
}
