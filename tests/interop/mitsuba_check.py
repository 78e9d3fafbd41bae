"""Holds phicam to Mitsuba 3: no fitted factor, every entry by its own standard errors.

usage: python mitsuba_check.py SCRIPT PHI [--spots A..B] [--spp N] [--seed S] [--significance ALPHA]

SCRIPT is what `phicam scene export SCENE --mitsuba` wrote, PHI the phi.npy of a run of the same scene (estimator
`independent`, so that errors are independent between entries), beside its phi.stderr.npy. Spots A to B - 1 are rendered by
SCRIPT and compared with the same columns of PHI. Exit code 1 if any of three tests rejects at its significance ALPHA:

  chi^2       sum of z^2, z = (mitsuba - phicam) / joint standard error, outside its two-sided band
  largest |z| against the normal law, Sidak-corrected for the number of entries
  scale       c = <mitsuba, phicam> / <phicam, phicam>, the latter less its noise, must be 1 within its error. Its weights know nothing of
              Mitsuba's noise: weights from standard errors would favour entries that came out low, whose estimated errors
              are low too, and pull c down by (relative variance of one sample) / spp.

For the same reason z is skewed where few samples contribute: its third moment is about -2 / sqrt(contributing samples). At
the default of 16384 samples, a tenth of which contribute on the bench, the normal law holds to beyond 4.5 deviations.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import NormalDist

import numpy as np

parser = argparse.ArgumentParser(description="Compare phicam's matrix with Mitsuba's.")
parser.add_argument("script", type=Path)
parser.add_argument("phi", type=Path)
parser.add_argument("--spots", default=None, metavar="A..B")
parser.add_argument("--spp", type=int, default=16384)
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--significance", type=float, default=1e-3)
args = parser.parse_args()

phi, phi_error = np.load(args.phi), np.load(args.phi.with_suffix(".stderr.npy"))
spots = args.spots or f"0..{phi.shape[1]}"
first, end = (int(x) for x in spots.split(".."))
phi, phi_error = phi[:, first:end], phi_error[:, first:end]
with tempfile.TemporaryDirectory() as folder:
    out = Path(folder) / "phi.npy"
    command = [sys.executable, args.script, "-o", out, "--spots", spots, "--spp", args.spp, "--seed", args.seed]
    subprocess.run([str(c) for c in command], check=True)
    peer, peer_error = np.load(out), np.load(out.with_suffix(".stderr.npy"))
assert peer.shape == phi.shape, f"{peer.shape} is not {phi.shape}: another scene or other spots"

joint = np.hypot(phi_error, peer_error)
exact = joint == 0
agree = bool(np.all(np.abs(peer - phi)[exact] <= 1e-5 * np.abs(phi)[exact]))  # f32
z = ((peer - phi) / np.where(exact, 1, joint))[~exact]
n, normal = z.size, NormalDist()
assert n > 0 and np.isfinite(z).all(), "nothing to compare"

# chi^2 / n by Wilson and Hilferty: its cube root is normal, mean 1 - 2 / 9n, variance 2 / 9n.
quantile = normal.inv_cdf(1 - args.significance / 2)
low, high = ((1 - 2 / (9 * n) + s * quantile * np.sqrt(2 / (9 * n))) ** 3 for s in (-1, 1))
chi2 = float((z * z).sum() / n)
# P(max |z| > t) = 1 - (1 - p)^n with p = P(|z| > t).
most = normal.inv_cdf(1 + np.expm1(np.log1p(-args.significance) / n) / 2)
largest = float(np.abs(z).max())
# The square of a noisy entry is too large by its variance.
norm = (phi**2 - phi_error**2).sum()
scale = float((peer * phi).sum() / norm)
scale_error = float(np.sqrt((phi**2 * joint**2).sum()) / norm)

print(f"{n} entries; relative standard error: phicam {np.mean(phi_error[phi > 0] / phi[phi > 0]):.1e}, Mitsuba {np.mean(peer_error[phi > 0] / phi[phi > 0]):.1e}")
verdicts = [
    (f"chi^2/dof   {chi2:.4f}   allowed {low:.4f} to {high:.4f}", low <= chi2 <= high),
    (f"largest |z| {largest:.2f}     allowed {most:.2f}", largest <= most),
    (f"scale       {scale:.5f} +- {scale_error:.5f} (z = {(scale - 1) / scale_error:.2f}, allowed {quantile:.2f})", abs(scale - 1) <= quantile * scale_error),
]
if exact.any():
    verdicts.append((f"{exact.sum()} entries without error: equal to f32 rounding", agree))
for text, passed in verdicts:
    print(("ok        " if passed else "REJECTED  ") + text)
sys.exit(0 if all(passed for _, passed in verdicts) else 1)
