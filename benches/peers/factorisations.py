"""Matrix factorisations of phicam beside NumPy's, on the same matrices, each on one thread.

usage: python factorisations.py [--phicam FILE] [-o FILE]

The matrices are G12 of the published scene at three sizes. NumPy's times are taken before and after `cargo bench --bench decompositions`,
the least of all counts; phicam's are the least time per call in what criterion has measured: whatever else runs on the machine only
adds to either.

  full      thin singular value decomposition      numpy.linalg.svd(a, full_matrices=False)
  needed    the same to its numerical rank only    numpy.linalg.svd(a, full_matrices=False): NumPy has no other
  inverse   Moore-Penrose inverse                  numpy.linalg.pinv(a, max(m, n) eps)
"""

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ[name] = "1"

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit("skipped: numpy is not installed (pip install numpy)")

ROOT = Path(__file__).resolve().parents[2]
SIZES = ((16, 100), (24, 200), (32, 1000))  # elements a side, spots a side: those of benches/decompositions.rs


def matrix(phicam, side, per_side, folder):
    """G12, elements × spots."""
    text = (ROOT / "scenes" / "thesis.toml").read_text(encoding="utf-8")
    scene = folder / "scene.toml"
    scene.write_text(text.replace("per_side = 30", f"per_side = {per_side}"), encoding="utf-8")
    subprocess.run([phicam, "model", scene, "--elements", str(side), "-q", "-o", folder], check=True, stdout=subprocess.DEVNULL)
    return np.load(folder / "model" / "g12.npy")


def least(call, seconds=2.0):
    """The least time of a call, s, of at least three."""
    best, begin, calls = np.inf, time.perf_counter(), 0
    while calls < 3 or time.perf_counter() - begin < seconds:
        start = time.perf_counter()
        call()
        best, calls = min(best, time.perf_counter() - start), calls + 1
    return best


def numpys(a):
    svd = least(lambda: np.linalg.svd(a, full_matrices=False))
    inverse = least(lambda: np.linalg.pinv(a, max(a.shape) * np.finfo(float).eps))
    return {"full": svd, "needed": svd, "inverse": inverse}


def criterions():
    """(kind, name) → least time per call, s."""
    found = {}
    for sample in (ROOT / "target" / "criterion").glob("singular values of G12*/*/*/new/sample.json"):
        kind, name = sample.parts[-4], sample.parts[-3]
        record = json.loads(sample.read_text(encoding="utf-8"))
        found[kind, name] = min(t / n for t, n in zip(record["times"], record["iters"])) * 1e-9
    return found


def main():
    parser = argparse.ArgumentParser(description="phicam's matrix factorisations beside NumPy's.")
    parser.add_argument("--phicam", type=Path, default=ROOT / "target" / "release" / "phicam")
    parser.add_argument("-o", "--output", type=Path, help="FILE.md")
    args = parser.parse_args()
    if not args.phicam.exists():
        sys.exit(f"skipped: {args.phicam} does not exist (cargo build --release)")
    with tempfile.TemporaryDirectory() as folder:
        matrices = {f"{side} x {4 * spots}": matrix(args.phicam.resolve(), side, spots, Path(folder)) for side, spots in SIZES}
    before = {name: numpys(a) for name, a in matrices.items()}
    subprocess.run(["cargo", "bench", "--bench", "decompositions"], check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
    after = {name: numpys(a) for name, a in matrices.items()}
    mine = criterions()
    rows = ["| G12 | | phicam (s) | NumPy (s) | NumPy / phicam |", "| --- | --- | ---: | ---: | ---: |"]
    for name, a in matrices.items():
        for kind in ("full", "needed", "inverse"):
            theirs, own = min(before[name][kind], after[name][kind]), mine[kind, name]
            rows.append(f"| {a.shape[0]} × {a.shape[1]} | {kind} | {own:.2e} | {theirs:.2e} | {theirs / own:.2f} |")
    table = "\n".join(rows) + "\n"
    print(table)
    if args.output:
        args.output.with_suffix(".md").write_text(table, encoding="utf-8")


if __name__ == "__main__":
    main()
