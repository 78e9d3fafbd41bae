#!/usr/bin/env python3
"""What phicam claims, the test that holds it, and a fault in the source that makes that test fail.

    tests/breaks.py --check           faults, tests and the table of README.md fit the sources
    tests/breaks.py --table           prints that table
    tests/breaks.py --run [WORD ...]  plants the faults whose claim, file or test contains a WORD,
                                      batch by batch, and runs their tests; each must fail

Faults are planted in a copy of the last commit (`target/breaks`), never in the checkout. Those of a
batch leave each other's tests alone. A test that cannot be compiled has not failed. Python's
standard library is enough.
"""

import argparse
import pathlib
import re
import subprocess
import sys
from typing import NamedTuple

ROOT = pathlib.Path(__file__).resolve().parent.parent
FRONT = ROOT / "tests/README.md"
BEGIN, END = "<!-- breaks: begin -->\n", "<!-- breaks: end -->\n"


class Break(NamedTuple):
    claim: str
    file: str  # below the root
    old: str  # is there once
    new: str
    target: str  # "lib" or the name of an integration test
    test: str  # its path within the target
    batch: int  # faults of one batch leave each other's tests alone, and are planted together


BREAKS = [
    Break(
        "The estimate of a path is unbiased (closed form of an integrating sphere)",
        "src/transport/path.rs",
        "return FRAC_1_PI * term;",
        "return 1.01 * FRAC_1_PI * term;",
        "physics",
        "closed_forms::the_furnace_glows_as_an_integrating_sphere",
        1,
    ),
    Break(
        "Traced light is the transport integral (quadrature of its own)",
        "src/transport/vertex.rs",
        "        there * back / (square * square)\n",
        "        1.001 * there * back / (square * square)\n",
        "physics",
        "accuracy::shared_sobol_is_within_3e_4_of_the_thesis_integral",
        2,
    ),
    Break(
        "Two-bounce light falls as the closed form says",
        "src/transport/vertex.rs",
        "(cos_a > 0.0 && cos_b > 0.0).then(|| (cos_a * cos_b / (ray.length * ray.length), ray))",
        "(cos_a > 0.0 && cos_b > 0.0).then(|| (cos_a * cos_b / ray.length, ray))",
        "physics",
        "closed_forms::two_bounces_follow_the_inverse_square_law",
        3,
    ),
    Break(
        "What stands in the way stops the light",
        "src/geometry/bvh.rs",
        "self.shapes[id].blocks(ray, ends[0] == shape, ends[1] == shape)",
        "self.shapes[id].blocks(ray, ends[0] == shape, ends[1] == shape) && id < 2",
        "physics",
        "obstacles::what_stands_in_the_way_stops_the_light",
        2,
    ),
    Break(
        "Paint reflects as it does in another program",
        "src/scene/material/coated.rs",
        "fresnel::dielectric(cosine, self.eta).0 * mirror + FRAC_1_PI",
        "fresnel::dielectric(cosine, self.eta).0.sqrt() * mirror + FRAC_1_PI",
        "lib",
        "scene::material::coated::tests::paint_is_as_in_another_program",
        1,
    ),
    Break(
        "White paint is white",
        "src/scene/material/coated.rs",
        "SecondFacet::Passes => 1.0 - coated.mean_transmittance / (eta * eta),",
        "SecondFacet::Passes => internal(&ggx, eta, &outer),",
        "lib",
        "scene::material::tests::white_paint_is_white",
        3,
    ),
    Break(
        "Every material is reciprocal",
        "src/scene/material/coated.rs",
        "let through = self.transmittance(wi.z) * self.transmittance(wo.z);",
        "let through = self.transmittance(wi.z) * self.transmittance(wi.z);",
        "lib",
        "scene::material::tests::every_material_is_reciprocal",
        2,
    ),
    Break(
        "The model's integral is the reference",
        "src/model/kernel.rs",
        "Self::Physical => (-r.dot(hidden.normal)).max(0.0),",
        "Self::Physical => 1.0001 * (-r.dot(hidden.normal)).max(0.0),",
        "physics",
        "model::the_converged_integral_is_the_reference",
        2,
    ),
    Break(
        "Standard errors are honest",
        "src/transport/spread.rs",
        "scatter: self.scatter + (other.scatter + apart * apart * weight),",
        "scatter: self.scatter + (other.scatter + 0.5 * apart * apart * weight),",
        "physics",
        "accuracy::independent_pcg_has_honest_error_bars",
        4,
    ),
    Break(
        "A verdict rejects a right model as often as it states",
        "src/lab/agreement.rs",
        "Errors::WithinRows => effective_freedom(&z, entries) * free / entries.max(1) as f64,",
        "Errors::WithinRows => entries.max(1) as f64,",
        "lib",
        "lab::agreement::tests::false_alarms_come_at_the_stated_rate",
        2,
    ),
    Break(
        "A verdict rejects a wrong model",
        "src/lab/agreement.rs",
        "agrees: evident && chi2_p >= share && largest_p >= share && scored,",
        "agrees: chi2_p >= 0.0,",
        "cli",
        "verdict::it_disagrees_with_the_published_kernel",
        3,
    ),
    Break(
        "A verdict names the parameter that is off, with its size",
        "src/lab/residual.rs",
        "let value = total(0) / g;",
        "let value = 0.5 * total(0) / g;",
        "physics",
        "verdict::every_deviation_is_found_by_name",
        2,
    ),
    Break(
        "Entries whose error is not trusted do not count",
        "src/lab/evidence.rs",
        "self.left_out.is_none_or(|flags| flags[at] == 0.0)",
        "self.left_out.is_none_or(|flags| flags[at] < 2.0)",
        "physics",
        "verdict::flagged_entries_do_not_count",
        1,
    ),
    Break(
        "Spots beside an edge have the integral, within its bound",
        "src/model/parts.rs",
        "let close = distance < FAR && room >= 3 && generation < MOST_CUTS;",
        "let close = distance < 0.0 && room >= 3 && generation < MOST_CUTS;",
        "physics",
        "model::spots_beside_the_hinge_have_the_integral",
        3,
    ),
    Break(
        "Random numbers are a function of seed, spot, pixel and block",
        "src/num/stream.rs",
        "split_mix(state ^ u64::from(self.block))",
        "split_mix(state)",
        "lib",
        "num::stream::tests::a_stream_depends_on_every_part_of_its_key",
        1,
    ),
    Break(
        "Any division of the blocks gives the same bits",
        "src/num/tree.rs",
        "half.is_power_of_two() && left.start.is_multiple_of(width) && right.end == end",
        "half.is_power_of_two() && right.end == end",
        "lib",
        "num::tree::tests::any_cutting_gives_the_same_bits",
        3,
    ),
    Break(
        "Shot noise is Poisson at every mean",
        "src/sensor/frame.rs",
        "ShotNoise::Poisson => stream.poisson(mean),",
        "ShotNoise::Poisson => mean + mean.sqrt() * stream.normal(),",
        "physics",
        "sensor::stages::shot_noise_is_poisson_at_every_mean",
        2,
    ),
    Break(
        "Read noise is normal, with the stated deviation",
        "src/sensor/frame.rs",
        "sigma => sigma * stream.normal(),",
        "sigma => 1.03 * sigma * stream.normal(),",
        "physics",
        "sensor::stages::read_noise_is_normal",
        1,
    ),
    Break(
        "A converter rounds as the normal distribution says",
        "src/sensor/frame.rs",
        "let rounded = analog.round();",
        "let rounded = analog.floor();",
        "physics",
        "sensor::stages::quantisation_rounds_as_the_normal_distribution_says",
        3,
    ),
    Break(
        "The deviation stated for photographs is that of the samples",
        "src/sensor/law.rs",
        "self.averaged(self.electrons(flux), self.frames) + self.averaged_dark();",
        "self.averaged(self.electrons(flux), self.frames);",
        "physics",
        "sensor::law::the_analytic_deviation_is_that_of_the_samples",
        4,
    ),
    Break(
        "A deviation from counts alone is that of the samples",
        "src/sensor/deviation.rs",
        "(self.value + self.uncertain).sqrt()",
        "self.value.sqrt()",
        "physics",
        "sensor::counts::deviations_from_counts_are_those_of_the_samples",
        1,
    ),
    Break(
        "A series of exposures is unbiased around the full well",
        "src/sensor/frame.rs",
        "const MARGIN: f64 = 8.0;",
        "const MARGIN: f64 = -2.0;",
        "physics",
        "sensor::counts::a_series_is_unbiased_in_every_band_around_the_full_well",
        2,
    ),
    Break(
        "Bands of an unbiased method cover as often as they say",
        "src/recovery/bands.rs",
        "map(|(x, s)| [x - z * s, x + z * s])",
        "map(|(x, s)| [x - 0.9 * z * s, x + 0.9 * z * s])",
        "lib",
        "recovery::bands::tests::bands_of_an_unbiased_method_cover_as_often_as_they_say",
        1,
    ),
    Break(
        "Bands between bounds cover all elements as often as they say",
        "src/recovery/bands.rs",
        "chi_square_quantile(confidence, seen.len() as f64)",
        "(2.0 * best.objective + chi_square_quantile(confidence, 1.0))",
        "lib",
        "recovery::bands::tests::a_lone_light_element_is_covered_as_promised",
        2,
    ),
    Break(
        "Photographs that fit no geometry are no estimate of one",
        "src/lab/calibrate/describe.rs",
        "self.left * (1.0 - by_noise)",
        "self.left * (by_noise - 1.0)",
        "lib",
        "lab::calibrate::tests::photographs_of_no_geometry_come_with_that_verdict_first",
        3,
    ),
    Break(
        "The ends of bands of many elements are those of a conic solver",
        "src/num/quadratic/region.rs",
        "length.is_finite() && e.norm() <= self.radius",
        "length.is_finite() && e.norm().is_finite()",
        "lib",
        "num::quadratic::extent::tests::many_variables_end_where_the_conic_solver_ends",
        3,
    ),
    Break(
        "Columns of the normal equations are those of the weighted rows",
        "src/recovery/joint/gram/frame.rs",
        "rows.gemv(-share, u, &along, 1.0);",
        "rows.gemv(-0.5 * share, u, &along, 1.0);",
        "lib",
        "recovery::joint::gram::tests::it_is_the_objective_of_the_rows",
        3,
    ),
    Break(
        "A recovery that is stopped keeps its picture without bands",
        "src/recovery/bands.rs",
        "goes_on.then(|| extents.of(j)).transpose()",
        "goes_on.then_some(extents.of(j)).or(Some(extents.of(j))).transpose()",
        "lib",
        "recovery::bands::tests::a_picture_that_was_stopped_is_kept_without_its_bands",
        3,
    ),
    Break(
        "A weight's search that is stopped says so",
        "src/recovery/joint/total_variation.rs",
        "recovered.unfinished = unfinished;",
        "recovered.unfinished = unfinished.and(None);",
        "lib",
        "recovery::joint::total_variation::tests::a_search_that_was_stopped_shows_the_best_till_then",
        3,
    ),
    Break(
        "Methods that are finished when a recovery is stopped are kept, the others told",
        "src/lab/objects.rs",
        "recover(*method, &problem.under(own), options)",
        "recover(*method, &problem.under(own).under(Control::none()), options)",
        "lib",
        "lab::doubt::tests::methods_that_are_finished_are_kept",
        3,
    ),
    Break(
        "Every method warns of photographs that are not of this scene",
        "src/lab/fit.rs",
        "fits: p >= FIT_LEVEL,",
        "fits: true,",
        "lib",
        "lab::doubt::tests::every_method_warns_of_photographs_that_are_not_of_this_scene",
        2,
    ),
    Break(
        "A right recovery is called refuted as often as stated",
        "src/lab/fit.rs",
        "sum += z * z;",
        "sum += 1.1 * z * z;",
        "lib",
        "lab::fit::tests::p_values_of_a_right_model_are_uniform",
        3,
    ),
    Break(
        "The standard error of pinv is its spread over noise",
        "src/recovery/pixelwise/uncertainty.rs",
        "let terms = seen.column(j).zip_map(&sharp.column(j), |v, s| v * s * s);",
        "let terms = seen.column(j).zip_map(&sharp.column(j), |v, s| 1.2 * v * s * s);",
        "lib",
        "recovery::pixelwise::pinv::tests::its_standard_error_is_the_spread_over_noise",
        2,
    ),
    Break(
        "Bounds recover a board of two checks from a tenth of noise",
        "src/recovery/joint/bounded.rs",
        "_ => reduced.bounds(problem),",
        "_ => Bounds::all(problem.c.ncols(), f64::NEG_INFINITY, f64::INFINITY),",
        "lib",
        "recovery::joint::bounded::tests::a_board_of_two_checks_survives_a_tenth_of_noise",
        1,
    ),
    Break(
        "Recovery is blind: it does not know the scene",
        "src/recovery/pixelwise/pinv.rs",
        "use super::{Inverse, decompose};",
        "use super::{Inverse, decompose};\nuse crate::scene::Scene as _;",
        "architecture",
        "blind_recovery",
        1,
    ),
    Break(
        "The model samples nothing and the tracer knows no model",
        "src/transport/context.rs",
        "use crate::scene::Scene;",
        "use crate::model::Kernel as _;\nuse crate::scene::Scene;",
        "architecture",
        "two_witnesses",
        1,
    ),
    Break(
        "Imports point down only",
        "src/num/stream.rs",
        "use super::{poisson, warp};",
        "use super::{poisson, warp};\nuse crate::lab::finding::Finding as _;",
        "architecture",
        "arrows_point_down",
        1,
    ),
    Break(
        "No circle of files inside a folder",
        "src/num/warp.rs",
        "use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};",
        "use super::stream::Stream as _;\nuse std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};",
        "architecture",
        "no_circle_of_files_in_any_folder",
        2,
    ),
    Break(
        "A frame that claims more than its file holds takes no memory",
        "src/film/exr/mod.rs",
        "Some(n) if n > 0 && n <= limit => Ok(()),",
        "Some(n) if n > 0 => Ok(()),",
        "lib",
        "film::exr::tests::a_claim_larger_than_the_file_is_refused_before_memory_is_taken",
        4,
    ),
    Break(
        "A damaged shard is refused, each fault by its own message",
        "src/jobs/blocks.rs",
        "if !file.closes().map_err(unreadable)? {",
        "if !file.closes().map_err(unreadable)? && header.parts.is_empty() {",
        "cli",
        "many::spoilt_and_foreign_shards_are_refused_each_by_its_own_words",
        1,
    ),
    Break(
        "No changed bit of a shard goes unseen",
        "src/jobs/blocks.rs",
        "if !file.closes().map_err(unreadable)? {",
        "if !file.closes().map_err(unreadable)? && header.parts.is_empty() {",
        "lib",
        "jobs::tests::no_change_goes_unseen",
        1,
    ),
    Break(
        "`serve` shows no hidden file",
        "src/cli/serve/folder.rs",
        "        && !segment.starts_with('.')\n",
        "",
        "cli",
        "serving::nothing_outside_the_folder_is_shown",
        1,
    ),
    Break(
        "Bad settings end with exit code 2",
        "src/cli/failure.rs",
        "(_, Codes::Plain) => 2,",
        "(_, Codes::Plain) => 1,",
        "cli",
        "bad_settings::of_tracing",
        1,
    ),
    Break(
        "The published layout of spots",
        "src/scene/spots.rs",
        "side(&|k| [cx - half + offset(k), cy - step(k)]),",
        "side(&|k| [cx - half - offset(k), cy - step(k)]),",
        "lib",
        "scene::spots::tests::the_square_is_the_published_one",
        1,
    ),
    Break(
        "A folder has one writer",
        "src/store/lock.rs",
        "        refuse_others(folder, parts)?;\n",
        "",
        "cli",
        "writers::who_comes_second_is_refused_and_a_killed_writer_is_no_obstacle",
        5,
    ),
    Break(
        "No run is replaced unasked",
        "src/cli/run_folder.rs",
        "Some(there) => return Err(other_run(path, &there, scene)),",
        "Some(_) => folder.remove_run()?,",
        "cli",
        "replacing::other_settings_are_refused_unless_they_are_to_replace",
        5,
    ),
    Break(
        "A changed file of a finished run is found",
        "src/folder/record/vouching.rs",
        "if written.is_at(&path)? {",
        "if written.is_at(&path).is_ok() {",
        "cli",
        "digests::a_flipped_bit_is_found_in_every_file_of_a_run",
        5,
    ),
    Break(
        "The model sees past what the tracer sees past",
        "src/geometry/pieces.rs",
        "heights.extend(rest.iter().map(|w| n.dot(w.at()) - d));",
        "heights.extend(rest.iter().map(|w| n.dot(w.at()) - d - 0.02));",
        "physics",
        "occluders::the_model_sees_past_what_the_tracer_sees_past",
        5,
    ),
    Break(
        "A study of occluders counts the directions that traced light tells",
        "src/lab/grey.rs",
        "sigma.iter().filter(|s| **s * BEFORE > *level).count()",
        "sigma.iter().filter(|s| **s > *level).count()",
        "cli",
        "occluders::the_study_counts_what_traced_light_tells",
        4,
    ),
    Break(
        "A study of occluders goes on past places that hide the whole view",
        "src/lab/grey.rs",
        "self.phi.amax() == 0.0",
        "self.phi.amax() < 0.0",
        "lib",
        "lab::occluder::tasks::tests::darkness_tells_nothing",
        1,
    ),
    Break(
        "Of a pattern and a smooth surface what is expected to be nearer comes first",
        "src/lab/likelier.rs",
        "likeliest.patterns.is_some() && loss(next, &known) < loss(likeliest, &known)",
        "likeliest.patterns.is_some() && loss(next, &known) < 0.0",
        "lib",
        "lab::likelier::tests::what_is_expected_to_be_nearer_comes_first",
        1,
    ),
    Break(
        "Probabilities that are not to be believed put no pattern first",
        "src/lab/trust.rs",
        "object.log_evidence.filter(|_| believed)",
        "object.log_evidence.filter(|_| believed || object.light.is_some())",
        "lib",
        "lab::trust::tests::what_explains_comes_first_and_what_is_likeliest_before_it",
        1,
    ),
    Break(
        "Powers of two multiply as libm has it",
        "src/num/linalg/mod.rs",
        "let is_normal = (-1022..=1023).contains(&n);",
        "let is_normal = (-1080..=1023).contains(&n);",
        "lib",
        "num::linalg::tests::powers_of_two_multiply_as_libm_has_it",
        1,
    ),
    Break(
        "Photographs past a misplaced occluder fit no picture",
        "src/cli/recovered.rs",
        "return Ok(Outcome::Disagreed);",
        "return Ok(Outcome::Done);",
        "cli",
        "occluders::a_misplaced_occluder_does_not_fit",
        5,
    ),
    Break(
        "Cells of an element are seen from as many places along either axis as there are cells",
        "src/model/cells.rs",
        "let reversed = flipped.reverse_bits().checked_shr(32 - h).unwrap_or(0);",
        "let reversed = flipped.min((1 << h) / 2);",
        "lib",
        "model::cells::tests::viewpoints_have_as_many_places_along_an_axis_as_there_are_cells",
        6,
    ),
    Break(
        "A mask along the elements is modelled to 1e-3",
        "src/model/occlusion.rs",
        "self.opaque.from(cell.viewpoint, own, self.scene.bvh())",
        "self.opaque.from(cell.point.position, own, self.scene.bvh())",
        "physics",
        "occluders::a_mask_along_the_elements_is_modelled_to_a_thousandth",
        7,
    ),
    Break(
        "Pieces in sight grow as those of displaced plates (finite differences)",
        "src/geometry/moving.rs",
        "let dt = (h * dk - k * dh) / ((h - k) * (h - k));",
        "let dt = (h * dk + k * dh) / ((h - k) * (h - k));",
        "lib",
        "geometry::moving::tests::pieces_in_sight_grow_as_those_of_displaced_plates",
        6,
    ),
    Break(
        "The light past occluders changes as that of displaced ones (finite differences)",
        "src/model/sweep/lit.rs",
        "(moved * area + light * grown[k]) * cell.area / whole",
        "moved * area * cell.area / whole",
        "lib",
        "model::sweep::tests::rates_are_those_of_displaced_occluders",
        6,
    ),
    Break(
        "A calibrated scene that has changed is told",
        "src/cli/load_run.rs",
        "    if account.exists() {",
        "    if account.exists() && dir.as_os_str().is_empty() {",
        "cli",
        "calibrating::a_rendered_scene_is_as_it_is_written",
        6,
    ),
    Break(
        "The errors of a render past an occluder are told against light past it",
        "src/lab/convergence.rs",
        "let integral = converged(&self.scene, Kernel::Physical, Extent::FULL)?;",
        "let integral = converged(&self.scene, Kernel::Physical, Extent::UNOBSTRUCTED)?;",
        "cli",
        "occluders::errors_fall_past_an_occluder_as_past_nothing",
        4,
    ),
    Break(
        "A slope of errors is known as well as its reference",
        "src/lab/convergence/slope.rs",
        "w.abs() * -libm::log1p(-bound / s.error)",
        "-0.5 * w.abs() * libm::log1p(-bound / s.error)",
        "lib",
        "lab::convergence::tests::a_slope_is_known_as_well_as_its_reference",
        4,
    ),
    Break(
        "A photograph stands upright as its camera noted",
        "src/image/orientation.rs",
        "6 => [last_j, i],",
        "6 => [j, last_i],",
        "lib",
        "image::tests::photographs::the_noted_orientation_is_applied",
        4,
    ),
    Break(
        "Imported flux has the ratio of the two cameras' étendues",
        "src/photographs/footprints.rs",
        "Some([area / (r2 * r2) / own, own])",
        "Some([area / r2 / own, own])",
        "lib",
        "photographs::footprints::tests::the_ratio_of_etendues_is_that_of_the_cameras",
        4,
    ),
    Break(
        "Gain and read noise of a real camera come from its repeats",
        "src/photographs/noise.rs",
        "xx += weight * g.signal * g.signal;",
        "xx += 1.2 * weight * g.signal * g.signal;",
        "lib",
        "photographs::noise::tests::gain_and_read_noise_come_back",
        4,
    ),
    Break(
        "Marks give perspective and distortion of the camera",
        "src/photographs/lens.rs",
        "x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),\n            y * radial",
        "x * radial + 1.9 * p1 * x * y + p2 * (r2 + 2.0 * x * x),\n            y * radial",
        "lib",
        "photographs::lens::tests::distortion_is_that_of_the_definition",
        4,
    ),
    Break(
        "Integers of MATLAB and NumPy are those that were saved",
        "src/matrix/array.rs",
        "at -= strides[axis] * shape[axis];",
        "at -= strides[axis];",
        "lib",
        "matrix::mat::tests::variables_are_those_that_scipy_saved",
        4,
    ),
    Break(
        "An array of MATLAB 7.3 is that of version 5, in chunks too",
        "src/matrix/mat/hdf5/chunks.rs",
        "from = from * self.chunk[axis] + index[axis];",
        "from = from * self.shape[axis] + index[axis];",
        "lib",
        "matrix::mat::version73::tests::chunks_are_the_array_in_one_piece",
        4,
    ),
    Break(
        "A pattern of two values is found in any unit",
        "src/recovery/joint/pattern_search/starts.rs",
        "Levels::Within(top) => (Dark::Free, top.min(BRIGHTEST)),",
        "Levels::Within(top) => (Dark::Free, top.min(BRIGHTEST / 10.0)),",
        "lib",
        "recovery::joint::two_valued::tests::a_pattern_is_found_whatever_the_unit",
        6,
    ),
    Break(
        "Patterns of two unknown levels are found where little noise sets them apart",
        "src/recovery/joint/pattern_lattice.rs",
        "let off = share * along.norm();",
        "let off = 0.0 * along.norm();",
        "lib",
        "recovery::joint::two_valued::boards::the_search_reaches_what_made_the_photographs",
        5,
    ),
    Break(
        "Probabilities of patterns hold where most are drawn, not listed",
        "src/recovery/joint/sampler.rs",
        "pattern(&drawn.point).filter(|light| !self.list.contains_key(light))?;",
        "pattern(&drawn.point)?;",
        "lib",
        "recovery::joint::two_valued::tests::drawn_patterns_make_up_for_those_that_are_not_listed",
        6,
    ),
    Break(
        "The prior of alike neighbours on a wide grid is that of the expansion of high temperatures",
        "src/recovery/joint/neighbours.rs",
        "turn((dark_left, light_left), [same, other]);",
        "turn((dark_left, light_left), [same, same]);",
        "lib",
        "recovery::joint::neighbours::tests::wide_grids_follow_the_expansion_of_high_temperatures",
        6,
    ),
    Break(
        "Photographs of a scale that is not known share one error of the stated size",
        "src/lab/noise/stage.rs",
        "let scale = 1.0 + error * stream(seed).normal();",
        "let scale = 1.0 + 0.9 * error * stream(seed).normal();",
        "lib",
        "lab::noise::stage::tests::a_scale_is_common_to_all_entries",
        5,
    ),
    Break(
        "A calibrated scene is written along the axes of its file",
        "src/scene/displaced/written.rs",
        "let motion = &(placed * *axes);",
        "let motion = &(*axes * placed);",
        "lib",
        "scene::axes::tests::a_displaced_scene_keeps_its_axes",
        1,
    ),
    Break(
        "Joint methods are told of the scale's error, and are nearer for it",
        "src/lab/ensemble.rs",
        "scale_error: self.scale_error.filter(|_| method.is_joint()),",
        "scale_error: self.scale_error.filter(|_| !method.is_joint()),",
        "lib",
        "lab::noise::tests::a_recovery_that_is_told_of_the_scale_is_nearer",
        6,
    ),
    Break(
        "Points of a lattice are drawn with the probability that is told",
        "src/num/lattice.rs",
        "log_probability += libm::log(weight / all);",
        "log_probability += libm::log(weight);",
        "lib",
        "num::lattice::tests::points_of_chance_have_the_probability_that_is_told",
        4,
    ),
    Break(
        "A reduced basis spans the lattice and is short",
        "src/num/lattice.rs",
        "(cosine * x + sine * y, cosine * y - sine * x)",
        "(cosine * x + sine * y, cosine * y + sine * x)",
        "lib",
        "num::lattice::tests::reduced_bases_are_what_they_are_said_to_be",
        7,
    ),
    Break(
        "A pattern's weight is the integral over its levels, between any contrasts",
        "src/recovery/joint/levels.rs",
        "[a + least, (a + most).min(1.0)]",
        "[a, (a + most).min(1.0)]",
        "lib",
        "recovery::joint::levels::tests::weights_are_integrals_over_the_triangle",
        7,
    ),
    Break(
        "Where entries share their errors no error of the picture is given",
        "src/lab/objects.rs",
        "judged.shared().map(|_|",
        "judged.shared().filter(|_| false).map(|_|",
        "cli",
        "recovery::shared_errors_give_no_errors_of_the_picture",
        6,
    ),
    Break(
        "A modulation is lost relative to that of the picture itself",
        "src/lab/noise/curve.rs",
        "let own = |mtf: Option<f64>| mtf.filter(|m| *m > 0.0).unwrap_or(1.0);",
        "let own = |_: Option<f64>| 1.0;",
        "lib",
        "lab::noise::tests::a_mean_that_strays_has_not_fallen",
        6,
    ),
    Break(
        "Hidden surfaces and walls refined apart give the light that they have refined together",
        "src/model/converged.rs",
        "(&hidden.phi - hidden_joined)",
        "2.0 * (&hidden.phi - hidden_joined)",
        "lib",
        "model::converged::tests::apart_is_together",
        1,
    ),
    Break(
        "A study of noise takes the frames that a scene gives its sensor",
        "src/lab/noise/named_sensor.rs",
        "own.frames.unwrap_or(1)",
        "own.frames.map_or(1, |_| 1)",
        "lib",
        "lab::noise::stage::tests::the_scenes_frames_are_taken",
        1,
    ),
    Break(
        "Elements that differ from their level are weighed against two levels (whole sums, by hand)",
        "src/recovery/joint/spread.rs",
        "log_evidence: summed.log_evidence - 0.5 * (log_det + beside),",
        "log_evidence: summed.log_evidence,",
        "lib",
        "recovery::joint::spread::tests::errors_are_those_of_all_patterns_levels_and_spreads",
        1,
    ),
    Break(
        "An inverse of the laser side refuses one spot",
        "src/recovery/pixelwise/mod.rs",
        "    if spots > 1 || elements == 1 || method",
        "    if spots > 0 || elements == 1 || method",
        "lib",
        "lab::doubt::tests::an_inverse_of_few_spots_says_so",
        1,
    ),
    Break(
        "The part of the variance that dark frames share is that of the law",
        "src/photographs/correct.rs",
        "common += dark * scale * scale / variance[k];",
        "common += dark / variance[k];",
        "lib",
        "photographs::correct::tests::flux_and_variance_are_those_of_the_law",
        1,
    ),
    Break(
        "A mesh of the rectangle has the rectangle's truth, model and recovery",
        "src/scene/element.rs",
        "(Shape::Instance(body), Division::Cells) if !body.is_exact_patch() => {",
        "(Shape::Instance(body), Division::Cells) if body.area() > 0.0 => {",
        "physics",
        "meshes::a_mesh_of_the_rectangle_has_its_truth_model_and_recovery",
        4,
    ),
    Break(
        "A textured sphere of triangles is integrated within its bound",
        "src/model/place.rs",
        "        area: area * share,\n",
        "        area: 1.0003 * area * share,\n",
        "physics",
        "meshes::a_textured_sphere_is_integrated_within_its_bound",
        8,
    ),
    Break(
        "A concave face has its light whatever its first corner",
        "src/scene/mesh/polygon.rs",
        "    if is_convex(&outline) {",
        "    if is_convex(&outline) || size > 0.0 {",
        "physics",
        "meshes::a_concave_face_has_its_light_whatever_its_first_corner",
        5,
    ),
    Break(
        "Elements that would lie in several places are refused",
        "src/scene/coordinates.rs",
        "*others |= tile != piece.tile;",
        "*others |= tile != piece.tile && false;",
        "physics",
        "meshes::coordinates_over_several_tiles",
        6,
    ),
    Break(
        "PLY strips are named as what they are",
        "src/scene/mesh/ply.rs",
        '"tristrips" | "trifans" if element.count > 0 => {',
        '"tristrips" | "trifans" if element.count > 1 => {',
        "lib",
        "scene::mesh::tests::formats::strips_of_a_ply_are_named",
        2,
    ),
    Break(
        "Sparse accessors of glTF replace single elements",
        "src/scene/mesh/gltf/accessor.rs",
        "            bytes[at..at + size].copy_from_slice(values.of(k, size));\n",
        "",
        "lib",
        "scene::mesh::tests::scenes::sparse_accessors_replace_single_elements",
        1,
    ),
    Break(
        "Colours of a mesh, which are not used, are told",
        "src/scene/surface_tables/shape.rs",
        "if let Some(paint) = told.paint {",
        "if let Some(paint) = told.paint.filter(String::is_empty) {",
        "cli",
        "suspicious::colours_of_a_mesh_are_told_and_not_used",
        1,
    ),
    Break(
        "One photograph of many pixels is reduced strip by strip to its own rows (objective, covariance and rank by hand)",
        "src/recovery/joint/stacked.rs",
        "Some(i) => at(first + i, k),",
        "Some(i) => at(i, k),",
        "lib",
        "recovery::joint::khatri_rao::tests::one_tall_photograph_is_its_rows",
        1,
    ),
    Break(
        "The field of errors is the likeliest there is (all entries' likelihood as one dense matrix)",
        "src/recovery/joint/error_field.rs",
        "left.row(k).norm_squared() + spread[k] + frames as f64 * leverage[k]",
        "left.row(k).norm_squared()",
        "lib",
        "recovery::joint::error_field::tests::the_field_is_the_likeliest",
        1,
    ),
    Break(
        "Errors of the geometry allow for what neighbours share (coverage over draws of a known field)",
        "src/lab/calibrate/posterior.rs",
        "Some(frame) => along_cosines(&light, frame),",
        "Some(_) => light,",
        "lib",
        "lab::calibrate::tests::errors_allow_for_what_neighbours_share",
        1,
    ),
    Break(
        "The errors that calibrate finds are the likeliest (the likelihood beside them)",
        "src/lab/calibrate/posterior.rs",
        "left[k] * left[k] + spread.column(k).norm_squared() + taken[k]",
        "left[k] * left[k]",
        "lib",
        "lab::calibrate::tests::likelihoods_of_different_errors_are_comparable",
        1,
    ),
    Break(
        "Likelihoods of different errors are comparable (all entries as one dense matrix)",
        "src/lab/calibrate/field.rs",
        "all += gram.log_det();",
        "",
        "lib",
        "lab::calibrate::tests::likelihoods_of_different_errors_are_comparable",
        1,
    ),
    Break(
        "Normal equations summed strip by strip are those of the rows",
        "src/recovery/joint/gram.rs",
        "let firsts = (0..pixels).step_by(STRIP);",
        "let firsts = (0..pixels.min(STRIP)).step_by(STRIP);",
        "lib",
        "recovery::joint::gram::tests::it_is_the_objective_of_the_rows",
        2,
    ),
    Break(
        "Light by the number of surfaces met is read back from the frames of a run",
        "src/folder/whole.rs",
        "film::frame::bounce_channel(n + 1)",
        "film::frame::bounce_channel(n + 2)",
        "lib",
        "folder::whole::tests::light_by_bounces_is_read_back",
        1,
    ),
    Break(
        "A changed file of a published item is told, and the item computed again",
        "src/folder/item.rs",
        "files.find(|file| !is_whole(file))",
        "files.find(|file| !is_whole(file) && file.is_empty())",
        "cli",
        "reproducing::changed_items_are_told_and_computed_again",
        5,
    ),
    Break(
        "A changed account of imported photographs is found",
        "src/cli/load_run.rs",
        "for name in [IMPORT, IMPORT_PNG] {",
        "for name in [IMPORT_PNG, IMPORT_PNG] {",
        "cli",
        "importing::a_changed_account_is_found",
        4,
    ),
    Break(
        "The files of a recovery stay until those of the next are there",
        "src/cli/recovered.rs",
        "    remove_abandoned(folder)?;\n",
        "    remove_abandoned(folder)?;\n    remove_named(folder, &[\"picard-joint.csv\", \"picard-joint.svg\"])?;\n",
        "cli",
        "replacing::the_files_of_a_recovery_outlive_one_that_is_not_written",
        5,
    ),
    Break(
        "Meshes that do not fit are refused before they are made",
        "src/scene/body.rs",
        "const FACE: f64 = 640.0;",
        "const FACE: f64 = 6.4;",
        "cli",
        "memory::meshes_of_scenes_are_refused_before_they_are_taken",
        5,
    ),
    Break(
        "Frames that no file holds are refused by whoever would take them",
        "src/jobs/need.rs",
        "pub fn study(scene: &Scene) -> Result<(), NoRoom> {\n    frames(scene)?;\n",
        "pub fn study(scene: &Scene) -> Result<(), NoRoom> {\n",
        "cli",
        "memory::frames_that_no_file_holds_are_refused_at_once",
        5,
    ),
    Break(
        "A sweep follows the law of one element (closed form)",
        "src/lab/grey.rs",
        "Ok(1.0 - shares.rank / self.model.albedo.len() as f64)",
        "Ok(1.0 - 0.99 * shares.rank / self.model.albedo.len() as f64)",
        "cli",
        "studies::a_sweep_follows_the_law_of_one_element",
        1,
    ),
    Break(
        "A wall parallel to z is refused for what it is",
        "src/scene/axes.rs",
        "(stands(first) && walls.all(stands)).then(|| {",
        "(stands(first) && walls.any(stands)).then(|| {",
        "cli",
        "bad_scenes::a_wall_parallel_to_z",
        1,
    ),
    Break(
        "Points that serve all pixels and spots know the BRDF between the walls (quadrature)",
        "src/transport/glossy.rs",
        "self.material.brdf(self.albedo, *wi, wo)",
        "self.material.brdf(self.albedo, wo, wo)",
        "physics",
        "brdf::a_glossy_hidden_surface_is_traced_as_it_is",
        3,
    ),
    Break(
        "A render that is told nothing reaches 1 % where others than the hidden reflect (ten renders)",
        "src/lab/aim.rs",
        "(MARGIN * error / AIM).powi(2)",
        "(MARGIN * error / AIM)",
        "lib",
        "lab::aim::tests::what_is_chosen_reaches_its_aim",
        3,
    ),
    Break(
        "A mesh blocks what passes through it (half-spaces of a tetrahedron)",
        "src/geometry/instance/rays.rs",
        "high[axis] + by - o]",
        "0.5 * (low[axis] + high[axis]) + by - o]",
        "lib",
        "geometry::instance::tests::segments_are_blocked_by_what_they_pass_through",
        1,
    ),
    Break(
        "What is fitted first is as if it were fitted together with a deviation (normal equations of all)",
        "src/lab/eliminated.rs",
        "            left -= model * along;",
        "            left -= model * (0.5 * along);",
        "lib",
        "lab::other_light::tests::what_is_fitted_first_is_as_if_fitted_together",
        7,
    ),
    Break(
        "Counts beside other light are rejected as often as stated",
        "src/lab/agreement.rs",
        "let free = entries.saturating_sub(fitted).max(1) as f64;",
        "let free = entries.saturating_add(fitted).max(1) as f64;",
        "physics",
        "counts::a_right_model_is_rejected_as_often_as_stated",
        7,
    ),
    Break(
        "Factors that a frame shares are no scatter of its rows",
        "src/lab/residual.rs",
        "Errors::WithinRows | Errors::Everywhere => self.of_factors(d),",
        "Errors::WithinRows | Errors::Everywhere => 0.0 * self.of_factors(d),",
        "physics",
        "counts::a_laser_that_drifts_is_no_wrong_model",
        8,
    ),
    Break(
        "An image of all frames is taken out together with what each has of its own",
        "src/lab/eliminated/background.rs",
        "left - patterns(&self.light(&image))",
        "left - self.light(&image)",
        "lib",
        "lab::other_light::tests::what_is_fitted_first_is_as_if_fitted_together",
        6,
    ),
    Break(
        "Bands of photographs that nothing explains cover nothing",
        "src/lab/coverage/trial.rs",
        "t.bands.as_ref().map_or(0, |b| b.covered(truth)) as f64 / r",
        "t.bands.as_ref().map_or(truth.len(), |b| b.covered(truth)) as f64 / r",
        "lib",
        "lab::coverage::tests::draws_that_agree_are_not_certain",
        8,
    ),
    Break(
        "Levels where neighbours may be alike are those of all patterns and couplings",
        "src/recovery/joint/neighbours.rs",
        "|(beta, rest)| beta * alike + rest);",
        "|(beta, rest)| 0.5 * beta * alike + rest);",
        "lib",
        "recovery::joint::neighbours::tests::levels_are_those_of_all_patterns_where_neighbours_may_be_alike",
        8,
    ),
    Break(
        "Patterns drawn where neighbours may be alike have the weights of all patterns",
        "src/recovery/joint/pattern_likelihood.rs",
        "log: weighed.log + beforehand,",
        "log: weighed.log + 0.5 * beforehand,",
        "lib",
        "recovery::joint::two_valued::boards::sampled_marginals_are_those_of_all_patterns",
        8,
    ),
    Break(
        "Each size of fields is as likely beforehand",
        "src/recovery/joint/fields.rs",
        "log_evidence: whole - libm::log(sizes as f64),",
        "log_evidence: whole,",
        "lib",
        "recovery::joint::fields::tests::sums_are_those_of_all_patterns_by_the_prior",
        8,
    ),
    Break(
        "Errors of a settled picture are of the prior that it goes by",
        "src/recovery/joint/spread.rs",
        "fields::sum(&own, sizes, &[light.to_vec()], (DRAWS, None))?",
        "fields::sum(&own, &[Fields::even(light.len())], &[light.to_vec()], (DRAWS, None))?",
        "lib",
        "recovery::joint::spread::tests::errors_are_those_of_all_patterns_levels_and_spreads",
        8,
    ),
    Break(
        "A model whose light is not seen is no agreement",
        "src/lab/validation.rs",
        "z <= sidak_threshold(test.significance, 1)",
        "z < -sidak_threshold(test.significance, 1)",
        "physics",
        "counts::a_model_whose_light_is_not_seen_is_no_agreement",
        8,
    ),
    Break(
        "How much likelier a field of errors is than noise is a ratio of likelihoods (one dense matrix)",
        "src/recovery/joint/error_field.rs",
        "Some(Cholesky::new(&gram)?.log_det())",
        "Some(0.5 * Cholesky::new(&gram)?.log_det())",
        "lib",
        "recovery::joint::error_field::tests::the_field_is_the_likeliest",
        8,
    ),
    Break(
        "A shadow moves with what casts it and with where it is seen from",
        "src/model/sweep.rs",
        "surfaces[id as usize].at(x) - carried[k])",
        "surfaces[id as usize].at(x))",
        "lib",
        "model::sweep::tests::rates_are_those_of_displaced_scenes",
        9,
    ),
    Break(
        "What a finer rule of integration moves is in the errors of `calibrate`",
        "src/lab/calibrate/finish.rs",
        "let rule = rule.unwrap_or(0.0);",
        "let rule = 0.0 * rule.unwrap_or(0.0);",
        "lib",
        "lab::calibrate::tests::what_the_integration_leaves_is_in_the_errors",
        9,
    ),
    Break(
        "`joint-gp` knows by how much its errors rest on neighbours that are alike",
        "src/recovery/joint/gaussian_process/mixture.rs",
        "if triple.length == 0 && triple.variance.spread",
        "if triple.length == 5 && triple.variance.spread",
        "lib",
        "recovery::joint::gaussian_process::tests::errors_of_elements_that_are_not_alike_are_told",
        9,
    ),
    Break(
        "and says so where the photographs do not",
        "src/lab/doubt/errors.rs",
        "times > LARGER &&",
        "times > 100.0 * LARGER &&",
        "lib",
        "lab::doubt::tests::how_alike_elements_are_is_told_or_not",
        9,
    ),
    Break(
        "Errors of any form refute no right photographs",
        "src/lab/fit/attainable.rs",
        "misfit } if misfit > ROUGH)",
        "misfit } if misfit > 100.0 * ROUGH)",
        "lib",
        "lab::doubt::tests::errors_of_any_form_refute_nothing",
        9,
    ),
    Break(
        "A cause that leaves more than chance says so",
        "src/lab/verdict/causes.rs",
        "let more = if explains {",
        "let more = if explains || left < 0.5 {",
        "lib",
        "lab::verdict::causes::tests::what_explains_not_all_says_so",
        9,
    ),
    Break(
        "Of few replicates no deviation is fitted",
        "src/lab/validation.rs",
        "const FEWEST: u32 = 6;",
        "const FEWEST: u32 = 2;",
        "physics",
        "verdict_past::two_replicates_tell_no_deviation",
        9,
    ),
    Break(
        "Light that the model lacks is told",
        "src/lab/unmodelled.rs",
        "if lit > 0 &&",
        "if lit > 99 &&",
        "physics",
        "verdict_past::light_that_the_model_lacks_is_told",
        9,
    ),
    Break(
        "An occluder that is elsewhere is named",
        "src/lab/derivatives.rs",
        "for shift in found.shaded.shifts.clone() {",
        "for shift in found.shaded.shifts.clone().split_off(1) {",
        "physics",
        "verdict_past::a_plate_that_is_elsewhere_is_named",
        9,
    ),
    Break(
        "A factor of all light is averaged over, not fitted with the picture",
        "src/recovery/joint/linear.rs",
        "let mean = -common * square(nuisance.scale_error);",
        "let mean = -0.0 * common * square(nuisance.scale_error);",
        "lib",
        "recovery::joint::gauss_newton::tests::a_factor_of_all_is_averaged_over_not_fitted_with_the_picture",
        10,
    ),
    Break(
        "Factors of single frames do not lessen the picture",
        "src/recovery/joint/linear.rs",
        "let frame_mean = &frames * -square(nuisance.frame_gain);",
        "let frame_mean = &frames * -0.0 * square(nuisance.frame_gain);",
        "lib",
        "recovery::joint::gauss_newton::tests::factors_of_frames_do_not_lessen_the_picture",
        10,
    ),
    Break(
        "What the model's integrals leave over refutes no picture",
        "src/lab/fit.rs",
        "sum + step.abs()",
        "sum + step.abs() * 0.1",
        "lib",
        "lab::fit::tests::what_integrals_leave_over_is_no_evidence",
        10,
    ),
    Break(
        "Errors from three replicates are pooled: bands hold what they say",
        "src/lab/pooled.rs",
        "(prior * product.at(at) + nu * variance[at]) / (prior + nu)",
        "(0.0 * prior * product.at(at) + nu * variance[at]) / nu",
        "lib",
        "lab::pooled::tests::bands_from_three_replicates_hold_what_they_say",
        10,
    ),
    Break(
        "Deviates over pooled errors are Student's (Smyth 2004), of the degrees of freedom that are stated",
        "src/lab/pooled.rs",
        "freedom_of_log_variance(beyond.max(0.0) + stderr + own)",
        "freedom_of_log_variance(0.01 * beyond.max(0.0) + stderr + own)",
        "lib",
        "lab::pooled::tests::deviates_over_pooled_errors_follow_students_law",
        9,
    ),
    Break(
        "What the model's integrals move of a picture is told in its standard errors",
        "src/lab/fit/integrated.rs",
        "sum += (other.reflectance - &found.reflectance).abs();",
        "sum += 0.2 * (other.reflectance - &found.reflectance).abs();",
        "lib",
        "lab::fit::tests::what_integrals_move_is_told_in_standard_errors",
        10,
    ),
    Break(
        "A measured BRDF gives back no more than it receives, at any of its angles (closed form)",
        "src/scene/material/grid.rs",
        "|t| libm::sin(t) * libm::cos(t)",
        "|t| libm::sin(t)",
        "lib",
        "scene::material::grid::tests::what_is_reflected_is_the_closed_form",
        10,
    ),
    Break(
        "Of counts and of relative noise the light as a whole is right: variances are of the light expected",
        "src/matrix/expected.rs",
        "(with[at] - h * filled[at]) / (1.0 - h)",
        "0.5 * (with[at] + filled[at])",
        "lib",
        "matrix::expected::tests::expected_light_weighs_without_bias",
        10,
    ),
    Break(
        "A place is searched as finely as its error",
        "src/lab/located.rs",
        "is_fine || is_end ||",
        "is_fine || peak.is_some() || is_end ||",
        "lib",
        "lab::located::tests::little_noise_is_searched_as_finely",
        10,
    ),
    Break(
        "A turn is found with the sign of the scene's parameter",
        "src/lab/misplaced.rs",
        "axis.dot(along_v) < 0.0",
        "axis.dot(along_v) > 0.0",
        "lib",
        "lab::located::tests::yaw_turns_as_the_parameter_does",
        9,
    ),
    Break(
        "A gain's error is one of the frame: entries leave it out, and what inverts them takes it",
        "src/photographs/account.rs",
        ".filter(|most| *most > 0.0)",
        ".filter(|most| *most > 1.0)",
        "cli",
        "importing::a_list_says_what_the_photographs_are",
        10,
    ),
]


