#!/usr/bin/env python3
"""The flux matrix of one phicam scene, rendered by Mitsuba 3 (https://mitsuba-renderer.org).

    pip install mitsuba numpy
    python FILE.py -o phi.npy [--spots A..B] [--spp N] [--seed S] [--max-bounces N] [--variant NAME]

writes phi.npy, pixels x spots in W (f64; pixel = column + row * columns, row 0 at the lowest y, column 0 at the lowest x),
and phi.stderr.npy, its standard error. The scale is absolute: nothing is fitted. `scene(spot)` below returns the Mitsuba
dictionary: a program of your own calls mi.set_variant(...), imports this file and passes it to mi.load_dict. Written for
Mitsuba 3.9 (3.6 to 3.8 were seen to work, too, and with LLVM 14 and 15, which 3.9 finds too old).

How the scene is translated
  Surfaces   A parallelogram is a `rectangle` under an affine map, a sphere a `sphere`, a disc a `disk`, a mesh a `Mesh` of the
             same vertices and triangles with flat normals. All BSDFs are one-sided: the front (where the normal points)
             reflects, the back is black, both block. Two flat surfaces back to back are each lifted by LIFT / 2 along
             their normals, a mesh with two sides is `twosided`. Cells are `bitmap` textures with nearest lookup and raw
             values; a ramp is two texels with linear lookup between their centres. On a sphere the texture is tabulated in
             4096 rows of equal polar angle: edges along the polar angle lie within 4e-4 rad. On a disc it is tabulated in
             2048 rings by 2048 sectors.
  Materials  lambertian: `diffuse`. conductor: `roughconductor` (GGX). mixture: `blendbsdf`, nested. oren_nayar: the BSDF in
             Python below (EON), for Mitsuba has none. paint: a BSDF in Python below, a `roughplastic` over black and the
             light of the ground below it, which loses nothing; its tables are measured from that `roughplastic`.
             coated: `roughplastic` (GGX, nonlinear), with another diffuse reflectance. Both programs divide the light of the
             ground by 1 - rho * F, F the coat's reflectance of diffuse light from inside. phicam integrates F; Mitsuba takes
             the mean over 64 nodes, F', which is up to 1.5 % less. So the program measures F' by evaluating the BSDF with two
             reflectances and takes the rho' that gives the ground the light that it has in phicam:
             rho' / (1 - rho' F') = rho / (1 - rho F). Without that the BRDFs differ by up to 1e-2. What remains, below 1e-3,
             is that Mitsuba interpolates the coat's transmittance linearly between 64 cosines. A pixel that sees such a spot
             itself shows it beyond any noise. (Between the centres of texels rho' is interpolated, not rho.)
             measured: refused when the file is written, for Mitsuba reads no such table.
             Values of phicam's own BRDFs stand below: before it renders, the program prints how far Mitsuba's are from them.
  Camera     No Mitsuba sensor: every sample is a ray from the pinhole through a uniform point of the pixel's footprint, and
             its radiance counts A_footprint * A_lens * cos^2 / d^2, the etendue that it stands for.
  Laser      The lit spot is a Lambertian emitter of exitance albedo * irradiance, one-sided, with the albedo of the surface
             that it lies on. An ideal spot becomes a disk of 1e-4 of the scene's extent; the bias from its size is of the
             order of (radius / distance)^2, some 1e-8. A spot of finite size that falls on one flat surface of one albedo is a
             `disk` (uniform), or a `rectangle` with a bitmap (Gaussian, cut at 3 w: 4e-6 of its power is moved inwards).
             Any other is 1024 ideal ones of equal power, each where the beam lands: edges across it are resolved
             to about 0.5 % of its power, and where the camera sees such a spot itself, to a few % of an edge pixel's light.
             The emitter lies LIFT above the surface (5e-6 of the extent).
             Where the lit surface is not Lambertian, the spot is no area but points with the intensity
             power * f_r(to the laser, w) * cos(w), f_r by Mitsuba's own BSDF: an emitter in Python, below.
  Bounces    phicam counts the surfaces between laser and camera, the spot's included; Mitsuba counts the edges of a path from
             emitter to camera, and its emitter is the spot: max_depth is the same number.

Precision: Mitsuba's common variants compute in f32, and start rays some 1e-4 of the distance from the origin above the
surface. The origin is put into the middle of the view to keep that small; expect systematic errors of a few 1e-5.
Shadow rays end 0.1 % short of the light, so what blocks a spot from so close by is not seen. Standard errors come from the
spread of independent samples; below some hundred contributing samples an entry they are themselves uncertain.
"""

import argparse
import base64
import functools
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

