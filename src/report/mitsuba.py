#!/usr/bin/env python3
"""The flux matrix of one phicam scene, rendered by Mitsuba 3 (https://mitsuba-renderer.org).

    pip install mitsuba numpy
    python FILE.py -o phi.npy [--spots A..B] [--spp N] [--seed S] [--max-bounces N] [--variant NAME]

writes phi.npy, pixels x spots in W (f64; pixel = column + row * columns, row 0 at the lowest y, column 0 at the lowest x),
and phi.stderr.npy, its standard error. The scale is absolute: nothing is fitted. `scene(spot)` below returns the Mitsuba
dictionary: a program of your own calls mi.set_variant(...), imports this file and passes it to mi.load_dict. Written for
Mitsuba 3.9 (3.6 to 3.8 were seen to work, too, and with LLVM 14 and 15, which 3.9 finds too old).

How the scene is translated
  Surfaces   A parallelogram is a `rectangle` under an affine map, a sphere a `sphere`. `diffuse` is one-sided: the front
             (where the normal points) reflects, the back is black, both block. Cells are `bitmap` textures with nearest
             lookup and raw values; a ramp is two texels with linear lookup between their centres. On a sphere the texture
             is tabulated in 4096 rows of equal polar angle: edges along the polar angle lie within 4e-4 rad.
  Camera     No Mitsuba sensor: every sample is a ray from the pinhole through a uniform point of the pixel's footprint, and
             its radiance counts A_footprint * A_lens * cos^2 / d^2, the etendue that it stands for.
  Laser      The lit spot is a Lambertian emitter of exitance albedo * irradiance, one-sided, with the albedo of the surface
             that it lies on. An ideal spot becomes a disk of 1e-4 of the scene's extent; the bias from its size is of the
             order of (radius / distance)^2, some 1e-8. A spot of finite size that falls on one flat surface of one albedo is a
             `disk` (uniform), or a `rectangle` with a bitmap (Gaussian, cut at 3 w: 4e-6 of its power is moved inwards).
             Any other is 1024 ideal ones of equal power, each where the beam lands: edges across it are resolved
             to about 0.5 % of its power, and where the camera sees such a spot itself, to a few % of an edge pixel's light. The emitter lies LIFT above the surface (5e-6 of the extent).
  Bounces    phicam counts the surfaces between laser and camera, the spot's included; Mitsuba counts the edges of a path from
             emitter to camera, and its emitter is the spot: max_depth is the same number.

Precision: Mitsuba's common variants compute in f32, and start rays some 1e-4 of the distance from the origin above the
surface. The origin is put into the middle of the view to keep that small; expect systematic errors of a few 1e-5.
Shadow rays end 0.1 % short of the light, so what blocks a spot from so close by is not seen. Standard errors come from the
spread of independent samples; below some hundred contributing samples an entry they are themselves uncertain.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import drjit as dr
    import mitsuba as mi
    import numpy as np
except ImportError as e:
    raise SystemExit(f"{e}: install what is needed with `pip install mitsuba numpy`")

# @scene@

# ---- Placement: Mitsuba's f32 coordinates are (p - ORIGIN) * SCALE, the scene then measures about 1000 ----------------------

ORIGIN = np.array(VIEW["corner"]) + 0.5 * (np.array(VIEW["u"]) + np.array(VIEW["v"]))


def _reach(s):
    if s["shape"] == "sphere":
        return np.linalg.norm(np.array(s["centre"]) - ORIGIN) + s["radius"]
    c, u, v = (np.array(s[k]) for k in ("corner", "u", "v"))
    return max(np.linalg.norm(p - ORIGIN) for p in (c, c + u, c + v, c + u + v))


SCALE = 1000.0 / max(_reach(s) for s in SURFACES)
POINT_RADIUS = 0.1  # of the disk that stands for an ideal spot, in Mitsuba's coordinates
LIFT = 5e-3  # of the emitter above its surface, in Mitsuba's coordinates


def place(p):
    return (np.array(p) - ORIGIN) * SCALE


def affine(x, y, z, origin):
    """The transform with the given columns."""
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = x, y, z, origin
    return mi.ScalarTransform4f(m)


# ---- Surfaces -----------------------------------------------------------------------------------------------------------


def bitmap(values, lookup="nearest", to_uv=None, wrap="clamp"):
    """Texel [j][i] covers u in [i, i + 1] / nu, v in [j, j + 1] / nv: Mitsuba's row 0 lies at v = 0, as ours does."""
    texture = {
        "type": "bitmap",
        "bitmap": mi.Bitmap(np.ascontiguousarray(values, dtype=np.float32)[:, :, None]),
        "raw": True,
        "filter_type": lookup,
        "wrap_mode": wrap,
    }
    if to_uv is not None:
        texture["to_uv"] = to_uv
    return texture


