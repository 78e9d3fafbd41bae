"""Analyses a run of phicam with NumPy, and draws a figure of it. Meant to be read and copied.

usage: python analyse_run.py DIR [FIGURE.png|FIGURE.pdf]

Checks that the frames are Φcam, redoes two of phicam's recoveries and holds them against DIR/recovered, and writes DIR/analysis.png. Needs NumPy, OpenEXR and
matplotlib, and a run with one hidden surface. Exit code 1, with words, where something disagrees.
"""

import json
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import OpenEXR

run = Path(sys.argv[1])
load = lambda name: np.load(run / f"{name}.npy")
summary = json.loads((run / "summary.json").read_text())
columns, rows = json.loads((run / "run.json").read_text())["pixels"]
phi, truth = load("phi"), load("recovered/truth")  # (pixels, spots) in W; (nv, nu)
C, D = load("model/camera_side"), load("model/laser_side")  # Φcam = C·diag(ρ)·D
wrong = []

# The frames: one photograph per spot, pixel = column + row·columns. They hold Φcam rounded to 32 bits, so to the last bit.
frames = np.empty((phi.shape[1], rows, columns), np.float32)
for spot in range(len(frames)):
    frames[spot] = OpenEXR.File(str(run / f"frames/spot-{spot:04}.exr"), separate_channels=True).channels()["flux"].pixels
differ = np.flatnonzero((frames.reshape(len(frames), -1) != phi.T.astype(np.float32)).any(axis=1))
if differ.size:
    wrong.append(f"the frames of the spots {differ} are not the columns of phi.npy")
print(f"{len(frames)} frames of {columns} x {rows} pixels: {'equal to phi.npy' if not differ.size else 'DIFFERENT'}")

# Recovery as published: X = Φ·D⁺, divided by C entry by entry, mean over the pixels. Singular values at or below max(r, l)·eps·σ1 count as zero (`pinv`),
# or all but the first few (`tsvd`).
U, sigma, Vt = np.linalg.svd(D, full_matrices=False)
eps, size = np.finfo(float).eps, max(D.shape)


def recover(u, s, v, phi=phi, C=C):
    return (phi @ v.T / s @ u.T / C).mean(axis=0)


def rounding(rank):
    """How far two programs may be apart in each element by rounding alone, to first order.

    A computed singular value decomposition is that of D + E; rounding errors of n operations add up to about √n·eps (Higham and Mary, SIAM J. Sci. Comput. 41,
    A2815, 2019), so ‖E‖ = 2·√max(r, l)·eps·σ1 between two programs. Element j is entry j of x = D⁺ᵀw, w its pixels' mean of Φ/C; w = Dᵀx + r. By Wedin's identity
    B⁺ − A⁺ = −B⁺(B − A)A⁺ + B⁺(1 − AA⁺) − (1 − B⁺B)A⁺, whose projectors turn by at most ‖E‖/gap, gap = σ_k − σ_(k+1) − ‖E‖,
    |Δx_j| ≤ ‖E‖·(a·‖x‖ + a·‖r‖/gap + b·‖x‖/gap), a and b the norms of row j of D⁺ᵀ and of 1 − DD⁺. Multiplying adds 2·√l·eps·a·‖w‖.
    """
    u, s, v = U[:, :rank], sigma[:rank], Vt[:rank]
    norm = lambda m: np.linalg.norm(m, axis=0)
    w = phi.T @ (1 / C) / len(C)
    x, r = u / s @ (v @ w), w - v.T @ (v @ w)
    error = 2 * np.sqrt(size) * eps * sigma[0]
    gap = s[-1] - np.append(sigma, 0)[rank] - error
    a, b = norm((u / s).T), np.sqrt(np.maximum(1 - norm(u.T) ** 2, 0))
    return error * (a * norm(x) + a * norm(r) / gap + b * norm(x) / gap) + 2 * np.sqrt(size) * eps * a * norm(w)


