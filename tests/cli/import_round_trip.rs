//! A modelled scene through a synthetic camera into files, and back by `phicam import`.
//!
//! The camera is made here, from its definition: rays from its eye through sub-pixels, whose
//! distortion is undone by fixed-point steps, meet the wall's plane; the solid angle of a sub-pixel
//! is that of its corners' directions. Nothing of it comes from `phicam::photographs`.

use phicam::image::{grey16_png, rgb_png};
use phicam::matrix::{Matrix, npy};
use phicam::model::{Kernel, MatrixModel};
use phicam::scene::Scene;
use phicam::scene::file::SceneFile;

use crate::workspace::Workspace;

/// Pixels of the fine scene along a side, and of the imported one.
const FINE: usize = 128;
const COARSE: usize = 16;
/// Pixels of the photographs.
const SIZE: [usize; 2] = [168, 132];
/// Sub-pixels along a side.
const SUB: usize = 4;
/// Photographs of each spot, and dark ones.
const REPEATS: usize = 4;
const DARK: usize = 32;

/// The bench with 24 spots and `pixels` × `pixels` pixels.
fn scene(pixels: usize) -> Scene {
    let mut file = SceneFile::default();
    file.camera.pixels = [pixels as u32; 2];
    file.laser.as_mut().unwrap().spots.per_side = Some(6);
    Scene::new(&file, None).unwrap()
}

/// Normal numbers from a generator of its own (SplitMix64, Box and Muller).
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// A pinhole above the bench's view, turned a little, with a distorting lens.
struct Camera;

const FX: f64 = 190.0;
const FY: f64 = 192.0;
const CX: f64 = 85.0;
const CY: f64 = 64.0;
const K1: f64 = -0.11;
const K2: f64 = 0.015;
const P1: f64 = 8e-4;
const P2: f64 = -5e-4;
/// The middle of the view, inches.
const MIDDLE: [f64; 2] = [4.875, 4.375];
/// The eye.
const EYE: [f64; 3] = [5.9, 3.7, 5.5];

type Vector = [f64; 3];

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: Vector) -> Vector {
    let n = dot(a, a).sqrt();
    a.map(|x| x / n)
}

impl Camera {
    /// Right, down and forwards: towards the middle of the view.
    fn axes() -> [Vector; 3] {
        let forwards = unit([MIDDLE[0] - EYE[0], MIDDLE[1] - EYE[1], -EYE[2]]);
        let right = unit(cross(forwards, [0.06, 1.0, 0.0]));
        [right, cross(forwards, right), forwards]
    }

    fn distorted([x, y]: [f64; 2]) -> [f64; 2] {
        let r2 = x * x + y * y;
        let radial = 1.0 + K1 * r2 + K2 * r2 * r2;
        [
            x * radial + 2.0 * P1 * x * y + P2 * (r2 + 2.0 * x * x),
            y * radial + P1 * (r2 + 2.0 * y * y) + 2.0 * P2 * x * y,
        ]
    }

    /// The direction of a place in the photograph, in the camera's axes, its last component 1.
    fn direction([u, v]: [f64; 2]) -> Vector {
        let to = [(u - CX) / FX, (v - CY) / FY];
        let mut at = to;
        for _ in 0..60 {
            let off = Self::distorted(at);
            at = [at[0] + to[0] - off[0], at[1] + to[1] - off[1]];
        }
        [at[0], at[1], 1.0]
    }

    /// Where the ray of a direction meets the wall.
    fn wall(direction: Vector) -> [f64; 2] {
        let axes = Self::axes();
        let ray = [0, 1, 2].map(|k| (0..3).map(|i| direction[i] * axes[i][k]).sum::<f64>());
        let t = -EYE[2] / ray[2];
        [EYE[0] + t * ray[0], EYE[1] + t * ray[1]]
    }

    /// The place in the photograph of a point of the wall.
    fn pixel([x, y]: [f64; 2]) -> [f64; 2] {
        let to = [x - EYE[0], y - EYE[1], -EYE[2]];
        let [a, b, c] = Self::axes().map(|axis| dot(to, axis));
        let [p, q] = Self::distorted([a / c, b / c]);
        [FX * p + CX, FY * q + CY]
    }

