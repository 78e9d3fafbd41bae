"""What Python adds to a call, and an import to the start of a program."""

import re
import subprocess
import sys
import time
from pathlib import Path

import phicam


def loop():
    """A hundred thousand squares in Python: some 4 ms."""
    return sum(i * i for i in range(100_000))


def overhead(calls):
    """The least time of the processor that the calling thread takes for each of the calls, which take turns: the crate computes in
    other threads."""
    least = dict.fromkeys(calls, float("inf"))
    for _ in range(15):
        for name, call in calls.items():
            begun = time.thread_time()
            call()
            least[name] = min(least[name], time.thread_time() - begun)
    return least


def test_a_call_costs_less_than_a_loop():
    """On the bench, 256 × 120: arrays in and out, checks, threads, and what is made of the result, in units of what a loop in Python
    takes beside it."""
    scene = phicam.Scene("bench")
    phi, model = phicam.render(scene, samples=32), phicam.model(scene)
    assert phi.shape == (256, 120)
    took = overhead(
        {
            "loop": loop,
            "render": lambda: phicam.render(scene, samples=32),
            "model": lambda: phicam.model(scene),
            "recover": lambda: phicam.recover(phi, model, "tsvd"),
        }
    )
    costs = {name: cost / took["loop"] for name, cost in took.items() if name != "loop"}
    print({name: f"{cost:.2f} of {1e3 * took['loop']:.1f} ms" for name, cost in costs.items()})
    assert max(costs.values()) < 1


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
