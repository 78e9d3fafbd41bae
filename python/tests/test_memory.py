"""A recovery on a matrix of one's own holds one copy of it, and n × n matrices besides."""

import subprocess
import sys
from pathlib import Path

import pytest

# Bytes of the peak beside those of a small recovery, of a process of its own.
PROGRAM = """
import re, sys
import numpy, phicam

def peak():
    return int(re.search(r"VmHWM:\\s*(\\d+) kB", open("/proc/self/status").read())[1]) * 1024

pixels, elements, noise = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]) or None
draw = numpy.random.default_rng(1)
A, x = draw.random((pixels, elements)), 0.1 + 0.8 * draw.random(elements)
phi = A @ x
phicam.recover(A[:99, :9] @ x[:9], A[:99, :9], "joint", noise=noise)
before = peak()
found = phicam.recover(phi, A, "joint", noise=noise)
print(peak() - before)
assert abs(found.reflectance - x).max() < (1e-9 if noise is None else 0.1)
"""


def grown(pixels, elements, noise):
    """By how much a recovery lets the peak grow, bytes."""
    arguments = [sys.executable, "-c", PROGRAM, str(pixels), str(elements), str(noise)]
    # Not where the sources lie, which are not the module.
    return int(subprocess.run(arguments, check=True, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parent).stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("noise", [0.0, 1e-3], ids=["unknown noise", "known noise"])
@pytest.mark.parametrize(("elements", "pixels"), [(256, (8192, 40960)), (1024, (4096, 16384))])
def test_more_pixels_are_copied_once(elements, pixels, noise):
    few, many = (grown(count, elements, noise) for count in pixels)
    matrix = 8 * elements * (pixels[1] - pixels[0])
    copies = (many - few) / matrix
    print(f"{elements} elements: {few / 2**20:.0f} MiB of {pixels[0]} pixels, {many / 2**20:.0f} of {pixels[1]}: {copies:.2f} copies")
    assert copies < 1.3
    # Beside that copy there are n × n matrices: factors, covariance, resolution.
    for peak, count in ((few, pixels[0]), (many, pixels[1])):
        assert peak - 8 * elements * count < 20 * 8 * elements**2 + 16 * 2**20