    /// Étendue of a small square of the photograph with an aperture of 1: cosθ·Ω.
    fn etendue(centre: [f64; 2], side: f64) -> f64 {
        let at = |a: f64, b: f64| Self::direction([centre[0] + a * side, centre[1] + b * side]);
        let corners = [at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
        let edge = |a: Vector, b: Vector| [0, 1, 2].map(|k| b[k] - a[k]);
        let diagonals = cross(edge(corners[0], corners[2]), edge(corners[1], corners[3]));
        let middle = at(0.0, 0.0);
        let r2 = dot(middle, middle);
        // Projected area over r², and the cosine at the aperture: the plane is at distance 1.
        0.5 * diagonals[2].abs() / r2 / r2
    }
}

/// Radiance of the wall for each spot, from the model's fine photographs; between their pixels'
/// middles it is bilinear, level beyond the outermost.
struct Wall {
    radiance: Matrix,
    view: [[f64; 2]; 2],
}

/// Flux into the fine pixels, divided by their étendue: A·h²/r⁴ times their area, at their middle.
fn etendues(scene: &Scene) -> Vec<f64> {
    let camera = &scene.camera;
    (0..camera.pixels())
        .map(|p| {
            let footprint = camera.footprint(p);
            let r2 = (footprint.at([0.5, 0.5]) - camera.position).length_squared();
            camera.aperture_area * footprint.area * camera.position.z.powi(2) / (r2 * r2)
        })
        .collect()
}

impl Wall {
    fn of(scene: &Scene, phi: &Matrix) -> Self {
        let etendue = etendues(scene);
        let view = &scene.camera.view;
        let (corner, u, v) = (view.corner(), view.u(), view.v());
        Self {
            radiance: Matrix::from_fn(phi.nrows(), phi.ncols(), |p, l| phi[(p, l)] / etendue[p]),
            view: [[corner.x, corner.y], [u.x, v.y]],
        }
    }

    /// Weights of fine pixels at a point of the wall.
    fn at(&self, point: [f64; 2]) -> [(usize, f64); 4] {
        let [i, j] = [0, 1].map(|k| {
            let t = (point[k] - self.view[0][k]) / self.view[1][k] * FINE as f64 - 0.5;
            let t = t.clamp(0.0, (FINE - 1) as f64);
            let first = (t as usize).min(FINE - 2);
            (first, t - first as f64)
        });
        let weight = |a: usize, b: usize| {
            let side = |(_, t): (usize, f64), k: usize| if k == 0 { 1.0 - t } else { t };
            (i.0 + a + (j.0 + b) * FINE, side(i, a) * side(j, b))
        };
        [weight(0, 0), weight(1, 0), weight(0, 1), weight(1, 1)]
    }

    /// Light into every pixel of the camera, with an aperture of 1, for every spot.
    fn photographed(&self) -> Matrix {
        let pixels = SIZE[0] * SIZE[1];
        let mut light = Matrix::zeros(pixels, self.radiance.ncols());
        let step = 1.0 / SUB as f64;
        for q in 0..pixels {
            for k in 0..SUB * SUB {
                let off = [k % SUB, k / SUB].map(|i| (i as f64 + 0.5) * step - 0.5);
                let centre = [(q % SIZE[0]) as f64 + off[0], (q / SIZE[0]) as f64 + off[1]];
                let point = Camera::wall(Camera::direction(centre));
                let etendue = Camera::etendue(centre, step);
                for (fine, weight) in self.at(point) {
                    for l in 0..light.ncols() {
                        light[(q, l)] += etendue * weight * self.radiance[(fine, l)];
                    }
                }
            }
        }
        light
    }
}

/// A baseline TIFF of 8 or 16 bits: header, one strip, one directory.
fn tiff(bits: u32, pixels: &[u16]) -> Vec<u8> {
    let width = bits as usize / 8;
    let bytes = |p: &u16| p.to_le_bytes().into_iter().take(width);
    let data: Vec<u8> = pixels.iter().flat_map(bytes).collect();
    let mut bytes = b"II*\0".to_vec();
    bytes.extend((8 + data.len() as u32).to_le_bytes());
    bytes.extend(&data);
    let entries = [
        (256u16, SIZE[0] as u32),
        (257, SIZE[1] as u32),
        (258, bits),
        (259, 1),
        (262, 1),
        (273, 8),
        (277, 1),
        (278, SIZE[1] as u32),
        (279, data.len() as u32),
    ];
    bytes.extend((entries.len() as u16).to_le_bytes());
    for (tag, value) in entries {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(4u16.to_le_bytes());
        bytes.extend(1u32.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0; 4]);
    bytes
}

/// What a sensor stores.
struct Format {
    name: &'static str,
    extension: &'static str,
    /// Counts per electron, counts of read noise (electrons), dark level (counts) and full scale.
    gain: f64,
    read: f64,
    dark: f64,
    full: f64,
    gamma: f64,
}

const FORMATS: [Format; 4] = [
    Format {
        name: "deep",
        extension: "png",
        gain: 20.0,
        read: 2.0,
        dark: 300.0,
        full: 65535.0,
        gamma: 1.0,
    },
    Format {
        name: "tiff",
        extension: "tif",
        gain: 20.0,
        read: 2.0,
        dark: 300.0,
        full: 65535.0,
        gamma: 1.0,
    },
    Format {
        name: "bytes",
        extension: "png",
        gain: 0.25,
        read: 3.0,
        dark: 9.0,
        full: 255.0,
        gamma: 2.2,
    },
    Format {
        name: "tiff-bytes",
        extension: "tif",
        gain: 0.25,
        read: 3.0,
        dark: 9.0,
        full: 255.0,
        gamma: 2.2,
    },
];

impl Format {
    /// Electrons to a stored value.
    fn stored(&self, electrons: f64, noise: &mut Noise) -> u16 {
        let spread = (electrons.max(0.0) + self.read * self.read).sqrt();
        let counts = self.dark + self.gain * (electrons + spread * noise.normal());
        let part = (counts / self.full).clamp(0.0, 1.0);
        (self.full * part.powf(1.0 / self.gamma)).round() as u16
    }

