"""Computes the published study in NumPy and holds the folder of a finished `phicam reproduce` against it.

usage: python published_reference.py DIR [--most-elements N]

Written from the description of the published simulation alone, not from phicam's sources. Lengths in inches. Checked, where DIR has the item's CSV:

* table1, fig12 to fig17, fig20 and the double-precision rows of precision: rank of G12 equal, raw MTF within 6e-3, normalized MTF within 2.5e-2. That is how
  far apart two LAPACK drivers (gesdd and gesvd) are on the same matrices, for Φ is formed in doubles and multiplied by an inverse of condition 1e13; their ranks are equal.
* mrdivide in table1: rank of the column-pivoted QR equal. The basic solution leaves out elements that pivoting chooses by the last digits, so its MTF is not compared.
* fig22: mean normalized MTF over draws of its own, within five standard errors of the difference; within 2.5e-2 more where the noise is that of rounding.
* table2 to table4: K to 1e-12.
* the rows of precision beyond doubles: a projector of 100 digits by Python's `decimal`; rank equal, 1 − raw MTF to 1e-9.

Rows of traced Φcam are noise of one render and no reference's business. Panels of more elements a side than N (16 if not given) are left out: 64 take two minutes.
"""

import argparse
import csv
import sys
from decimal import Decimal, getcontext
from functools import lru_cache
from pathlib import Path

import numpy as np

RAW, NORMALIZED = 6e-3, 2.5e-2
HINGE, NEAR, PIXELS = 15.5, 5.86764, 16
EPS = 2.0**-52


def elements(side):
    step = 4 / side
    along = (np.arange(side) + 0.5) * step
    x, d = np.tile(3 + along, side), np.repeat(NEAR + along, side)
    z = d / np.sqrt(2)
    return x, HINGE - z, z


def pixels():
    x, y = np.linspace(6.5, 3.25, PIXELS), np.linspace(2.75, 6, PIXELS)
    return np.tile(x, PIXELS), np.repeat(y, PIXELS)


def spots(per_side, half_width, stagger):
    cx, cy = 5.0, HINGE - 7.86764 * np.sqrt(2)
    xs = np.linspace(cx - half_width, cx + half_width, per_side)
    ys = np.linspace(cy + half_width, cy - half_width, per_side)
    off = np.array([0.0, -1.0, 1.0])[np.arange(1, per_side + 1) % 3] * stagger
    x = [xs, cx + half_width + off, xs[::-1], cx - half_width + off]
    y = [cy - half_width + off, ys[::-1], cy + half_width + off, ys]
    return np.concatenate(x), np.concatenate(y)


def kernel(wall, side, name):
    (x, y), (x2, y2, z2) = (c[:, None] for c in wall), elements(side)
    plane = (y - y2) ** 2 + z2**2
    root = {"published": np.sqrt(plane / 2), "physical": (HINGE - y) / np.sqrt(2)}[name]
    return z2 * root / ((x - x2) ** 2 + plane) ** 2


def board(side, checks):
    at = np.arange(side) * checks // side
    return ((at[:, None] + at) % 2).ravel().astype(float)


def mtf(image, truth):
    def ratio(v):
        white, black = v[truth == 1].sum(), v[truth == 0].sum()
        return (white - black) / (white + black)

    return ratio(image), ratio((image - image.min()) / (image.max() - image.min()))


@lru_cache(maxsize=None)
def g23(side, name):
    return kernel(pixels(), side, name)


@lru_cache(maxsize=None)
def decomposed(side, per_side, half_width, stagger, name):
    g12 = kernel(spots(per_side, half_width, stagger), side, name).T
    return g12, np.linalg.svd(g12, full_matrices=False)


def rank_by(sigma, shape, rule):
    if rule == "MATLAB":
        return int((sigma > max(shape) * np.spacing(sigma[0])).sum())
    return int((sigma > rule * max(shape) * EPS * sigma[0]).sum())


def inverse(case, rule="MATLAB"):
    g12, (u, sigma, vt) = decomposed(*case)
    rank = rank_by(sigma, g12.shape, rule)
    return rank, (vt[:rank].T / sigma[:rank]) @ u[:, :rank].T


def recovered(case, checks, rule="MATLAB"):
    side, name = case[0], case[4]
    rank, pinv = inverse(case, rule)
    view, truth = g23(side, name), board(side, checks)
    phi = (view * truth) @ decomposed(*case)[0]
    return rank, *mtf((phi @ pinv / view).mean(axis=0), truth)