def table() -> str:
    """Markdown, a line a claim."""
    lines = ["| claim | test | fails when |", "| --- | --- | --- |"]
    for b in BREAKS:
        lines.append(f"| {b.claim} | `{b.target}` `{b.test}` | `{b.file}`: {changed(b)} |")
    return "\n".join(lines) + "\n"


def changed(b: Break) -> str:
    """The fault in one line."""
    show = lambda text: "`" + " ".join(text.split()).replace("|", "\\|") + "`"
    return f"{show(b.old)} becomes {show(b.new)}" if b.new else f"{show(b.old)} is left out"


def source_of(target: str) -> list[pathlib.Path]:
    if target == "lib":
        return sorted((ROOT / "src").rglob("*.rs"))
    folder = ROOT / "tests" / target
    return sorted(folder.rglob("*.rs")) if folder.is_dir() else [folder.with_suffix(".rs")]


def check() -> list[str]:
    """What does not fit."""
    wrong = []
    for b in BREAKS:
        count = (ROOT / b.file).read_text().count(b.old) if (ROOT / b.file).exists() else 0
        if count != 1:
            wrong.append(f"{b.file} has {b.old!r} {count} times, not once")
        name = re.compile(rf"\bfn {b.test.split('::')[-1]}\(")
        if not any(name.search(path.read_text()) for path in source_of(b.target)):
            wrong.append(f"{b.target} has no test {b.test}")
    front = FRONT.read_text()
    if front.count(BEGIN) != 1 or front.split(BEGIN)[1].split(END)[0] != table():
        wrong.append("the table of tests/README.md is not that of --table")
    return wrong