def checkerboard(nu, nv, dark, light):
    """Cell (0, 0), at the corner, is dark."""
    return np.where(np.add.outer(np.arange(nv), np.arange(nu)) % 2 == 0, dark, light)


def uniform(value):
    return {"type": "uniform", "value": float(value)}


def reflectance(s):
    kind, value = s["albedo"]
    if kind == "constant":
        return uniform(value)
    if kind == "checkerboard":
        kind, value = "cells", checkerboard(*value)
    if s["shape"] == "sphere":
        # phicam's u is (1 - cos theta) / 2 and its v phi / 2 pi; Mitsuba's u is phi / 2 pi and its v theta / pi.
        u = 0.5 - 0.5 * np.cos(np.pi * (np.arange(4096) + 0.5) / 4096)
        if kind == "ramp":
            return bitmap((value[0] + (value[1] - value[0]) * u)[:, None].repeat(2, axis=1), "bilinear")
        if kind == "bilinear":
            wrap, texels = value[0], np.array(value[1])
            x = u * texels.shape[1] - 0.5
            left = np.floor(x).astype(int)
            inside = (lambda i: i % texels.shape[1]) if wrap == "repeat" else (lambda i: np.clip(i, 0, texels.shape[1] - 1))
            rows = texels[:, inside(left)] * (1 - (x - left)) + texels[:, inside(left + 1)] * (x - left)
            return bitmap(rows.T, "bilinear", wrap=wrap)
        cells = np.array(value)
        return bitmap(cells[:, np.minimum((u * cells.shape[1]).astype(int), cells.shape[1] - 1)].T)
    if kind == "ramp":
        # Two texels with centres at 1/4 and 3/4: u in [0, 1] is mapped to what lies between them.
        between = mi.ScalarTransform4f().translate([0.25, 0, 0]).scale([0.5, 1, 1])
        return bitmap([value, value], "bilinear", between)
    if kind == "bilinear":
        return bitmap(value[1], "bilinear", wrap=value[0])
    return bitmap(value)


def surface(s):
    bsdf = {"type": "diffuse", "reflectance": reflectance(s)}
    if s["shape"] == "sphere":
        return {
            "type": "sphere",
            "center": place(s["centre"]).tolist(),
            "radius": s["radius"] * SCALE,
            "flip_normals": s["face"] == "inside",
            "bsdf": bsdf,
        }
    u, v = np.array(s["u"]) * SCALE, np.array(s["v"]) * SCALE
    n = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
    # Mitsuba's rectangle is [-1, 1]^2 in the plane z = 0.
    return {"type": "rectangle", "to_world": affine(u / 2, v / 2, n, place(s["corner"]) + (u + v) / 2), "bsdf": bsdf}


# ---- Laser spots --------------------------------------------------------------------------------------------------------


def emitter(lit, power):
    """What the beam lights: a Lambertian emitter of radiance albedo * irradiance / pi."""
    kind, centre, normal, albedo, size = lit
    n = np.array(normal)
    side = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    side /= np.linalg.norm(side)
    radius = {"point": POINT_RADIUS, "disc": size * SCALE, "gaussian": 3 * size * SCALE}[kind]
    shape = {
        "to_world": affine(side * radius, np.cross(n, side) * radius, n, place(centre) + LIFT * n),
        "bsdf": {"type": "diffuse", "reflectance": uniform(albedo)},
    }
    if kind == "gaussian":
        # Irradiance ~ exp(-2 r^2 / w^2) over a square of half-side 3 w.
        x = 3 * ((np.arange(256) + 0.5) / 128 - 1)
        profile = np.exp(-2 * (x[:, None] ** 2 + x[None, :] ** 2))
        area = (2 * radius) ** 2
        radiance = bitmap(power * albedo / np.pi / area * profile / profile.mean(), "bilinear")
        shape["type"] = "rectangle"
    else:
        share = size if kind == "point" else 1.0
        radiance = uniform(share * power * albedo / np.pi / (np.pi * radius**2))
        shape["type"] = "disk"
    shape["emitter"] = {"type": "area", "radiance": radiance}
    return shape