    fn file(&self, values: &[u16]) -> Vec<u8> {
        let size = SIZE.map(|n| n as u32);
        match (self.extension, self.full as u32) {
            ("tif", 65535) => tiff(16, values),
            ("tif", _) => tiff(8, values),
            (_, 65535) => grey16_png(size, values).unwrap(),
            _ => {
                let grey: Vec<u8> = values.iter().flat_map(|x| [*x as u8; 3]).collect();
                rgb_png(size, &grey, None).unwrap()
            }
        }
    }
}

/// Recovers `out`, and `direct.npy` with the same weights and with bands that hold all elements at
/// once in 95 of 100 cases: every element of the former lies within them. (The former has no bands
/// of its own: all spots of a pixel share the error of the dark frames.)
fn agrees_with_direct(w: &Workspace, out: &str) {
    let _ = w.phicam(&format!("recover {out} --method joint")).exits(0);
    let given = format!("--stderr {out}/phi.stderr.npy --left-out {out}/left_out.npy");
    let how = format!("--method joint --bands 0.95 -o {out}-direct");
    let _ = w
        .phicam(&format!("recover {out} --phi direct.npy {given} {how}"))
        .exits(0);
    let found = w.matrix(&format!("{out}/recovered/joint.npy"));
    let of = |name: &str| w.matrix(&format!("{out}-direct/{name}.npy"));
    let (direct, lower, upper) = (of("joint"), of("joint.lower"), of("joint.upper"));
    println!(
        "{out}: recovered off by {:.4} in rms, {:.4} at most; bands {:.4} wide",
        (&found - &direct).norm() / (direct.len() as f64).sqrt(),
        (&found - &direct).amax(),
        (&upper - &lower).mean(),
    );
    for (i, x) in found.iter().enumerate() {
        let [low, high] = [lower[i], upper[i]];
        assert!(
            (low..=high).contains(x),
            "{out}: element {i}: {x}, [{low}, {high}]"
        );
    }
}

/// Pixels of the scene within 1.5 px of the glint: one for the slopes, the rest for the marks.
fn touched() -> i32 {
    let corner = |p: usize, k: usize| {
        let at = [p % COARSE + k % 2, p / COARSE + k / 2].map(|n| n as f64 / COARSE as f64);
        Camera::pixel([3.25 + 3.25 * at[0], 2.75 + 3.25 * at[1]])
    };
    let overlaps = |p: &usize| {
        [70.0, 60.0].iter().enumerate().all(|(axis, first)| {
            let ends = [0, 1, 2, 3].map(|k| corner(*p, k)[axis]);
            let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
            let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            high > first - 2.0 && low < first + 6.0
        })
    };
    (0..COARSE * COARSE).filter(overlaps).count() as i32
}

/// Photographs of every kind come back within 1 % with honest error bars, their entries near a
/// saturated place left out; with exact marks they agree with the model, and what `joint` recovers
/// from them lies within the bands of what it recovers from Φ without a camera.
#[test]
#[ignore = "slow"]
fn a_modelled_scene_comes_back_from_the_files_of_a_camera() {
    let (fine, coarse) = (scene(FINE), scene(COARSE));
    let phi = MatrixModel::new(&fine, Kernel::Physical, None)
        .unwrap()
        .phi();
    let block = FINE / COARSE;
    let truth = Matrix::from_fn(COARSE * COARSE, phi.ncols(), |p, l| {
        let [i, j] = [p % COARSE * block, p / COARSE * block];
        (0..block * block)
            .map(|k| phi[(i + k % block + (j + k / block) * FINE, l)])
            .sum()
    });
    let wall = Wall::of(&fine, &phi);
    let light = wall.photographed();
    // 300 electrons in the brightest pixel.
    let electrons = 300.0 / light.max();
    let w = Workspace::new();
    w.write("scene.toml", &coarse.text);
    npy::write(&w.path("direct.npy"), &truth).unwrap();
    let mut noise = Noise(11);
    // A lattice of 12 × 12 marks, as of a chessboard, and where they are believed to be.
    let places: Vec<[f64; 2]> = (0..144)
        .map(|k| {
            [
                3.3 + 3.15 * f64::from(k % 12) / 11.0,
                2.8 + 3.15 * f64::from(k / 12) / 11.0,
            ]
        })
        .collect();
    let marks = |error: f64, noise: &mut Noise| -> String {
        let one = |at: &[f64; 2]| {
            let [u, v] = Camera::pixel(*at).map(|x| x + error * noise.normal());
            format!(
                "[[marks]]\npixel = [{u}, {v}]\nwall = [{}, {}]\n",
                at[0], at[1]
            )
        };
        places.iter().map(one).collect()
    };
    for format in &FORMATS {
        let name = format.name;
        std::fs::create_dir(w.path(name)).unwrap();
        for k in 0..light.ncols() * REPEATS {
            let spot = k / REPEATS;
            let mut values: Vec<u16> = light
                .column(spot)
                .iter()
                .map(|x| format.stored(electrons * x, &mut noise))
                .collect();
            // A glint in the photographs of the third spot.
            if spot == 2 {
                for q in 0..25 {
                    values[70 + q % 5 + (60 + q / 5) * SIZE[0]] = format.full as u16;
                }
            }
            w.write(
                &format!("{name}/photo-{k:03}.{}", format.extension),
                format.file(&values),
            );
        }
        for k in 0..DARK {
            let values: Vec<u16> = (0..SIZE[0] * SIZE[1])
                .map(|_| format.stored(0.0, &mut noise))
                .collect();
            w.write(
                &format!("{name}/dark-{k:03}.{}", format.extension),
                format.file(&values),
            );
        }
        // For each count, of a lens at θ to the wall's normal with cosθ of the scene's opening.
        let cosine = -Camera::axes()[2][2];
        let watts = fine.camera.aperture_area * cosine / electrons / format.gain;
        for (error, folder) in [(0.3, "off"), (0.0, "exact")] {
            let set = format!(
                "scene = \"scene.toml\"\nframes = \"{name}/photo-*.{0}\"\ndark = \"{name}/dark-*.{0}\"\nrepeats = {REPEATS}\ngamma = {1}\nwatts = {watts:e}\nexposure = 1\n\
                 camera = {{ fx = {FX}, fy = {FY}, cx = {CX}, cy = {CY}, k1 = {K1}, k2 = {K2}, p1 = {P1}, p2 = {P2} }}\n{2}",
                format.extension,
                format.gamma,
                marks(error, &mut noise)
            );
            w.write("set.toml", set);
            let out = format!("{name}-{folder}");
            let told = w.phicam(&format!("import set.toml -o {out}")).exits(0);
            let (found, stderr) = (
                w.matrix(&format!("{out}/phi.npy")),
                w.matrix(&format!("{out}/phi.stderr.npy")),
            );
            let left = w.matrix(&format!("{out}/left_out.npy"));
            let account = w.json(&format!("{out}/import.json"));
            // The gain of the line is that of the sensor.
            let gain = account["photon_transfer"]["noise"]["gain"]
                .as_f64()
                .unwrap();
            assert!(
                (gain / format.gain - 1.0).abs() < 0.03,
                "{out}: gain {gain}"
            );
            assert!(
                account["photon_transfer"]["p"].as_f64().unwrap() > 1e-4,
                "{}",
                told.account()
            );
            let (mut chi2, mut n, mut off, mut all) = (0.0, 0, 0.0, 0.0);
            for l in 0..found.ncols() {
                for p in 0..found.nrows() {
                    if left[(p, l)] != 0.0 {
                        assert_eq!((l, left[(p, l)]), (2, 1.0), "pixel {p}");
                        continue;
                    }
                    let d = found[(p, l)] - truth[(p, l)];
                    chi2 += (d / stderr[(p, l)]).powi(2);
                    (n, off, all) = (n + 1, off + d * d, all + truth[(p, l)].powi(2));
                }
            }
            let (chi2, off) = (chi2 / f64::from(n), (off / all).sqrt());
            println!(
                "{out}: χ²/dof {chi2:.4} over {n} entries, Φ off by {:.3} %",
                100.0 * off
            );
            // A footprint that the glint touches, or whose pixels have it beside them, is left out.
            assert!((6144 - touched()..6144).contains(&n), "{n}");
            assert!((chi2 - 1.0).abs() < 0.05, "{out}: χ²/dof {chi2}");
            assert!(off < 0.01, "{out}: {off}");
            if error == 0.0 {
                let _ = w
                    .phicam(&format!("validate {out} --integration centres"))
                    .exits(0);
                agrees_with_direct(&w, &out);
            } else {
                let mark = account["mark_error"].as_f64().unwrap();
                assert!((mark / 0.3 - 1.0).abs() < 0.3, "{mark}");
            }
        }
    }
}