def planted(copy: pathlib.Path, batch: list[Break]) -> None:
    """Plants the faults of a batch in the copy."""
    for file, old, new in sorted({(b.file, b.old, b.new) for b in batch}):
        path = copy / file
        path.write_text(path.read_text().replace(old, new, 1))


def seen(copy: pathlib.Path, batch: list[Break]) -> int:
    """Runs the tests of a batch; the number of those that failed, as they must."""
    failed = 0
    for target in sorted({b.target for b in batch}):
        tests = [b.test for b in batch if b.target == target]
        where = ["--lib"] if target == "lib" else ["--test", target]
        command = ["cargo", "test", "--locked", *where, "--", "--exact", "--include-ignored"]
        done = subprocess.run(
            command + tests, cwd=copy, capture_output=True, text=True, check=False
        )
        for test in tests:
            found = re.search(rf"^test {test} \.\.\. (\w+)$", done.stdout, re.MULTILINE)
            outcome = found[1] if found else "did not run"
            failed += outcome == "FAILED"
            print(f"{'fails' if outcome == 'FAILED' else 'WRONG: ' + outcome}  {test}", flush=True)
        if "test result" not in done.stdout:
            print(done.stderr[-2000:], flush=True)
    return failed


def run(words: list[str]) -> int:
    chosen = [b for b in BREAKS if not words or any(w in x for w in words for x in b[:-1])]
    copy = ROOT / "target/breaks"
    git = lambda *what, cwd=copy: subprocess.run(
        ["git", *what], cwd=cwd, capture_output=True, text=True, check=True
    ).stdout.strip()
    head = git("rev-parse", "HEAD", cwd=ROOT)
    if not copy.exists():
        git("worktree", "add", "--detach", str(copy), cwd=ROOT)
    failed = 0
    for number in sorted({b.batch for b in chosen}):
        git("reset", "--hard", head)
        batch = [b for b in chosen if b.batch == number]
        planted(copy, batch)
        failed += seen(copy, batch)
    git("reset", "--hard", head)
    print(f"{failed} of {len(chosen)} tests fail, as they must")
    return 0 if chosen and failed == len(chosen) else 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--check", action="store_true")
    what.add_argument("--table", action="store_true")
    what.add_argument("--run", nargs="*", metavar="WORD")
    asked = parser.parse_args()
    if asked.table:
        print(table(), end="")
        return 0
    wrong = check()
    print("\n".join(wrong), file=sys.stderr, end="\n" if wrong else "")
    if asked.check or wrong:
        return 1 if wrong else 0
    return run(asked.run)


if __name__ == "__main__":
    sys.exit(main())
