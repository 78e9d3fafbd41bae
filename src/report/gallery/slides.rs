//! The recoveries with sliders over method, regularisation and noise.
//!
//! What stands here is the frame: controls and read-out, which `slides.js` fills. Without script
//! nothing of it is seen, and the pictures of [`recoveries`](super::recoveries) stay.

use serde_json::{Value, json};

use super::super::page::{Packed, Page, Precision, explained, meaning, term};
use super::super::svg::escape;
use crate::lab::{GalleryPicture, RunGallery, RunResults, Series};
use crate::recovery::Parameter;

/// The frame of the gallery, its data in `page`; nothing where there is none.
pub(in super::super) fn slides(page: &mut Page, results: &RunResults) -> String {
    let Some(gallery) = &results.gallery else {
        return String::new();
    };
    let left_out: String = gallery
        .left_out
        .iter()
        .map(|text| format!("<p class=\"note\">{}</p>\n", explained(text)))
        .collect();
    if gallery.series.is_empty() {
        return left_out;
    }
    let (values, places) = packed(gallery);
    page.json("slides-data", &described(gallery, &places));
    page.numbers(
        "slides-values",
        &Packed::new(&values, Precision::Single(23)),
    );
    frame(gallery) + &left_out
}

/// Indices of the pictures of a series, noise by noise and step by step; none where there is no
/// picture.
type Places = Vec<Vec<Option<usize>>>;

/// The truth of all surfaces, then the pictures one after the other; and for each series, noise and
/// step the index of its picture, truth being 0.
fn packed(gallery: &RunGallery) -> (Vec<f64>, Vec<Places>) {
    let truth = gallery
        .surfaces
        .iter()
        .flat_map(|s| s.truth.iter().copied());
    let mut values: Vec<f64> = truth.collect();
    let mut count = 1;
    let mut place = |picture: &Option<GalleryPicture>| {
        let picture = picture.as_ref()?;
        values.extend(&picture.reflectance);
        count += 1;
        Some(count - 1)
    };
    let places = gallery.series.iter().map(|series| {
        let noises = series.pictures.iter();
        noises
            .map(|steps| steps.iter().map(&mut place).collect())
            .collect()
    });
    let places = places.collect();
    (values, places)
}

fn described(gallery: &RunGallery, places: &[Vec<Vec<Option<usize>>>]) -> Value {
    let mut first = 0;
    let surfaces = gallery.surfaces.iter().map(|surface| {
        let at = first;
        first += surface.truth.len();
        json!({ "name": surface.name, "elements": surface.elements, "cells": surface.cells, "first": at })
    });
    let surfaces: Vec<Value> = surfaces.collect();
    let series = gallery.series.iter().zip(places).map(one);
    json!({
        "elements": first,
        "surfaces": surfaces,
        "noises": gallery.noises,
        "mean": gallery.mean,
        "series": series.collect::<Vec<Value>>(),
    })
}

fn one((series, places): (&Series, &Places)) -> Value {
    let automatic = series.automatic.iter().map(|chosen| match chosen {
        Ok(chosen) => json!({ "step": chosen.step, "words": chosen.words }),
        Err(why) => json!({ "why": why }),
    });
    let measures = |picture: &Option<GalleryPicture>| {
        let of = picture.as_ref().map_or(&[][..], |p| &p.measures);
        let of = of.iter();
        of.map(|m| json!([m.mtf_raw, m.mtf_normalized, m.correlation, m.rmse]))
            .collect()
    };
    let noises = series.pictures.iter();
    let measures: Vec<Vec<Vec<Value>>> =
        noises.map(|of| of.iter().map(measures).collect()).collect();
    json!({
        "method": series.method.name(),
        "meaning": meaning(series.method.name()),
        "steps": series.steps.iter().map(words).collect::<Vec<String>>(),
        "automatic": automatic.collect::<Vec<Value>>(),
        "pictures": places,
        "measures": measures,
    })
}

/// A parameter in words.
fn words(parameter: &Parameter) -> String {
    match *parameter {
        Parameter::Rank(1) => "1 singular direction".to_owned(),
        Parameter::Rank(kept) => format!("{kept} singular directions"),
        Parameter::Damping(damping) => format!("damping {damping:.2e} of σ1"),
        Parameter::TotalVariation(lambda) => format!("total variation {lambda:.2e} of σ1²"),
        Parameter::GaussianProcess { spread, length } => {
            format!("spread {spread:.3}, length {length:.3}")
        }
        Parameter::Levels([dark, light]) => format!("levels {dark:.3} and {light:.3}"),
        Parameter::None => "no parameter".to_owned(),
    }
}

