"""What Python adds to a call, and an import to the start of a program."""

import re
import subprocess
import sys
import time
from pathlib import Path
from statistics import median

import phicam
from phicam import _native


def overhead(call, seconds_inside):
    """Median of what a call takes beside the seconds in it that are the crate's own."""
    own = []
    for _ in range(15):
        begun = time.perf_counter()
        found = call()
        own.append(time.perf_counter() - begun - seconds_inside(found))
    return median(own)


def test_a_call_costs_less_than_5_ms(monkeypatch):
    """On the bench, 256 × 120: beside the seconds that the crate traced, and beside the compiled function of a recovery,
    which copies its arrays."""
    scene = phicam.Scene("bench")
    phi, model = phicam.render(scene, samples=32), phicam.model(scene)
    assert phi.shape == (256, 120)
    inside = [0.0]
    native = _native.recover

    def timed(*arguments, **keywords):
        begun = time.perf_counter()
        found = native(*arguments, **keywords)
        inside[0] = time.perf_counter() - begun
        return found

    monkeypatch.setattr(_native, "recover", timed)
    costs = {
        "render": overhead(lambda: phicam.render(scene, samples=32), lambda phi: phi.settings["seconds"]),
        "recover": overhead(lambda: phicam.recover(phi, model, "tsvd"), lambda _: inside[0]),
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