def pivoted_rank(a):
    """Rank of a by Householder QR with column pivoting, cut at max(shape) spacings of |R11|."""
    r, diagonal = a.copy(), []
    for k in range(min(a.shape)):
        norms = (r[k:, k:] ** 2).sum(axis=0)
        best = k + int(norms.argmax())
        r[:, [k, best]] = r[:, [best, k]]
        v = r[k:, k].copy()
        v[0] += np.copysign(np.linalg.norm(v), v[0])
        v /= np.linalg.norm(v)
        r[k:, k:] -= 2 * np.outer(v, v @ r[k:, k:])
        diagonal.append(abs(r[k, k]))
    diagonal = np.array(diagonal)
    return int((diagonal > max(a.shape) * np.spacing(diagonal[0])).sum())


def exact_projector(side, per_side, half_width):
    """(rank, G12·G12⁺) with 100 digits; the projector as doubles, for what is done with it is no longer ill-conditioned."""
    getcontext().prec = 100
    root2, hinge = Decimal(2).sqrt(), Decimal("15.5")
    h, n = Decimal(repr(half_width)), per_side - 1
    cx, cy = Decimal(5), hinge - Decimal("7.86764") * root2
    line = [-h + 2 * h * i / n for i in range(n)]
    sides = [lambda t: (t, -h), lambda t: (h, t), lambda t: (-t, h), lambda t: (-h, -t)]
    wall = [(cx + a, cy + b) for s in sides for a, b in map(s, line)]
    along = [Decimal(2 * (2 * i + 1)) / side for i in range(side)]
    rows = []
    for d in along:
        z2 = (Decimal("5.86764") + d) / root2
        y2 = hinge - z2
        for x2 in (3 + a for a in along):
            row = []
            for x, y in wall:
                plane = (y - y2) ** 2 + z2 * z2
                row.append(z2 * (plane / 2).sqrt() / ((x - x2) ** 2 + plane) ** 2)
            rows.append(row)
    wide = len(rows) <= len(wall)
    basis = []
    for v in rows if wide else [list(c) for c in zip(*rows)]:
        # Twice is enough: the second pass takes out what rounding left of the first.
        for _ in range(2):
            for q in basis:
                along_q = sum(map(Decimal.__mul__, q, v))
                v = [a - along_q * b for a, b in zip(v, q)]
        length = sum(a * a for a in v).sqrt()
        if length < Decimal("1e-60"):
            continue
        basis.append([a / length for a in v])
    if wide and len(basis) == len(rows):
        return len(basis), np.eye(len(rows))
    q = np.array(basis, dtype=float)
    return len(basis), q.T @ q


class Report:
    """What was compared, and what does not agree."""

    def __init__(self, folder):
        self.folder, self.wrong = folder, 0

    def rows(self, item):
        path = self.folder / f"{item}.csv"
        if not path.is_file():
            return []
        rows = list(csv.DictReader(path.open(encoding="utf-8")))
        return [r for r in rows if r.get("phi", "modelled") == "modelled"]

    def item(self, name, compare):
        rows, worst, count = self.rows(name), {}, 0
        for row in rows:
            for what, (error, allowed) in (compare(row) or {}).items():
                count += 1
                worst[what] = max(worst.get(what, 0.0), error)
                if not error <= allowed:
                    self.wrong += 1
                    print(f"{name}: {what} off by {error:.3g} (allowed {allowed:.3g}): {row}")
        if rows:
            print(f"{name}: {count} comparisons; largest difference " + ", ".join(f"{w} {e:.2g}" for w, e in worst.items()))