def scatter(rank, found, draws=40):
    """How far NumPy's own answers lie from `found` in each element at most, where it is asked in other words: of D or its transpose, rows and columns in
    another order, each entry moved by up to eps/2 of itself. To rounding these are one and the same question.
    """
    random, apart = np.random.default_rng(1), np.zeros(len(D))
    for draw in range(draws):
        i, k = random.permutation(D.shape[0]), random.permutation(D.shape[1])
        same = (D + eps / 2 * D * random.uniform(-1, 1, D.shape))[np.ix_(i, k)]
        u, s, v = np.linalg.svd(same if draw % 2 == 0 else same.T, full_matrices=False)
        u, v = (u, v) if draw % 2 == 0 else (v.T, u.T)
        answer = recover(u[:, :rank], s[:rank], v[:rank], phi[:, k], C[:, i])
        apart[i] = np.maximum(apart[i], np.abs(answer - found[i]))
    return apart


# The bound of `rounding` holds for every matrix; where as little is left of the smallest singular value as with `pinv` it allows half of the answer and shows
# nothing. There phicam is held to NumPy's own scatter, and may be one decimal digit worse, since its decomposition is another algorithm than LAPACK's.
WORSE = 10


found = {}
for method in ("pinv", "tsvd"):
    theirs = load(f"recovered/{method}").ravel()
    kept = next(round(r["effective_rank"]) for r in summary["recovered"] if r["method"] == method)
    rank = int((sigma > size * eps * sigma[0]).sum()) if method == "pinv" else kept
    found[method] = recover(U[:, :rank], sigma[:rank], Vt[:rank])
    bound = WORSE * scatter(rank, found[method]) if method == "pinv" else rounding(rank)
    away = np.abs(found[method] - theirs)
    scale = np.abs(theirs).max()
    print(f"{method}: rank {rank}, differs by {away.max() / scale:.1e} of the largest value, {bound.max() / scale:.1e} allowed")
    print(f"      a factor is seen from about 1 + {(bound / np.abs(theirs)).min():.0e}")
    if rank != kept or not (away <= bound).all():
        wrong.append(f"{method} differs from phicam's (its rank {kept}) by up to {(away / bound).max():.2g} times what is allowed")

# The figure: what the camera saw, what the inversion has to live on, and what it finds.
plt.rcParams.update({"font.size": 8, "axes.titlesize": 8, "image.origin": "lower", "image.interpolation": "nearest", "axes.titlelocation": "left"})
figure = plt.figure(figsize=(7.1, 4.2), layout="constrained")
above, below = figure.subfigures(2, 1, height_ratios=[1.2, 1])
axes = dict(zip("abcdefg", [*above.subplots(1, 3), *below.subplots(1, 4)]))
spot = int(frames.sum(axis=(1, 2)).argmax())
image = axes["a"].imshow(1e15 * phi[:, spot].reshape(rows, columns), cmap="viridis")
axes["a"].set(title=f"(a) frame of spot {spot}", xlabel="column", ylabel="row")
figure.colorbar(image, ax=axes["a"], label="flux (fW)")
image = axes["b"].imshow(1e15 * phi, cmap="viridis", aspect="auto")
axes["b"].set(title="(b) Φcam", xlabel="spot", ylabel="pixel")
figure.colorbar(image, ax=axes["b"], label="flux (fW)")
axes["c"].semilogy(np.arange(1, sigma.size + 1), sigma / sigma[0], ".", color="#31688e", ms=4)
axes["c"].axhline(size * eps, color="0.4", lw=0.8, ls="--")
axes["c"].text(1, size * eps * 2, "cut of pinv", color="0.3")
axes["c"].set(title="(c) singular values of D", xlabel="index", ylabel=r"$\sigma_i/\sigma_1$")
joint = load("recovered/joint") if (run / "recovered/joint.npy").exists() else np.full_like(truth, np.nan)
for key, name, values in zip("defg", ("truth", "pinv", "tsvd", "joint"), (truth, found["pinv"], found["tsvd"], joint)):
    image = axes[key].imshow(np.reshape(values, truth.shape), cmap="gray", vmin=0, vmax=1)
    axes[key].set(title=f"({key}) {name}", xticks=[], yticks=[])
figure.colorbar(image, ax=axes["g"], label="reflectance")
figure.savefig(sys.argv[2] if len(sys.argv) > 2 else run / "analysis.png", dpi=300)
if wrong:
    sys.exit("\n".join(wrong))
