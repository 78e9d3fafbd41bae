"""What Python adds to a call, and an import to the start of a program."""

import re
import subprocess
import sys
import time
from pathlib import Path
from statistics import median

import phicam


def overhead(call):
    """Median time of the processor that the calling thread takes: the crate computes in others."""
    own = []
    for _ in range(15):
        begun = time.thread_time()
        call()
        own.append(time.thread_time() - begun)
    return median(own)


def test_a_call_costs_less_than_5_ms():
    """On the bench, 256 × 120: arrays in and out, checks, threads, and what is made of the result."""
    scene = phicam.Scene("bench")
    phi, model = phicam.render(scene, samples=32), phicam.model(scene)
    assert phi.shape == (256, 120)
    costs = {
        "render": overhead(lambda: phicam.render(scene, samples=32)),
        "model": overhead(lambda: phicam.model(scene)),
        "recover": overhead(lambda: phicam.recover(phi, model, "tsvd")),
    }
    print({name: f"{1e3 * cost:.2f} ms" for name, cost in costs.items()})
    assert max(costs.values()) < 5e-3


def test_import_takes_less_than_numpys():
    """What it takes beside NumPy, in units of what that takes, so that a busy machine matters less; the least of five."""
    program = [sys.executable, "-X", "importtime", "-c", "import phicam"]
    took = []
    for _ in range(5):
        lines = subprocess.run(program, check=True, capture_output=True, text=True, cwd=Path(__file__).parent).stderr
        whole, numpys = (
            int(re.search(rf"\|\s*(\d+) \| +{name}$", lines, re.MULTILINE)[1]) / 1e6 for name in ("phicam", "numpy")
        )
        took.append(((whole - numpys) / numpys, whole - numpys))
    print(f"{1e3 * min(took)[1]:.0f} ms beside NumPy, {min(took)[0]:.2f} of it")
    assert min(took)[0] < 1.0
