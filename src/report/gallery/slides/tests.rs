//! Data and frame of the slides.

use super::super::super::svg::well_formed;
use super::*;
use crate::lab::sample;
use crate::lab::{Automatic, GallerySurface, Measures};
use crate::recovery::Method;

fn picture(values: &[f64], raw: Option<f64>) -> Option<GalleryPicture> {
    let measures = Measures {
        mtf_raw: raw,
        light_plus_dark: None,
        mtf_normalized: Some(0.5),
        correlation: None,
        rmse: Some(0.25),
    };
    Some(GalleryPicture {
        reflectance: values.to_vec(),
        measures: vec![measures; 2],
    })
}

/// Two surfaces, the second of triangles; two noises; a method with two steps, and one that
/// gives nothing with noise.
fn gallery() -> RunGallery {
    let surface = |name: &str, cells, truth: &[f64]| GallerySurface {
        name: name.to_owned(),
        elements: [truth.len(), 1],
        cells,
        truth: truth.to_vec(),
    };
    let automatic = |step, words: &str| {
        Ok(Automatic {
            step,
            words: words.to_owned(),
        })
    };
    let tsvd = Series {
        method: Method::Tsvd,
        steps: vec![Parameter::Rank(1), Parameter::Rank(3)],
        automatic: vec![automatic(1, "3 of <all>"), Err("no & signal".to_owned())],
        pictures: vec![
            vec![
                picture(&[0.1, 0.2, 0.3], None),
                picture(&[1.1, 1.2, 1.3], Some(-1e6)),
            ],
            vec![picture(&[2.1, 2.2, 2.3], None), None],
        ],
    };
    let joint = Series {
        method: Method::Joint,
        steps: vec![Parameter::None],
        automatic: vec![automatic(0, "rank 3"), Err("left out".to_owned())],
        pictures: vec![vec![picture(&[3.1, 3.2, 3.3], None)], vec![None]],
    };
    RunGallery {
        surfaces: vec![
            surface("a <b>", true, &[0.0, 1.0]),
            surface("mesh", false, &[0.5]),
        ],
        noises: vec![0.0, 1e-2],
        mean: 2e-12,
        series: vec![tsvd, joint],
        left_out: vec!["5 of 7 noises & more.".to_owned()],
    }
}

fn page(gallery: RunGallery) -> String {
    let mut results = sample::run("bench");
    results.gallery = Some(gallery);
    let mut page = Page::new("slides");
    let html = slides(&mut page, &results);
    page.section("recovered", "Recovered", &html);
    page.html()
}

fn described_in(html: &str) -> Value {
    let block = html.split("id=\"slides-data\">").nth(1).unwrap();
    serde_json::from_str(block.split("</script>").next().unwrap()).unwrap()
}

#[test]
fn data_and_frame_are_whole() {
    let html = page(gallery());
    well_formed(&html).unwrap();
    let said = described_in(&html);
    assert_eq!(said["elements"], 3);
    assert_eq!(
        said["surfaces"][1],
        json!({ "name": "mesh", "elements": [1, 1], "cells": false, "first": 2 })
    );
    assert_eq!(said["noises"], json!([0.0, 0.01]));
    let tsvd = &said["series"][0];
    assert_eq!(
        tsvd["steps"],
        json!(["1 singular direction", "3 singular directions"])
    );
    assert_eq!(
        tsvd["automatic"],
        json!([{ "step": 1, "words": "3 of <all>" }, { "why": "no & signal" }])
    );
    assert_eq!(tsvd["measures"][0][1][0], json!([-1e6, 0.5, null, 0.25]));
    assert_eq!(tsvd["measures"][1][1], json!([]));
    assert!(tsvd["meaning"].as_str().unwrap().contains("strongest"));
    assert!(html.contains("5 of 7 noises &amp; more."));
    // The truth, and the four pictures that there are: three values each.
    assert!(html.contains("id=\"slides-values\" data-count=\"15\""));
}

/// Every index that the data hand out leads to the values of that picture.
#[test]
fn every_picture_is_where_the_data_say() {
    let gallery = gallery();
    let (values, places) = packed(&gallery);
    let mut seen = 0;
    assert_eq!(values[..3], [0.0, 1.0, 0.5]);
    for (series, places) in gallery.series.iter().zip(&places) {
        for (pictures, places) in series.pictures.iter().zip(places) {
            assert_eq!(pictures.len(), places.len());
            for (picture, place) in pictures.iter().zip(places) {
                assert_eq!(picture.is_some(), place.is_some());
                if let (Some(picture), Some(place)) = (picture, place) {
                    assert_eq!(values[3 * place..3 * place + 3], picture.reflectance);
                    seen += 1;
                }
            }
        }
    }
    assert_eq!(values.len(), 3 * (1 + seen));
}

#[test]
fn where_there_is_no_gallery_there_is_no_frame() {
    let empty = RunGallery {
        series: Vec::new(),
        noises: Vec::new(),
        ..gallery()
    };
    let html = page(empty);
    assert!(html.contains("5 of 7 noises") && !html.contains("id=\"slides\""));
    let mut results = sample::run("bench");
    results.gallery = None;
    assert!(slides(&mut Page::new("none"), &results).is_empty());
}
