"""Runs the lines that the guide (src/cli/guide/files.md) shows for NumPy, xarray, Octave and MATLAB as they stand there, on the folder of a run of `bench`.

usage: python readme_lines.py DIR

DIR must be called `out`, as in the guide. Needs NumPy and xarray, and octave on the path. What the lines leave in their variables is held against the files.
"""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np

run = Path(sys.argv[1]).resolve()
assert run.name == "out", "the lines of the guide read the folder `out`"
chapter = (Path(__file__).parents[2] / "src/cli/guide/files.md").read_text(encoding="utf-8")
blocks = {language: re.findall(rf"^```{language}\n(.*?)^```", chapter, re.M | re.S) for language in ("python", "matlab")}
phi = np.load(run / "phi.npy")


def python(block):
    program = f"import os; os.chdir({str(run.parent)!r})\n" + block
    variables = {}
    exec(compile(program, "files.md", "exec"), variables)
    return variables


numpy_lines, xarray_lines = (python(block) for block in blocks["python"])
assert np.array_equal(numpy_lines["phi"], phi)
image = numpy_lines["image"]
# The lines take G12 and G23 for D and C, which differ from them by one factor and by a factor w for each pixel: `image` is the mean over the pixels weighted by w.
# Equal up to a scale; pinv's rounding, 1e-3 of the largest value, takes 1e-6 from the cosine.
pinv, C, D = (np.load(run / f"{f}.npy") for f in ("recovered/pinv", "model/camera_side", "model/laser_side"))
each_pixel = phi @ np.linalg.pinv(D, rcond=max(D.shape) * np.finfo(float).eps) / C
w = (C / np.load(run / "model/g23.npy"))[:, :1]
cosine = lambda a, b: (a * b).sum() / np.linalg.norm(a) / np.linalg.norm(b)
assert cosine(each_pixel.mean(axis=0).reshape(pinv.shape), pinv) > 0.9999
assert image.shape == pinv.shape and cosine(image, (w * each_pixel).mean(axis=0).reshape(pinv.shape)) > 0.9999, image

cube = xarray_lines["phi"]
assert cube.dims == ("row", "column", "spot") and cube.attrs["units"] == "W"
for row, column, spot in [(0, 0, 0), (3, 11, 7), (15, 2, 119)]:
    assert cube[row, column, spot] == phi[column + row * cube.sizes["column"], spot]
# The view of `bench` is x 3.25 to 6.5 and y 2.75 to 6 in 16 × 16 pixels: the middle of pixel (11, 3) by hand.
assert np.allclose([cube.x[11], cube.y[3]], [3.25 + 11.5 * 3.25 / 16, 2.75 + 3.5 * 3.25 / 16], rtol=1e-15, atol=0)

(lines,) = blocks["matlab"]
lines += "printf('%d %d', size(phi)); printf(' %.17g', phi(1, 1), phi(60, 8), phi(256, 120));"
said = subprocess.run(["octave", "--no-gui", "--quiet", "--no-history", "--eval", lines], cwd=run.parent, capture_output=True, text=True, check=True).stdout.split()
assert [int(n) for n in said[:2]] == list(phi.shape), said
assert [float(x) for x in said[2:]] == [phi[0, 0], phi[59, 7], phi[255, 119]], said
print(f"the lines of the guide for NumPy ({len(blocks['python'])} blocks) and Octave read what is in {run.name}/")
