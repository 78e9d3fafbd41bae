"""The light of a small bench by quadrature: NumPy alone, over the arrays that a file was written from.

A wall at z = 0, a board hinged to it at y = 15.5 that leans over it at 45 degrees, three spots, 3 x 3 pixels. Three bounces:

    Phi[p, l] = power * rho1/pi * rho3/pi * int_pixel dE int_S2 G23 * rho2/pi * G12 dA,   dE = A_lens cos cos / R^2 dA

for the pinhole at C whose aperture is parallel to the wall.
"""

import numpy as np

SPOTS = [[2.0, 5.0], [5.5, 2.0], [8.5, 6.5]]
CAMERA, APERTURE, POWER, WALL = np.array([-20.0, 10.0, 15.0]), 0.05, 5e-3, 0.8
VIEW, PIXELS = [[3.25, 6.5], [2.75, 6.0]], 3
CORNER = np.array([3.0, 11.375, 4.125])
SIDES = np.array([[4.0, 0.0, 0.0], [0.0, -2.75, 2.75]])

SCENE = f"""
name = "foreign"
unit = "in"
max_bounces = 3
[laser]
power = {POWER}
wavelength = 632.8e-9
position = [-20, 10, 15]
spot_diameter = 0.0
profile = "disc"
[laser.spots]
layout = "list"
points = {SPOTS}
[camera]
position = {CAMERA.tolist()}
aperture_area = {APERTURE}
view = {{ x = {VIEW[0]}, y = {VIEW[1]} }}
pixels = [{PIXELS}, {PIXELS}]
[[surface]]
name = "wall"
role = "relay"
rectangle = {{ corner = [0, 0, 0], u = [11.5, 0, 0], v = [0, 15.5, 0] }}
material = {{ lambertian = {WALL} }}
[[surface]]
name = "object"
role = "hidden"
"""
RECTANGLE = f"rectangle = {{ corner = {CORNER.tolist()}, u = {SIDES[0].tolist()}, v = {SIDES[1].tolist()} }}"

# Seven points of degree 5 (Radon, 1948).
S = np.sqrt(15.0)
RULE = [([1 / 3] * 3, 9 / 40)]
for a, w in [((6 - S) / 21, (155 - S) / 1200), ((6 + S) / 21, (155 + S) / 1200)]:
    RULE += [([a if k != j else 1 - 2 * a for k in range(3)], w) for j in range(3)]
NODES, WEIGHTS = np.array([r[0] for r in RULE]), np.array([r[1] for r in RULE])
# No side is longer; half of it changes the light by less than 1e-9.
LONGEST = 0.7


def clipped(polygon, axis, at, sign):
    """The part of a polygon of (place, weights) where sign * place[axis] <= sign * at (Sutherland and Hodgman)."""
    found = []
    for (p, w), (q, x) in zip(polygon, polygon[1:] + polygon[:1]):
        a, b = sign * (p[axis] - at), sign * (q[axis] - at)
        if a <= 0:
            found.append((p, w))
        if a * b < 0:
            t = a / (a - b)
            found.append((p + (q - p) * t, w + (x - w) * t))
    return found


def pieces(corners, uv, cells, repeats):
    """A triangle cut at the edges of a texture's cells: smaller triangles and the albedo of each."""
    rows, columns = cells.shape
    low, high = uv.min(axis=0), uv.max(axis=0)
    assert repeats or (low.min() >= 0 and high.max() <= 1), "beyond the picture"
    numbers = [range(int(np.floor(low[d] * n)), int(np.ceil(high[d] * n))) for d, n in enumerate((columns, rows))]
    for i in numbers[0]:
        for j in numbers[1]:
            polygon = list(zip(uv, np.eye(3)))
            for axis, k, n in ((0, i, columns), (1, j, rows)):
                polygon = clipped(clipped(polygon, axis, (k + 1) / n, 1), axis, k / n, -1)
            for k in range(1, len(polygon) - 1):
                weights = np.array([polygon[0][1], polygon[k][1], polygon[k + 1][1]])
                yield weights @ corners, cells[j % rows, i % columns]


def nodes(triangles, albedos):
    """Points, normals and weights (area times albedo/pi) of a rule over small triangles."""
    triangles, albedos = np.array(triangles), np.array(albedos)
    while True:
        sides = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2).max(axis=1)
        long = sides > LONGEST
        if not long.any():
            break
        a, b, c = np.moveaxis(triangles[long], 1, 0)
        p, q, r = (a + b) / 2, (b + c) / 2, (c + a) / 2
        quarters = [np.stack(t, axis=1) for t in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))]
        triangles = np.concatenate([triangles[~long], *quarters])
        albedos = np.concatenate([albedos[~long], np.tile(albedos[long], 4)])
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    twice = np.linalg.norm(cross, axis=1)
    kept = twice > 1e-12
    normals = np.repeat(cross[kept] / twice[kept, None], len(WEIGHTS), axis=0)
    weights = (0.5 * twice * albedos / np.pi)[kept, None] * WEIGHTS
    return np.einsum("kc,tcx->tkx", NODES, triangles[kept]).reshape(-1, 3), normals, weights.reshape(-1)


def kernel(walls, points, normals):
    """cos cos / R^2 between points of the wall and of the surface; zero behind it."""
    along = points[None] - walls[:, None]
    square = (along**2).sum(axis=2)
    front = -(along * normals[None]).sum(axis=2)
    return along[:, :, 2] * np.maximum(front, 0.0) / square**2


def phi(triangles, albedo, uv=None, repeats=False):
    """Pixels x spots, W. `albedo` is a number, or a texture of cells: rows along v from the corner."""
    if uv is None:
        parts = [(corners, albedo) for corners in triangles]
    else:
        cells = np.atleast_2d(np.asarray(albedo, float))
        parts = [part for corners, own in zip(triangles, uv) for part in pieces(corners, own, cells, repeats)]
    points, normals, weights = nodes(*zip(*parts))
    x, w = np.polynomial.legendre.leggauss(4)
    x, w = (x + 1) / 2, w / 2
    size = [(high - low) / PIXELS for low, high in VIEW]
    seen = np.zeros((PIXELS**2, len(points)))
    for pixel in range(PIXELS**2):
        at = [VIEW[d][0] + (k + x) * size[d] for d, k in enumerate((pixel % PIXELS, pixel // PIXELS))]
        walls = np.array([[a, b, 0.0] for a in at[0] for b in at[1]])
        square = ((CAMERA - walls) ** 2).sum(axis=1)
        etendue = APERTURE * CAMERA[2] ** 2 / square**2 * np.outer(w, w).ravel() * size[0] * size[1]
        seen[pixel] = (etendue * WALL / np.pi) @ kernel(walls, points, normals)
    lit = POWER * WALL / np.pi * kernel(np.array([[*s, 0.0] for s in SPOTS]), points, normals)
    return (seen * weights) @ lit.T


def rectangle(cells):
    """The same of the board itself, with a texture."""
    a, b = CORNER, CORNER + SIDES[0]
    c, d = b + SIDES[1], CORNER + SIDES[1]
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return phi(np.array([[a, b, c], [a, c, d]]), cells, square[[[0, 1, 2], [0, 2, 3]]])