fn frame(gallery: &RunGallery) -> String {
    let regularisation = term(
        "regularisation",
        "how strongly noisy directions are suppressed: tsvd inverts only the strongest singular \
         directions, tikhonov damps the weak ones. With too little, noise covers the picture; \
         with too much, the picture blurs",
    );
    let noise = term(
        "noise added",
        "standard deviation of normal noise on top of the photographs, the same in every entry, as a fraction of their mean. It is one draw, made \
         larger or smaller",
    );
    let automatic = term(
        "automatic",
        "the parameter that the method chooses when it knows the noise: the strongest \
         regularisation whose misfit the noise explains (discrepancy principle)",
    );
    let stretched = term(
        "own range",
        "black is then the smallest value of the picture and white the largest, as the published figures are drawn: contrast is shown, not reflectance",
    );
    let correlation = term(
        "correlation",
        "Pearson's correlation of the recovered values with the true ones: 1 where the pattern is right, whatever its brightness and contrast",
    );
    let several = match gallery.surfaces.len() {
        1 => " hidden",
        _ => "",
    };
    let row = |name: &str, key: &str| {
        format!(
            "<tr><th scope=\"row\">{name}</th><td class=\"n\"><output data-show=\"{key}\"></output></td></tr>\n"
        )
    };
    let readout = [
        (explained("MTF raw"), "raw"),
        (explained("MTF normalized"), "normalized"),
        (correlation, "correlation"),
        (explained("RMSE"), "rmse"),
    ]
    .map(|(name, key)| row(&name, key))
    .concat();
    format!(
        "<div class=\"slides\" id=\"slides\" hidden>\n\
         <p>Every picture here was recovered by the run itself, none is interpolated. Move the sliders to see \
         how the method, its {regularisation} and noise change it.</p>\n\
         <div class=\"controls\">\n\
         <label{several}>surface <select name=\"surface\"></select></label>\n\
         <label>method <select name=\"method\"></select></label>\n\
         <label class=\"tick\"><input type=\"checkbox\" name=\"stretched\"> stretched to its {stretched}</label>\n\
         </div>\n\
         <p class=\"note\" data-show=\"meaning\"></p>\n\
         <div class=\"sliders\">\n\
         <div><label class=\"slider\" for=\"slides-step\">regularisation: <output data-show=\"step\"></output></label>\n\
         <input type=\"range\" id=\"slides-step\" name=\"step\" min=\"0\" value=\"0\"><div class=\"ends\"><span>strong</span><span class=\"here\" data-show=\"marker\">▲</span><span>weak</span></div>\n\
         <label class=\"slider\"><input type=\"checkbox\" name=\"automatic\" checked> {automatic}</label></div>\n\
         <div><label class=\"slider\" for=\"slides-noise\">{noise}: <output data-show=\"noise\"></output></label>\n\
         <input type=\"range\" id=\"slides-noise\" name=\"noise\" min=\"0\" value=\"0\"><div class=\"ends\"><span>none</span><span>loud</span></div></div>\n\
         </div>\n\
         <p class=\"note\" data-show=\"said\" aria-live=\"polite\"></p>\n\
         <div class=\"row pair\">\n\
         <figure data-picture><canvas role=\"img\" data-show=\"picture\"></canvas><figcaption><b>recovered</b> <span data-show=\"range\"></span></figcaption></figure>\n\
         <figure data-picture><canvas role=\"img\" data-show=\"truth\"></canvas><figcaption><b>truth</b> black 0, white 1</figcaption></figure>\n\
         <div class=\"read\"><table>\n{readout}</table>\n<p class=\"note\" data-show=\"parameter\"></p>\n\
         <p class=\"note\" data-show=\"element\">Point at an element to read its value.</p></div>\n\
         </div>\n\
         <div class=\"row\" data-show=\"curves\"></div>\n\
         <p class=\"note\">{}</p>\n</div>\n",
        escape(
            "Values below 0 are blue and values above 1 orange; what is not a number is purple. \
             The curves follow the automatic choice, or the parameter that is set; the line marks \
             what is shown, and an arrow stands for a value beyond the plot."
        )
    )
}

#[cfg(test)]
mod tests;
