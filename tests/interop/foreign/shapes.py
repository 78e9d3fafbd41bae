"""The surfaces that are written: a bent sheet with texture coordinates, a flat board of quadrilaterals, an M."""

import numpy as np

from .case import EXACT, Case
from .light import CORNER, RECTANGLE, SIDES, phi

# Rows along v from the corner; no two alike.
CELLS = np.array([[0.1, 0.9, 0.3, 0.7], [0.2, 0.8, 0.6, 0.4], [0.5, 0.15, 0.95, 0.35]])
GREY = 0.7


def single(values):
    """Rounded to f32, which every format keeps."""
    return np.asarray(values, np.float32).astype(float)


class Shape:
    """Vertices, faces (counterclockwise from the front) and a pair of texture coordinates for each vertex."""

    def __init__(self, positions, faces, uv=None):
        self.positions, self.faces = single(positions), [list(f) for f in faces]
        self.uv = None if uv is None else single(uv)
        # A fan, for all faces but the M are convex.
        self.triangles = np.array([[f[0], f[k], f[k + 1]] for f in self.faces for k in range(1, len(f) - 1)])
        self.truths = {}

    def truth(self, albedo, repeats=False, uv=None):
        """Its light, computed once; `uv` in place of its own."""
        key = (np.asarray(albedo).tobytes(), repeats, None if uv is None else uv.tobytes())
        if key not in self.truths:
            varied = np.ndim(albedo) > 0
            own = self.uv if uv is None else uv
            places = own[self.triangles] if varied else None
            self.truths[key] = phi(self.positions[self.triangles], albedo, places, repeats)
        return self.truths[key]

    def normals(self):
        """One for each vertex, of its faces."""
        found = np.zeros_like(self.positions)
        for a, b, c in self.triangles:
            p, q, r = self.positions[[a, b, c]]
            found[[a, b, c]] += np.cross(q - p, r - p)
        return found / np.linalg.norm(found, axis=1)[:, None]


def grid(columns, rows, bend):
    """A sheet over the board, bent towards its front, its inner vertices moved along it."""
    s, t = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    inside = np.sin(np.pi * s) * np.sin(np.pi * t)
    moved = [s + 0.06 * inside * np.cos(3 * t), t + 0.05 * inside * np.sin(5 * s)]
    front = np.array([0.0, -1.0, -1.0]) / np.sqrt(2)
    positions = CORNER + sum(m.ravel()[:, None] * side for m, side in zip(moved, SIDES))
    positions = positions + bend * (inside * (1 + 0.5 * s)).ravel()[:, None] * front
    quads = []
    for j in range(rows):
        for i in range(columns):
            a = i + j * (columns + 1)
            quads.append([a, a + 1, a + columns + 2, a + columns + 1])
    return positions, quads, np.stack([(0.98 * s + 0.02 * t).ravel(), (0.03 * s + 0.97 * t**1.2).ravel()], axis=1)


def halved(quads):
    return [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]


places, quads, uv = grid(6, 5, 0.35)
SHEET = Shape(places, halved(quads), uv)
# Quadrilaterals must be flat to a thousandth of their size: this one is, after rounding.
places, quads, uv = grid(4, 3, 0.0)
BOARD = Shape(places, quads, uv)
M = np.array([[0, 0], [1, 0], [2, 2], [3, 0], [4, 0], [4, 4], [0, 4]]) / 4
LETTER = Shape(CORNER + M @ SIDES, [range(7)])
# The wedge from below is left out: the hull's fan over (0, 1, 5, 6), (1, 2, 5) and (2, 3, 4, 5) ...
LETTER.triangles = np.array([[0, 1, 6], [1, 2, 6], [2, 5, 6], [2, 3, 5], [3, 4, 5]])


TEXTURE = f"{{ cells = {CELLS.tolist()} }}"


def textured(path, layout, shape=SHEET, more="", texture=TEXTURE, truth=None, elements="[4, 3]"):
    """A file with texture coordinates: the cells of a texture lie where they say."""
    keys = f'mesh = {{ file = "{path.name}"{more} }}\nmaterial = {{ lambertian = {texture} }}\nelements = {elements}\n'
    return Case(path, layout, keys, shape.truth(CELLS) if truth is None else truth)


def plain(path, layout, shape=SHEET):
    """A file whose texture coordinates, if it has any, do not matter."""
    return Case(path, layout, bare(path), shape.truth(GREY))


def bare(path):
    return f'mesh = {{ file = "{path.name}" }}\nmaterial = {{ lambertian = {GREY} }}\nelements = "faces"\n'


def refused(path, layout, *words):
    """A mesh that is to be refused with these words."""
    return Case(path, layout, bare(path), None, words=words)


def picture(path, layout, albedo, keys, allowed=EXACT):
    """A picture on the board."""
    surface = f'{RECTANGLE}\nmaterial = {{ lambertian = {{ image = "{path.name}"{keys} }} }}\nelements = [4, 3]\n'
    return Case(path, layout, surface, albedo, allowed)