def compared(row, found):
    rank, raw, normalized = found
    out = {"rank": (abs(int(row["rank"]) - rank), 0), "raw MTF": (abs(float(row["mtf_raw"]) - raw), RAW)}
    if "mtf_normalized" in row:
        out["normalized MTF"] = (abs(float(row["mtf_normalized"]) - normalized), NORMALIZED)
    return out


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--most-elements", type=int, default=16)
    arguments = parser.parse_args()
    most = arguments.most_elements
    report = Report(arguments.folder)

    def table1(row):
        case = (8, int(row["spots"]) // 4, 6.0, False, row["kernel"])
        if row["method"].startswith("Moore"):
            return compared(row, recovered(case, 2))
        return {"rank of the pivoted QR": (abs(int(row["rank"]) - pivoted_rank(decomposed(*case)[0].T)), 0)}

    def by_spots(row):
        side = int(row["elements"])
        if side <= most:
            case = (side, int(row["spots"]) // 4, 6.0, False, row["kernel"])
            return compared(row, recovered(case, int(row.get("board", side))))

    def by_distance(row):
        case = (8, 25, float(row["half_width_in"]), row["layout"] == "stagger", row["kernel"])
        return compared(row, recovered(case, 8))

    @lru_cache(maxsize=None)
    def noise(side, name, percent, draws=40):
        case = (side, 30, 6.0, True, name)
        view, truth = g23(side, name), board(side, side)
        phi, pinv = (view * truth) @ decomposed(*case)[0], inverse(case)[1]
        random = np.random.default_rng(7)

        def draw():
            seen = phi * (1 + percent / 100 * random.standard_normal(phi.shape))
            return mtf((seen @ pinv / view).mean(axis=0), truth)[1]

        values = np.array([draw() for _ in range(draws)])
        return values.mean(), values.std(ddof=1) / np.sqrt(draws)

    def by_noise(row):
        mean, error = noise(int(row["elements"]), row["kernel"], float(row["noise_percent"]))
        own = float(row["mtf_normalized_deviation"]) / np.sqrt(float(row["draws"]))
        # Noise below 1e-13 of each entry is no more than a few hundred roundings of it: the order of operations shows, as it does without noise.
        rounding = NORMALIZED if float(row["noise_percent"]) < 1e-11 else 1e-6
        return {"mean normalized MTF": (abs(float(row["mtf_normalized"]) - mean), 5 * np.hypot(error, own) + rounding)}

    rules = {"N·eps(σ1) (MATLAB)": "MATLAB", "N·2⁻⁵²·σ1 (NumPy, Octave)": 1.0, "10·N·2⁻⁵²·σ1": 10.0, "0.1·N·2⁻⁵²·σ1": 0.1}

    @lru_cache(maxsize=None)
    def exact(side, per_side, half_width):
        return exact_projector(side, per_side, half_width)

    def beyond(row):
        side, per_side, half_width = int(row["elements"]), int(row["spots"]) // 4, float(row["half_width_in"])
        if row["arithmetic"] in rules:
            rule = rules[row["arithmetic"]]
            found = recovered((side, per_side, half_width, False, "published"), int(row["board"]), rule)
            return compared(row, found) if rule != 0.1 else {"rank": compared(row, found)["rank"]}
        # Many digits are slow in Python: of the large ones, those that phicam alone does are left out.
        if side * side * 4 * per_side > 20_000:
            return None
        rank, projector = exact(side, per_side, half_width)
        view, truth = g23(side, "published"), board(side, int(row["board"]))
        raw, _ = mtf(((view * truth) @ projector / view).mean(axis=0), truth)
        return {
            "rank beyond doubles": (abs(int(row["rank"]) - rank), 0),
            "1 − raw MTF beyond doubles": (abs(float(row["one_minus_mtf_raw"]) - (1 - raw)), 1e-9),
        }

    def k_of(apart):
        def table(row):
            if row["line"] not in ("lower line", "upper line"):
                return None
            d = NEAR + 0.25 + 0.5 * (int(row["row"]) - 1)
            lines = {}
            for name, y in (("lower line", 4.375 - apart), ("upper line", 4.375 + apart)):
                s = HINGE - y
                r2 = s * s + d * d - np.sqrt(2) * s * d
                lines[name] = np.sqrt(0.5) * d * np.sqrt(0.5) * s / r2**2
            return {"K, relative": (abs(float(row["computed"]) / lines[row["line"]] - 1), 1e-12)}

        return table

    report.item("table1", table1)
    for name, apart in (("table2", 7.5), ("table3", 1.0), ("table4", 11.0)):
        report.item(name, k_of(apart))
    for name in ("fig12", "fig13", "fig14", "fig15"):
        report.item(name, by_spots)
    for name in ("fig17", "fig20"):
        report.item(name, by_distance)
    report.item("fig22", by_noise)
    report.item("precision", beyond)
    if report.wrong:
        sys.exit(f"{report.wrong} comparisons do not agree")


main()
