use super::super::svg::well_formed;
use super::*;
use crate::lab::sample::{bare, of, run, whole};

/// What is shown: without scripts, data, and the licences of libraries.
fn shown(html: &str) -> String {
    let ours: String = html
        .split("<script")
        .map(|part| {
            part.split_once("</script>")
                .map_or(part, |(_, after)| after)
        })
        .collect();
    ours.split("<details class=\"licences\">")
        .next()
        .unwrap()
        .to_owned()
}

/// No address but those of the SVG name space and of data.
fn needs_no_network(html: &str) {
    let ours = shown(html);
    let style_and_markup = ours.replace("http://www.w3.org/2000/svg", "");
    for word in ["http://", "https://", "src=\"", "@import"] {
        assert!(!style_and_markup.contains(word), "{word}");
    }
    for link in style_and_markup.split("href=\"").skip(1) {
        let inside = link.starts_with("data:image/") || link.starts_with('#');
        assert!(inside, "{link:.40}");
    }
}

#[test]
fn a_whole_run_makes_a_whole_page() {
    let html = run_html(&run("bench"));
    well_formed(&html).unwrap();
    needs_no_network(&html);
    for text in [
        "<b>Agreement:</b> <strong>traced and physical model agree:</strong>",
        "<b>How sure:</b> <strong>it fits the photographs:</strong>",
        "aria-label=\"truth of object\"",
        "aria-label=\"what was recovered of object\"",
        "aria-label=\"what the photographs determine of object\"",
        "spot 119 at",
        "Φcam, modelled",
        "<h3>object</h3>",
        "joint-bounded",
        "DOES NOT FIT &lt;in this sample&gt;",
        "determined by the photographs",
        "phicam run bench -o out --estimator independent --sampler pcg --samples 4096 --seed 18446744073709551615",
        "phicam validate out --integration centres --significance 0.01\nphicam recover out",
    ] {
        assert!(html.contains(text), "{text}");
    }
    // Three frames, two matrices with one legend each set, z, truth, what the photographs determine
    // and five recoveries.
    assert_eq!(html.matches("<figure>").count(), 3 + 2 + 1 + 1 + 1 + 5);
    assert!(shown(&html).len() < 1_000_000 && html.len() < 10_000_000);
}

/// First the answer, then how it was done, then what there is to explore.
#[test]
fn the_answer_comes_first() {
    let html = run_html(&run("bench"));
    let order = [
        "truth of object",
        "what was recovered of object",
        "<b>Hidden:</b>",
        "<b>Recovered:</b>",
        "<b>How sure:</b>",
        "<b>Agreement:</b>",
        "<nav",
        "id=\"scene\"",
        "id=\"settings\"",
        "id=\"recovered\"",
        "id=\"explorer\"",
        "id=\"phi\"",
        "id=\"difference\"",
    ];
    let at = order.map(|part| html.find(part).unwrap_or_else(|| panic!("no {part}")));
    assert!(at.is_sorted(), "{at:?}");
}

/// A picture that does not fit, and light that disagrees, have the colour of bad news.
#[test]
fn bad_news_are_on_the_first_screen() {
    let mut results = run("bench");
    results.recovered[0].fit.as_mut().unwrap().fits = false;
    results.agreement.as_mut().unwrap().agrees = false;
    let html = run_html(&results);
    let bad = "<p class=\"claim disagree\">";
    for claim in [
        "<b>How sure:</b> <strong>it DOES NOT FIT the photographs:</strong>",
        "<b>Agreement:</b> <strong>traced and physical model DISAGREE:</strong>",
    ] {
        assert!(html.contains(&format!("{bad}{claim}")), "{claim}");
    }
    // The error of an element is drawn where it differs from another's.
    results.recovered[0].standard_error = Some(vec![0.2; 64]);
    assert!(!run_html(&results).contains("standard error of object"));
    results.recovered[0].standard_error.as_mut().unwrap()[5] = 0.1;
    assert!(run_html(&results).contains("standard error of object"));
    // Where the truth is not known, the page says that.
    results.recovered[0].truth = None;
    let html = run_html(&results);
    assert!(html.contains("<div class=\"unknown\">not known</div>"));
    // Of many surfaces the first three.
    for surface in ["b", "c", "d", "e"] {
        let mut other = results.recovered[0].clone();
        other.surface = surface.to_owned();
        results.recovered.push(other);
    }
    let html = run_html(&results);
    assert_eq!(html.matches("<div class=\"three\">").count(), 3);
    assert!(html.contains("2 further surfaces"));
}

#[test]
fn a_run_without_model_makes_a_page_too() {
    let html = run_html(&bare("furnace"));
    well_formed(&html).unwrap();
    needs_no_network(&html);
    assert!(html.contains("no model to compare with"));
    let shown = shown(&html);
    assert!(!shown.contains("modelled") && !shown.contains("Recovered"));
}

#[test]
fn odd_names_stay_text() {
    let text = include_str!("../../../scenes/bench.toml")
        .replace("name = \"bench\"", "name = '<script>&\"ü'")
        .replace("name = \"object\"", "name = '</text><&\"ü'");
    let mut results = whole(of(Scene::from_toml("odd", &text).unwrap()));
    results.recovered[0].parameter = "</table><b>&".into();
    results.version = "<i>".into();
    let html = run_html(&results);
    well_formed(&html).unwrap();
    needs_no_network(&html);
    // A scene that is not built in is repeated from its file, never by its name.
    assert!(html.contains("phicam run scene.toml"));
}

#[test]
fn a_built_in_name_with_other_content_is_repeated_from_its_file() {
    let text =
        include_str!("../../../scenes/bench.toml").replace("power = 5.0e-3", "power = 6.0e-3");
    let html = run_html(&of(Scene::from_toml("x", &text).unwrap()));
    assert!(html.contains("phicam run scene.toml"));
}

#[test]
#[ignore = "slow"]
fn large_and_broken_matrices_keep_the_page_small_and_whole() {
    let mut results = run("experiment");
    // Noise cannot be compressed: the worst case for the page's size.
    let mut state = 1u64;
    let mut noise = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as f64
    };
    for matrix in [
        Some(&mut results.phi),
        results.model.as_mut(),
        results.z.as_mut(),
    ]
    .into_iter()
    .flatten()
    {
        for x in matrix.iter_mut() {
            *x = noise();
        }
    }
    results.phi[(5, 5)] = f64::NAN;
    results.phi[(6, 5)] = f64::INFINITY;
    for r in &mut results.recovered {
        r.elements = [1024, 1024];
        r.reflectance = (0..1 << 20).map(|_| noise()).collect();
        r.mtf_raw = Some(f64::NAN);
    }
    let html = run_html(&results);
    well_formed(&html).unwrap();
    assert!(html.len() < 10_000_000, "{}", html.len());
    assert!(
        html.contains("For display only, each pixel of the picture is the mean of 1 × 8 entries")
    );
    assert!(html.contains("middle one of 1 × 8"));
}
