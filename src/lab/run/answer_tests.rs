use super::*;
use crate::lab::finding::Cell;
use crate::lab::sample::{bare, run};

fn about<'a>(answer: &'a Answer<'_>, what: &str) -> &'a Claim {
    let all = answer.claims.iter().chain([&answer.agreement]);
    all.into_iter().find(|c| c.about == what).unwrap()
}

/// Hidden, recovered, how sure, agreement, in this order, on the page and on the terminal.
#[test]
fn the_answer_comes_in_the_order_of_the_questions() {
    let results = run("bench");
    let answer = results.answer();
    let table = &answer.describe().tables[0];
    let asked: Vec<&Cell> = table.rows.iter().map(|row| &row[0]).collect();
    let due = ["hidden", "recovered", "how sure", "agreement"].map(Cell::from);
    assert_eq!(asked, due.iter().collect::<Vec<_>>());
    let hidden = &about(&answer, "hidden").sentence;
    assert_eq!(
        hidden,
        "object, 8 × 8 elements; the scene knows what is on it"
    );
    let recovered = &about(&answer, "recovered").sentence;
    assert_eq!(
        recovered,
        "by pinv: root mean square error 0.0500, correlation 0.970, raw MTF 0.700"
    );
    let sure = about(&answer, "how sure");
    assert_eq!(sure.tone, Tone::Good);
    for words in [
        "it fits the photographs: χ²/dof 1.250 over 24 degrees of freedom, P 0.20. ",
        "determine 4.50 of 64 directions of the picture, by any method",
        // ½ √(1 − ¼)
        "is known to ± 0.43 afterwards (median; 0.43 to 0.43)",
        ". One warning below",
    ] {
        assert!(sure.sentence.contains(words), "{}", sure.sentence);
    }
    let start = "traced and physical model agree: χ²/dof 1.003 over 30720 entries,";
    assert!(answer.agreement.sentence.starts_with(start));
}

/// What does not fit, what nothing fits, and light that disagrees are bad news.
#[test]
fn bad_news_are_as_loud_as_good_ones() {
    let mut results = run("bench");
    for r in &mut results.recovered {
        r.fit.as_mut().unwrap().fits = false;
    }
    results.agreement.as_mut().unwrap().agrees = false;
    let answer = results.answer();
    let sure = about(&answer, "how sure");
    assert_eq!((sure.tone, answer.agreement.tone), (Tone::Bad, Tone::Bad));
    assert!(
        sure.sentence
            .starts_with("it DOES NOT FIT the photographs: ")
    );
    assert!(answer.agreement.sentence.contains("DISAGREE"));
    for r in &mut results.recovered {
        r.best_fit.as_mut().unwrap().fits = false;
    }
    let sure = certainty(&results.answer().pictures, Certainty::STATED);
    assert!(sure.sentence.contains("nor does any other"));
    for r in &mut results.recovered {
        r.fit = None;
    }
    let sure = certainty(&results.answer().pictures, Certainty::STATED);
    assert_eq!(sure.tone, Tone::Plain);
    assert!(sure.sentence.contains("CANNOT BE JUDGED"));
}

/// By hand: the root mean square of 0.3 and 0.4 is √0.125 = 0.354.
#[test]
fn errors_of_elements_are_told_with_their_largest() {
    let results = run("bench");
    let mut object = results.recovered[0].clone();
    assert!(error(&[&object], Certainty::STATED).contains("no error for an element"));
    object.standard_error = Some(vec![0.3, 0.4]);
    object.light = Some(vec![0.001, 0.94]);
    assert_eq!(
        error(&[&object], Certainty::STATED),
        "Standard error 0.35 an element (root mean square), 0.40 at most; 1 of 2 elements light or \
         dark with more than 95\u{a0}% probability. "
    );
}

/// Without truth the range of what was found; of one element its value; of two surfaces each.
#[test]
fn what_came_back_is_told_with_and_without_truth() {
    let mut results = run("bench");
    results.recovered.truncate(1);
    let first = &mut results.recovered[0];
    (first.truth, first.rmse, first.correlation) = (None, None, None);
    first.mtf_raw = None;
    first.reflectance = vec![0.25, -0.5, 1.5, 0.0];
    let answer = results.answer();
    assert!(about(&answer, "hidden").sentence.ends_with("is not known"));
    assert_eq!(
        about(&answer, "recovered").sentence,
        "by pinv: reflectances from −0.50 to 1.5"
    );
    let mut second = results.recovered[0].clone();
    (second.surface, second.reflectance) = ("other".to_owned(), vec![0.31]);
    (second.standard_error, second.truth) = (Some(vec![0.02]), Some(vec![0.3]));
    results.recovered.push(second);
    assert_eq!(
        about(&results.answer(), "recovered").sentence,
        "by pinv: object, reflectances from −0.50 to 1.5; other, reflectance 0.310 ± 0.020, truth 0.300"
    );
}

#[test]
fn a_scene_that_hides_nothing_says_so() {
    let results = bare("furnace");
    let answer = results.answer();
    assert!(answer.pictures.is_empty() && answer.claims.len() == 1);
    assert_eq!(answer.claims[0].sentence, "nothing");
    let words = "no model to compare with: the scene hides nothing";
    assert_eq!(answer.agreement.sentence, words);
    // Something is hidden, and nothing came back.
    let mut results = bare("bench");
    assert_eq!(about(&results.answer(), "recovered").sentence, "nothing");
    results.phi.fill(0.0);
    let nothing = &results.answer().claims[1].sentence;
    assert_eq!(nothing, "nothing: no light reached the camera");
}

/// Of one degree of freedom a fit is no good news; and why there are no errors is said, with what
/// gives them.
#[test]
fn what_cannot_be_judged_is_no_good_news() {
    let mut results = run("bench");
    for r in &mut results.recovered {
        r.fit.as_mut().unwrap().dof = 1.0;
    }
    results.plan.estimator = crate::transport::Estimator::Factored;
    let answer = results.answer();
    let sure = about(&answer, "how sure");
    assert_eq!(sure.tone, Tone::Plain);
    let words = &sure.sentence;
    assert!(words.contains("CANNOT BE JUDGED"), "{words}");
    assert!(words.contains("--estimator independent"), "{words}");
}