def scene(spot):
    """The Mitsuba dictionary of the scene while the laser lights `spot`."""
    d = {"type": "scene"}
    d.update({f"surface{i}": surface(s) for i, s in enumerate(SURFACES)})
    d.update({f"lit{i}": emitter(lit, POWER) for i, lit in enumerate(SPOTS[spot])})
    return d


def direct(world, spot):
    """Flux of the ideal spots themselves into the pixels that see them: camera samples would hardly ever meet them."""
    flux = np.zeros(COLUMNS * ROWS)
    eye, axis = np.array(PINHOLE), np.array(VIEW["normal"])
    corner, u, v = (np.array(VIEW[k]) for k in ("corner", "u", "v"))
    for kind, point, normal, albedo, share in SPOTS[spot]:
        if kind != "point":
            continue
        line = np.array(point) - eye
        distance = np.linalg.norm(line)
        w = line / distance
        cos_lit, cos_lens = -w @ np.array(normal), -w @ axis
        if cos_lit <= 0 or cos_lens <= 0:
            continue
        foot = eye + w * (axis @ (corner - eye)) / (axis @ w) - corner
        # Coordinates along u and v, which need not be perpendicular.
        (a, b), *_ = np.linalg.lstsq(np.stack([u, v], axis=1), foot, rcond=None)
        if not (0 <= a < 1 and 0 <= b < 1):
            continue
        o, e = place(eye), place(point)
        ray = mi.Ray3f(mi.Point3f(o.tolist()), mi.Vector3f(w.tolist()))
        ray.maxt = mi.Float(float(np.linalg.norm(e - o) * (1 - 1e-4)))
        if np.any(np.array(world.ray_test(ray))):
            continue
        pixel = min(int(a * COLUMNS), COLUMNS - 1) + min(int(b * ROWS), ROWS - 1) * COLUMNS
        flux[pixel] += POWER * share * albedo / np.pi * cos_lit * APERTURE_AREA * cos_lens / distance**2
    return flux


# ---- Camera -------------------------------------------------------------------------------------------------------------


def sample(world, integrator, sampler, pixel):
    """Flux samples (W) of `pixel`: an integer, or an array of them in the vectorised variants."""
    vector = lambda x: mi.Vector3f(np.asarray(x).tolist())
    eye, normal = vector(place(PINHOLE)), vector(VIEW["normal"])
    corner, u, v = vector(place(VIEW["corner"])), vector(np.array(VIEW["u"]) * SCALE), vector(np.array(VIEW["v"]) * SCALE)
    jitter = sampler.next_2d()
    a = (mi.Float(pixel % COLUMNS) + jitter.x) / COLUMNS
    b = (mi.Float(pixel // COLUMNS) + jitter.y) / ROWS
    line = corner + u * a + v * b - eye
    distance2 = dr.dot(line, line)
    w = line * dr.rsqrt(distance2)
    cos = dr.dot(w, normal)
    ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(eye), w))
    radiance = integrator.sample(world, sampler, ray)[0]
    footprint = np.linalg.norm(np.cross(VIEW["u"], VIEW["v"])) * SCALE**2 / (COLUMNS * ROWS)
    return radiance[0] * (cos * cos / distance2) * (footprint * APERTURE_AREA * SCALE**2)


