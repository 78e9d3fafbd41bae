"""How do phicam's ray rates compare with Embree's, one ray after the other, on one core?

Runs `cargo bench --bench rays` on the bench's three quads (for Embree six triangles) and on a displaced sphere, measures Embree (PyPI:
embreex, numpy) on the same shapes and rays in between, and prints the ratio of the medians. Rays and shapes are computed from the formulas
that `benches/rays.rs` states.

    python benches/peers/embree_rays.py [rounds]
"""

import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

ROOT = Path(__file__).resolve().parents[2]
STEPS = np.array([0.8812715, 0.7766395, 0.6844303, 0.6031689, 0.5315556])
QUERIES = {"closest": "INTERSECT", "blocked": "OCCLUDED"}
BENCH, SPHERE = "rays on the bench", "rays on a sphere of n triangles"


def sphere(n):
    at = 2.0 * np.arange(n + 1) / n - 1.0
    u, v = np.meshgrid(at, at, indexing="ij")
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a = (i * (n + 1) + j).ravel()
    b = a + n + 1
    positions, triangles = [], []
    for face in range(6):
        p = [None] * 3
        p[face // 2] = np.full_like(u, 1.0 if face % 2 == 0 else -1.0)
        p[(face // 2 + 1) % 3], p[(face // 2 + 2) % 3] = u, v
        p = np.stack(p, -1).reshape(-1, 3)
        p /= np.linalg.norm(p, axis=1, keepdims=True)
        s = np.sin
        x, y, z = p.T
        r = 1.0 + s(12 * x) * s(12 * y) * s(12 * z) / 20 + s(80 * x) * s(80 * y) / 100
        first = face * (n + 1) ** 2
        positions.append(p * r[:, None])
        triangles += [np.stack([a, b, b + 1], 1) + first, np.stack([a, b + 1, a + 1], 1) + first]
    return np.concatenate(positions), np.concatenate(triangles)


def bench():
    patches = [
        ([0, 0, 0], [11.5, 0, 0], [0, 15.5, 0]),
        ([3, 8.5, 7], [4, 0, 0], [0, 2.8, -2.8]),
        ([7.5, 4, 0.5], [0, 4, 0], [0, 0, 3]),
    ]
    positions, triangles = [], []
    for k, (corner, u, v) in enumerate(patches):
        c, u, v = map(np.array, (corner, u, v))
        positions += [c, c + u, c + u + v, c + v]
        triangles += [[4 * k, 4 * k + 1, 4 * k + 2], [4 * k, 4 * k + 2, 4 * k + 3]]
    return np.array(positions, dtype=float), np.array(triangles)


def half_lines(n, low, size):
    x = np.arange(1.0, n + 1)[:, None] * STEPS % 1.0
    up = 2.0 * x[:, 3] - 1.0
    side, turn = np.sqrt(1.0 - up * up), 2.0 * np.pi * x[:, 4]
    direction = np.stack([side * np.cos(turn), side * np.sin(turn), up], 1)
    origin = np.array(low) + np.array(size) * x[:, :3]
    return origin.astype(np.float32), direction.astype(np.float32)


def embree(shape, rays, query):
    """Rays per second, the best of several passes over all rays, and the share of rays that meet something."""
    positions, triangles = shape
    scene = EmbreeScene()
    TriangleMesh(scene, positions.astype(np.float32), triangles.astype(np.int32))
    found = scene.run(*rays, query=query)
    passes = max(1, (1 << 20) // len(rays[0]))
    rates = []
    for _ in range(5):
        start = time.process_time()
        for _ in range(passes):
            found = scene.run(*rays, query=query)
        rates.append(passes * len(rays[0]) / (time.process_time() - start))
    return max(rates), float(np.mean(found >= 0))


def phicam(group, name):
    """Rays per second of the last run of criterion: the fastest of its samples."""
    folder = ROOT / "target" / "criterion" / group / name / "new"
    sample = json.loads((folder / "sample.json").read_text())
    rays = json.loads((folder / "benchmark.json").read_text())["throughput"]["Elements"]
    return rays / min(t / n for t, n in zip(sample["times"], sample["iters"])) * 1e9


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    box, ball = ([0.0, 0.0, 0.05], [11.5, 15.5, 6.95]), ([-1.2] * 3, [2.4] * 3)
    cases = [(BENCH, "{}", bench(), half_lines(1 << 12, *box))]
    for n in (50, 289):
        cases.append((SPHERE, f"{{}}/{12 * n * n}", sphere(n), half_lines(1 << 16, *ball)))
    rates = {}
    for _ in range(rounds):
        subprocess.run(
            ["cargo", "bench", "--bench", "rays", "--", "--warm-up-time", "0.5", "--measurement-time", "2", "rays on"],
            cwd=ROOT, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
        for group, name, shape, rays in cases:
            for query, theirs in QUERIES.items():
                rate, share = embree(shape, rays, theirs)
                label = name.format(query)
                rates.setdefault((group, label, share), []).append((phicam(group, label), rate))
    print(f"{'':58}{'phicam':>9}{'Embree':>9}  Mray/s, medians of {rounds}")
    for (group, label, share), pairs in rates.items():
        ours, theirs = (statistics.median(p[k] for p in pairs) / 1e6 for k in (0, 1))
        print(f"{group + ', ' + label:58}{ours:9.2f}{theirs:9.2f}  ratio {ours / theirs:.2f}  ({share:.1%} of the rays meet)")


if __name__ == "__main__":
    main()
