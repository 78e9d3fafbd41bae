//! phicam: a physically based Monte Carlo renderer for *indirect photography*, and the laboratory
//! around it.
//!
//! # The experiment
//!
//! A laser spot on a matt wall (S1) lights a surface that nobody can see (S2): it leans over the
//! wall around a corner. The light comes back to the wall (S3), where a pinhole camera photographs
//! it. The camera has no line of sight to the hidden surface; all it sees is a faint glow on the
//! wall, which changes a little with the spot. One photograph per laser spot, stacked as columns,
//! is the matrix \[Φcam\], pixels × spots.
//!
//! ```text
//!        laser, camera
//!             *                      S2, hidden
//!              \ \                  /
//!               \  \               /  ← reflectance to be recovered
//!                \   \            /
//!   ______________\____\_________/
//!                S1    S3      hinge
//! ```
//!
//! A matrix model says what that matrix should be, with absolute scale and no free factor:
//!
//! > Φcam\[p,l\] = Φlaser · E_p · (ρ3/π) · (ρ1/π) · Σ_j G23\[p,j\] · (ρ2_j/π) · A_j · G12\[j,l\]
//!
//! and inverting it gives ρ2, the picture of what was hidden. phicam *traces* the light without
//! knowing that model, writes the frames that the camera would store, stacks them, tests with
//! statistics whether model and transport agree, and recovers the hidden reflectance.
//!
//! A hidden surface may shine by itself (a monitor, a lamp) in place of the laser. Then one
//! photograph of the wall is taken, past an occluder whose shadows tell the elements apart. The
//! light meets S2 and S3 alone: D\[j\] = M·A_j takes the place of the laser's side, M the exitance
//! of a white element, and what is recovered is the picture x ∈ \[0, 1\] in the place of ρ2.
//!
//! | symbol | meaning | shape, unit |
//! | --- | --- | --- |
//! | p, r, l | camera pixels, resolution elements on S2, laser spots | counts |
//! | Φlaser | laser power that lands on the wall at the spot | W |
//! | ρ1, ρ2, ρ3 | albedo of the wall at the spot, of S2, of the wall in view; a Lambertian BRDF is ρ/π | 1; sr⁻¹ |
//! | G12 | cosθs12 · cosθd12 / R12² between spot and element | r × l, length⁻² |
//! | G23 | cosθs23 · cosθd23 / R23² between element and the wall point that the pixel sees | p × r, length⁻² |
//! | A_j | area of a resolution element | length² |
//! | E_p | étendue of pixel p: A_lens · cosθcam · Ω_p, Ω_p its solid angle seen from the pinhole | length² sr |
//! | Φcam | flux into each pixel for each spot | p × l, W |
//!
//! # The house
//!
//! Arrows point down only: a floor imports what is below it.
//!
//! ```text
//!    9  main.rs                      parse → run → exit code
//!    8  cli/         arguments, checked settings, progress, one file per subcommand; the only floor that prints
//!    7  report/      results → json, svg, png, html: results in, bytes out; page/script: what makes a page answer, in JavaScript
//!       folder/      what a run leaves on disk: its record, its frames, its matrices
//!       jobs/        long work in numbered blocks: results of blocks on disk, shards of a plan, going on after a stop
//!    6  lab/         experiments that compose the floors below, lowest first: uncertainty/ of photographs, comparison/ with the
//!                    model, recovered/ pictures, geometry/ that is found, studies/, run/, published/
//!    5  recovery/    Φcam → reflectance              metrics/   how far two things are apart
//!    4  transport/   the path tracer → Φcam          model/     G12, G23 → Φcam             sensor/  flux → electrons → counts
//!       photographs/ files of a real camera → Φcam
//!    3  film/        frames, EXR                     matrix/    pixels × spots, .npy, .mat
//!    2  scene/       laser, surface, texture, camera, scene file
//!    1  geometry/    basis, shapes, BVH              image/     PNG, JPEG, EXR, TIFF bytes ↔ pictures
//!       store        files: regular ones read through one door, whole ones written, one writer a folder
//!    0  num/         constants, streams (random and Sobol'), warps, quadrature, statistics, linear algebra, summation, wide arithmetic
//! ```
//!
//! Invariants, each kept by a test that reads the sources (`tests/architecture.rs`):
//!
//! 1. **Two witnesses.** [`transport`] and [`model`] never import each other. The model knows
//!    quadrature only, the tracer knows random streams and warps only. If they shared code, their
//!    agreement would prove nothing.
//! 2. **Blind recovery.** [`recovery`] imports [`num`] and [`matrix`] only; it never learns what
//!    scene it inverts.
//! 3. **One door per foreign crate**: obvhs only in `geometry/tree`, exr only in `film/exr` and
//!    `image/exr` (frames and pictures), png only in `image/png`, tiff only in `image/tiff`, matrix
//!    decompositions only in `num::linalg`, random generators only in [`num::stream`], the argument
//!    parser only in [`cli`]. And one door for files: only [`store`] opens them for reading.
//! 4. **A random number is a function of (seed, spot, pixel, sample block)**, never of the thread
//!    or the order. The same seed gives the same bytes. Blocks are added along one fixed binary
//!    tree (`num::tree`), so that any part of a computation can be done elsewhere or later, and
//!    comes out with the same bits.
//!
//! Rays travel in f32 inside the BVH only; every intersection, and every point that enters a
//! radiometric term, is computed in f64 on its own shape, and every sum is f64 in a fixed order.
//!
//! # Three programs
//!
//! Trace a scene made in code and compare it with the model:
//!
//! ```
//! use phicam::lab::{Against, Certainty, Integration, Measured, Test, validate};
//! use phicam::model::{Kernel, Occlusion};
//! use phicam::scene::{Scene, file::SceneFile};
//! use phicam::transport::{Budget, Control, Estimator, Plan, Sampling, render};
//!
//! // The bench with 8 spots in place of 120.
//! let mut file = SceneFile::default();
//! file.name = "toy".to_owned();
//! file.laser.as_mut().expect("the bench has a laser").spots.per_side = Some(2);
//! let scene = Scene::new(&file, None)?;
//!
//! // 64 paths for each pixel and spot.
//! let plan = Plan {
//!     estimator: Estimator::Independent,
//!     sampling: Sampling::Pcg,
//!     seed: 1,
//!     budget: Budget::new(64, Sampling::Pcg)?,
//! };
//! let traced = render(&scene, &plan, 0..scene.laser.spots.len(), Control::none())?;
//!
//! // Within the error bars at a significance of 0.1 %?
//! let test = Test { significance: 1e-3, known: Certainty::of(&plan) };
//! let measured = Measured::new(&traced.flux, &traced.stderr, None);
//! let against = |kernel| {
//!     let (integration, occlusion) = (Integration::Quadrature, Occlusion::Considered);
//!     validate(&scene, measured, Against { kernel, integration, occlusion }, test)
//! };
//! assert!(against(Kernel::Physical)?.agreement.agrees);
//! // The kernel of the published simulation is not what light does.
//! assert!(!against(Kernel::Published)?.agreement.agrees);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! * [`recovery`] has the second: reflectances from a matrix of one's own.
//! * [`lab`] has the third: a study of one's own, in one file.
//!
//! # Where to read on
//!
//! * [`cli::guide`](mod@cli::guide): the guide, from a tutorial to how to add a method.
//! * [`scene`]: what a scene is, and its file format key by key.
//! * [`transport`]: the integral that is estimated, and how.
//! * [`model`]: the matrices, and what they leave out.
//! * [`sensor`]: from the flux to what a camera stores, its noise, and the built-in sensors with
//!   their sources.
//! * [`photographs`]: from what a real camera has stored to the flux.
//! * [`lab`]: what "agree" means.
//! * [`recovery`]: the methods, their parameters, their uncertainty.
//! * [`lab::published`](mod@lab::published): the published study computed again, and the ledger of
//!   its contradictions.
//! * [`cli`]: what a run leaves on disk, and the exit codes of the program.
//! * [`cli::from_your_camera`](mod@cli::from_your_camera): photographs of a real bench, command by
//!   command.
//! * [`cli::many_machines`](mod@cli::many_machines): thousands of frames on a cluster, on Slurm and
//!   other schedulers.

#[cfg(feature = "cli")]
pub mod cli;
pub mod film;
#[doc(hidden)]
pub mod folder;
pub mod geometry;
#[doc(hidden)]
pub mod image;
#[doc(hidden)]
pub mod jobs;
pub mod lab;
pub mod matrix;
pub mod metrics;
pub mod model;
pub mod num;
pub mod photographs;
pub mod recovery;
#[doc(hidden)]
pub mod report;
pub mod scene;
pub mod sensor;
#[doc(hidden)]
pub mod store;
pub mod transport;