def render(spot, spp, seed, max_bounces):
    """Column `spot` of the matrix and its standard error."""
    pixels = COLUMNS * ROWS
    total, squares = np.zeros(pixels), np.zeros(pixels)
    if not SPOTS[spot]:  # the beam lights nothing
        return total, squares
    world = mi.load_dict(scene(spot))
    ideal = SPOTS[spot][0][0] == "point"
    integrator = mi.load_dict(
        {"type": "path", "max_depth": max_bounces, "rr_depth": 1_000_000, "hide_emitters": ideal}
    )
    jit = not mi.variant().startswith("scalar")
    step = max(1, 2**20 // pixels) if jit else spp
    done = 0
    while done < spp:
        n = min(step, spp - done)
        seed32 = int(np.random.SeedSequence([seed, spot, done]).generate_state(1)[0])
        sampler = mi.load_dict({"type": "independent", "sample_count": 1})
        if jit:
            sampler.seed(seed32, pixels * n)
            x = sample(world, integrator, sampler, dr.arange(mi.UInt32, pixels * n) // n)
            x = np.array(x, dtype=np.float64).reshape(pixels, n)
        else:
            sampler.seed(seed32)
            x = np.array([[sample(world, integrator, sampler, p) for _ in range(n)] for p in range(pixels)])
        total += x.sum(axis=1)
        squares += (x * x).sum(axis=1)
        done += n
    mean = total / spp
    variance = np.maximum(squares / spp - mean * mean, 0.0) * spp / (spp - 1)
    return mean + (direct(world, spot) if ideal else 0.0), np.sqrt(variance / spp)


# ---- Command line -------------------------------------------------------------------------------------------------------


def choose(spot):
    """llvm_ad_rgb where it works, else scalar_rgb, which is some hundred times slower.

    Dr.Jit finds the LLVM library by itself (or in DRJIT_LIBLLVM_PATH), but aborts the process where that is too old for
    it: so the attempt is made in a process of its own.
    """
    with tempfile.TemporaryDirectory() as folder:
        trial = ["--variant", "llvm_ad_rgb", "--spp", "2", "--spots", f"{spot}..{spot + 1}", "-o", f"{folder}/phi.npy"]
        if subprocess.run([sys.executable, __file__, *trial], capture_output=True).returncode == 0:
            return "llvm_ad_rgb"
    print("llvm_ad_rgb does not work here (is LLVM installed and recent?): using scalar_rgb, slow", file=sys.stderr)
    return "scalar_rgb"


def main():
    def spot_range(text):
        a, dots, b = text.partition("..")
        if not (dots and a.isdecimal() and b.isdecimal() and int(a) < int(b) <= len(SPOTS)):
            raise argparse.ArgumentTypeError(f"write A..B with A < B <= {len(SPOTS)}, the number of spots")
        return range(int(a), int(b))

    def at_least(least):
        def number(text):
            if not text.isdecimal() or int(text) < least:
                raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} on")
            return int(text)

        return number

    parser = argparse.ArgumentParser(description=f"Flux matrix of the phicam scene {NAME!r} by Mitsuba 3".replace("%", "%%"))
    parser.add_argument("-o", "--output", type=Path, default=Path("phi.npy"), help="pixels x spots, W")
    parser.add_argument("--spots", type=spot_range, default=range(len(SPOTS)), metavar="A..B", help="only spots A to B - 1")
    parser.add_argument("--spp", type=at_least(2), default=4096, help="samples per pixel and spot (4096)")
    parser.add_argument("--seed", type=at_least(0), default=1)
    parser.add_argument("--max-bounces", type=at_least(1), default=MAX_BOUNCES, help=f"surfaces met ({MAX_BOUNCES})")
    parser.add_argument("--variant", help="Mitsuba variant: llvm_ad_rgb (default where it works), scalar_rgb, cuda_ad_rgb")
    args = parser.parse_args()
    try:
        mi.set_variant(args.variant or choose(args.spots[0]))
    except (ImportError, ValueError) as e:
        sys.exit(f"{args.variant}: {e}")
    columns = []
    for spot in args.spots:
        if sys.stderr.isatty():
            print(f"\rspot {spot} ({len(columns) + 1} of {len(args.spots)}) ", end="", file=sys.stderr, flush=True)
        columns.append(render(spot, args.spp, args.seed, args.max_bounces))
    print(f"Mitsuba {mi.__version__}, {mi.variant()}: {len(columns)} spots done", file=sys.stderr)
    phi, stderr = (np.ascontiguousarray(np.stack(c, axis=1)) for c in zip(*columns))
    np.save(args.output.with_suffix(".npy"), phi)
    np.save(args.output.with_suffix(".stderr.npy"), stderr)


if __name__ == "__main__":
    main()
