"""The scenes that are measured: `thesis` with 4 × 25 = 100 spots, its board turned in its plane, its spots a disc."""

import math
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).resolve().parents[2] / "scenes" / "thesis.toml"
BOARD = "{ corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }"
TURN = math.radians(20)
DIAMETER = 0.5  # in.


def replaced(text, old, new):
    assert text.count(old) == 1, f"{SOURCE.name} no longer holds {old!r}: follow it here"
    return text.replace(old, new)


def turned_board():
    """The board turned by TURN about its centre, in its plane; |u| = |v|, so that u and v turn into one another."""
    corner = np.array([3, 11.350951966438567, 4.149048033561433])
    u, v = np.array([4.0, 0, 0]), np.array([0, -2.82842712474619, 2.82842712474619])
    centre = corner + (u + v) / 2
    u, v = math.cos(TURN) * u + math.sin(TURN) * v, math.cos(TURN) * v - math.sin(TURN) * u
    numbers = lambda x: "[" + ", ".join(repr(float(c)) for c in x) + "]"
    return f"{{ corner = {numbers(centre - (u + v) / 2)}, u = {numbers(u)}, v = {numbers(v)} }}"


def write(folder):
    """Writes the scene files into `folder`; name → path."""
    thesis = replaced(SOURCE.read_text(encoding="utf-8"), "per_side = 30", "per_side = 25")
    texts = {
        "thesis": thesis,
        "turned": replaced(thesis, BOARD, turned_board()),
        "disc": replaced(thesis, "spot_diameter = 0.0", f"spot_diameter = {DIAMETER}"),
    }
    paths = {}
    for name, text in texts.items():
        paths[name] = folder / f"{name}.toml"
        paths[name].write_text(text, encoding="utf-8")
    return paths
