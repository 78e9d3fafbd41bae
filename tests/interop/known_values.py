"""Recomputes every known answer of scenes/known/ from its formula, in 25 digits, and compares it with the file.

usage: python known_values.py [--write] [NAME…]        needs mpmath

Nothing here knows phicam: geometry is read from the scene file, light from the equations in its header. Integrals are product
Gauss-Legendre rules over pieces on which the integrand is smooth; each is done twice, with more nodes the second time, and
must not change by more than 1e-11. --write puts the values into the files in place of those that stand there.
"""

import sys
import tomllib
from itertools import product
from pathlib import Path

from mpmath import acos, asin, atan, cos, exp, mp, mpf, pi, sin, sqrt

mp.dps = 25
FOLDER = Path(__file__).resolve().parents[2] / "scenes" / "known"
NODES = {}


# -- quadrature ---------------------------------------------------------------------------------------------------------


def nodes(n):
    """Gauss-Legendre nodes and weights on [0, 1]: zeros of P_n by Newton's method."""
    if n not in NODES:
        found = []
        for k in range(n):
            x = cos(pi * (k + mpf(3) / 4) / (n + mpf(1) / 2))
            for _ in range(8):
                p, q = mpf(1), mpf(0)
                for j in range(n):
                    p, q = ((2 * j + 1) * x * p - j * q) / (j + 1), p
                slope = n * (x * p - q) / (x * x - 1)
                x -= p / slope
            found.append(((1 - x) / 2, 1 / ((1 - x * x) * slope * slope)))
        NODES[n] = found
    return NODES[n]


def line(edges, n):
    """Nodes and weights over the pieces between sorted edges."""
    out = []
    for a, b in zip(edges, edges[1:]):
        if b > a:
            out += [(a + (b - a) * t, (b - a) * w) for t, w in nodes(n)]
    return out


def pieces(a, b, *cuts):
    """Edges of [a, b] divided at the cuts that lie in it."""
    return sorted({a, b, *(c for c in map(mpf, cuts) if a < c < b)})


# -- vectors ------------------------------------------------------------------------------------------------------------


def add(a, b, t=1):
    return [p + t * q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def form(a, na, b, nb):
    """cosθ·cosθ'/d² between two points; 0 behind either."""
    r = add(b, a, -1)
    ca, cb, d2 = dot(na, r), -dot(nb, r), dot(r, r)
    return ca * cb / (d2 * d2) if ca > 0 and cb > 0 else mpf(0)


# -- scenes -------------------------------------------------------------------------------------------------------------


class Surface:
    def __init__(self, table):
        if "sphere" in table:
            return
        self.corner, self.u, self.v = ([mpf(c) for c in table["rectangle"][k]] for k in ("corner", "u", "v"))
        n = cross(self.u, self.v)
        self.area = sqrt(dot(n, n))
        self.normal = [c / self.area for c in n]
        self.albedo = table["material"]["lambertian"]

    def at(self, a, b):
        return add(add(self.corner, self.u, a), self.v, b)

    def above(self, x, y):
        """The point of the plane over (x, y)."""
        n, c = self.normal, self.corner
        return [x, y, c[2] - (n[0] * (x - c[0]) + n[1] * (y - c[1])) / n[2]]

    def rho(self, p):
        if not isinstance(self.albedo, dict):
            return mpf(self.albedo)
        q = add(p, self.corner, -1)
        cell = [int(dot(q, e) / dot(e, e) * k) for e, k in zip((self.u, self.v), self.albedo["checkerboard"])]
        return mpf(self.albedo["dark" if sum(cell) % 2 == 0 else "light"])


class Scene:
    def __init__(self, path):
        self.text = path.read_text()
        table = tomllib.loads(self.text, parse_float=mpf)
        self.known, self.max_bounces = table["known"], table["max_bounces"]
        self.surface = {s["name"]: Surface(s) for s in table["surface"]}
        self.camera = [mpf(c) for c in table["camera"]["position"]]
        self.aperture = mpf(table["camera"]["aperture_area"])
        self.view, self.pixels = table["camera"]["view"], table["camera"]["pixels"]
        laser = table["laser"]
        self.power, self.radius = laser["power"], mpf(laser.get("spot_diameter", 0)) / 2
        self.spots = [[mpf(c) for c in p] for p in laser["spots"]["points"]]
        self.table = table

    def box(self, pixel):
        """[x0, x1], [y0, y1] of a pixel's footprint."""
        index = [pixel % self.pixels[0], pixel // self.pixels[0]]
        step = [(mpf(self.view[k][1]) - mpf(self.view[k][0])) / n for k, n in zip("xy", self.pixels)]
        return [[mpf(self.view[k][0]) + s * i, mpf(self.view[k][0]) + s * (i + 1)] for k, s, i in zip("xy", step, index)]

    def footprint(self, pixel, wall, n, cuts=((), ())):
        """Points of a pixel's footprint on the plane of `wall`, with étendue as their weight."""
        (x0, x1), (y0, y1) = self.box(pixel)
        return self.rectangle(pieces(x0, x1, *cuts[0]), pieces(y0, y1, *cuts[1]), wall, n)

    def rectangle(self, xs, ys, wall, n):
        for (x, wx), (y, wy) in product(line(xs, n), line(ys, n)):
            p = wall.above(x, y)
            r = add(self.camera, p, -1)
            d2 = dot(r, r)
            cos2 = dot(wall.normal, r) ** 2 / d2
            yield p, self.aperture * cos2 / d2 * wx * wy / abs(wall.normal[2])


def patch(s, n, cuts_a=(), cuts_b=()):
    """Points of a surface with area as their weight."""
    a, b = (line(pieces(mpf(0), mpf(1), *c), n) for c in (cuts_a, cuts_b))
    return [(s.at(p, q), s.area * wp * wq) for (p, wp), (q, wq) in product(a, b)]


# -- recipes: (scene, pixel, spot, bounces, order of the rule) → flux -------------------------------------------------------


def furnace(scene, pixel, spot, bounces, n):
    cavity = scene.table["surface"][0]
    a, radius, h = mpf(cavity["material"]["lambertian"]), mpf(cavity["sphere"]["radius"]), scene.camera[2]

    def corner(s, t):
        p, q = sqrt(h * h + s * s), sqrt(h * h + t * t)
        return (s / p * atan(t / p) + t / q * atan(s / q)) / 2

    (x0, x1), (y0, y1) = ([c - o for c in side] for side, o in zip(scene.box(pixel), scene.camera))
    etendue = scene.aperture * (corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0))
    orders = [bounces] if bounces else range(1, scene.max_bounces + 1)
    return scene.power * etendue / (4 * pi**2 * radius**2) * sum(a**k for k in orders if k > 1)


def direct(lit, seen):
    """Two surfaces: from the spot straight to the view. `lit` names the surface of each spot."""

    def recipe(scene, pixel, spot, bounces, n):
        if bounces == 1:
            return mpf(0)
        one = scene.surface[lit if isinstance(lit, str) else lit[spot]]
        two = scene.surface[seen]
        s = one.above(*scene.spots[spot])
        total = sum(e * two.rho(x) * form(x, two.normal, s, one.normal) for x, e in scene.footprint(pixel, two, 3 * n))
        return scene.power * one.rho(s) / pi**2 * total

    return recipe


def image_plane(scene, pixel, spot, bounces, n):
    wall, plane = scene.surface["wall"], scene.surface["plane"]
    s, h = wall.above(*scene.spots[spot]), plane.corner[2]
    one = mpf(0)
    if all(a <= c < b for c, (a, b) in zip(s, scene.box(pixel))):
        r = add(scene.camera, s, -1)
        one = scene.power * wall.albedo / pi * scene.aperture * r[2] ** 2 / dot(r, r) ** 2
    if bounces == 1:
        return one
    if bounces == 2:
        return mpf(0)

    def kernel(d2):
        return 2 * pi * h**4 * sum(w * t * (1 - t) / (h * h + t * (1 - t) * d2) ** 3 for t, w in nodes(2 * n))

    total = sum(e * kernel(dot(add(x, s, -1), add(x, s, -1))) for x, e in scene.footprint(pixel, wall, n))
    three = scene.power * mpf(wall.albedo) ** 2 * plane.albedo / pi**3 * total
    return three if bounces == 3 else one + three


def hidden_face(face="face", cuts_a=(), cuts_b=(), fp_cuts=((), ()), share=mpf(1) / 2):
    """Three surfaces by way of one face that is seen whole; `share` of the face's nodes on the footprint."""

    def recipe(scene, pixel, spot, bounces, n):
        wall, f = scene.surface["wall"], scene.surface[face]
        s = wall.above(*scene.spots[spot])
        points = [(y, w * f.rho(y) * form(y, f.normal, s, wall.normal)) for y, w in patch(f, n, cuts_a, cuts_b)]
        points = [(y, w) for y, w in points if w]
        total = mpf(0)
        for x, e in scene.footprint(pixel, wall, max(4, int(n * share)), fp_cuts):
            total += e * wall.rho(x) * sum(w * form(x, wall.normal, y, f.normal) for y, w in points)
        return scene.power * wall.rho(s) / pi**3 * total

    return recipe


def clipped(scene, pixel, spot, n, face, bounds):
    """∫_footprint étendue ∫ G·G over rectangles of a face parallel to the wall z = 0.

    `bounds(scene, s)`: the edges m of what a wall point x projects onto the face, to m − kx, that k, and the spot's rectangle.
    The footprint is divided where an edge that moves with x meets one that does not."""
    wall, f = scene.surface["wall"], scene.surface[face]
    s, z = wall.above(*scene.spots[spot]), f.corner[2]
    corner, far = f.corner, f.at(1, 1)
    outer = [sorted((corner[i], far[i])) for i in (0, 1)]
    moving, k, fixed = bounds(scene, s)
    # An edge m − kx of the moving rectangle meets a fixed edge q at x = (m − q)/k.
    cuts = tuple([(m - q) / k for m in moving[i] for q in (*outer[i], *fixed[i])] for i in (0, 1))
    total = mpf(0)
    for x, e in scene.footprint(pixel, wall, max(4, n // 2), cuts):
        seen = [[m - k * x[i] for m in moving[i]] for i in (0, 1)]
        for sign, parts in rectangles(bounds, outer, seen, fixed):
            sides = []
            for i in (0, 1):
                low, high = max(p[i][0] for p in parts), min(p[i][1] for p in parts)
                sides.append(line([low, high], n))
            for (p, wp), (q, wq) in product(*sides):
                y = [p, q, z]
                total += sign * e * wp * wq * form(x, wall.normal, y, f.normal) * form(y, f.normal, s, wall.normal)
    return scene.power * mpf(wall.albedo) ** 2 * f.albedo / pi**3 * total


def hole(scene, s):
    a = [scene.surface["screen, below"].corner[0], scene.surface["screen, right"].corner[0]]
    below = scene.surface["screen, below"]
    b = [below.at(1, 1)[1], scene.surface["screen, above"].corner[1]]
    ratio = scene.surface["face"].corner[2] / below.corner[2]
    return shadow([a, b], ratio, s)


def front_shadow(scene, s):
    front = scene.surface["front"]
    sides = [sorted((front.corner[i], front.at(1, 1)[i])) for i in (0, 1)]
    return shadow(sides, scene.surface["back"].corner[2] / front.corner[2], s)


def shadow(sides, ratio, s):
    """Central projection from a point x of z = 0: q ↦ x + ratio·(q − x) = ratio·q − k·x, k = ratio − 1."""
    moving, k = [[ratio * q for q in side] for side in sides], ratio - 1
    return moving, k, [[m - k * s[i] for m in moving[i]] for i in (0, 1)]


def rectangles(bounds, outer, seen, fixed):
    if bounds is hole:
        return [(1, (outer, seen, fixed))]
    return [(1, (outer,)), (-1, (outer, seen)), (-1, (outer, fixed)), (1, (outer, seen, fixed))]


def aperture(scene, pixel, spot, bounces, n):
    return clipped(scene, pixel, spot, n, "face", hole)


def overlap(scene, pixel, spot, bounces, n):
    return hidden_face("front")(scene, pixel, spot, bounces, n) + clipped(scene, pixel, spot, n, "back", front_shadow)


def cut_spot(scene, pixel, spot, bounces, n):
    """Two surfaces, the spot spread over the floor where x > 0."""
    floor, seen, r = scene.surface["floor"], scene.surface["seen"], scene.radius
    cx, cy = scene.spots[spot]
    lit = []
    if scene.table["laser"].get("profile") == "gaussian":
        xs = pieces(max(mpf(0), cx - 7 * r), cx + 7 * r, *(cx + k * r for k in (-4, -2, 0, 2, 4)))
        ys = [cy + k * r for k in (-7, -4, -2, 0, 2, 4, 7)]
        for (x, wx), (y, wy) in product(line(xs, n), line(ys, n)):
            lit.append(([x, y, mpf(0)], wx * wy * 2 / (pi * r * r) * exp(-2 * ((x - cx) ** 2 + (y - cy) ** 2) / r**2)))
    else:
        start = asin(max(mpf(-1), -cx / r))
        for phi, w in line([start, pi / 2], n):
            for t, v in line([mpf(-1), mpf(1)], n):
                lit.append(([cx + r * sin(phi), cy + t * r * cos(phi), mpf(0)], w * v * cos(phi) ** 2 / pi))
    if spot == 0:  # half of the power passes the edge
        assert abs(sum(w for _, w in lit) - mpf(1) / 2) < mpf(10) ** -12, sum(w for _, w in lit)
    total = mpf(0)
    for x, e in scene.footprint(pixel, seen, max(8, n // 2)):
        total += e * sum(w * form(x, seen.normal, s, floor.normal) for s, w in lit)
    return scene.power * floor.albedo * seen.albedo / pi**2 * total


def blocked_camera(scene, pixel, spot, bounces, n):
    wall, lit, edge = (scene.surface[k] for k in ("wall", ["patch", "patch above"][spot], "edge"))
    s = lit.above(*scene.spots[spot])
    (x0, x1), (y0, y1) = scene.box(pixel)
    c, far = scene.camera, edge.at(1, 1)
    k = c[2] / (c[2] - edge.corner[2])
    low, high = ([o + k * (q - o) for q, o in zip(p, c)] for p in (edge.corner, far))
    whole = scene.footprint(pixel, wall, 3 * n)
    dark = scene.rectangle([max(x0, low[0]), min(x1, high[0])], [max(y0, low[1]), min(y1, high[1])], wall, 3 * n)
    sums = [sum(e * form(x, wall.normal, s, lit.normal) for x, e in part) for part in (whole, dark)]
    return scene.power * wall.albedo * lit.albedo / pi**2 * (sums[0] - sums[1])


def spot_in_view(scene, pixel, spot, bounces, n):
    wall, r, c = scene.surface["wall"], scene.radius, scene.camera
    (cx, cy), ((x0, x1), (y0, y1)) = scene.spots[spot], scene.box(pixel)
    low, high = (max(mpf(-1), min(mpf(1), (x - cx) / r)) for x in (x0, x1))
    cuts = []
    for y in (y0, y1):
        if abs(y - cy) < r:
            phi = acos(abs(y - cy) / r)
            cuts += [phi, -phi]
    total = mpf(0)
    for phi, w in line(pieces(asin(low), asin(high), *cuts), 2 * n):
        half = r * cos(phi)
        bottom, top = max(-half, y0 - cy), min(half, y1 - cy)
        for eta, v in line([bottom, top], 2 * n):
            d2 = (c[0] - cx - r * sin(phi)) ** 2 + (c[1] - cy - eta) ** 2 + c[2] ** 2
            total += w * v * half * scene.aperture * c[2] ** 2 / d2**2
    return scene.power / (pi * r * r) * wall.albedo / pi * total


def two_faces(scene, pixel, spot, bounces, n):
    if bounces in (1, 2):
        return mpf(0)
    wall, faces = scene.surface["wall"], [scene.surface["H1"], scene.surface["H2"]]
    s, fp = wall.above(*scene.spots[spot]), list(scene.footprint(pixel, wall, max(4, n // 2)))
    lit, seen = [], []
    for f in faces:
        points = patch(f, n)
        lit.append([(y, w * f.albedo / pi * form(y, f.normal, s, wall.normal)) for y, w in points])
        seen.append([w * f.albedo / pi * sum(e * form(x, wall.normal, y, f.normal) for x, e in fp) for y, w in points])
    scale = scene.power * (mpf(wall.albedo) / pi) ** 2
    areas = [[w for _, w in patch(f, n)] for f in faces]
    three = sum(
        sum(a * l / w for a, (_, l), w in zip(seen[i], lit[i], areas[i])) / (f.albedo / pi) for i, f in enumerate(faces)
    )
    four = mpf(0)
    for (y1, l1), a1 in zip(lit[0], seen[0]):
        for (y2, l2), a2 in zip(lit[1], seen[1]):
            four += form(y1, faces[0].normal, y2, faces[1].normal) * (a1 * l2 + a2 * l1)
    return scale * (three * (bounces != 4) + four * (bounces != 3))


CHECKS = [mpf(k) / 2 for k in range(-2, 3)]
# Name: recipe, order of the rule.
RECIPES = {
    "furnace-dark": (furnace, 1),
    "furnace-grey": (furnace, 1),
    "furnace-bright": (furnace, 1),
    "parallel-squares": (direct("lower", "upper"), 9),
    "perpendicular-squares": (direct("lit", "seen"), 12),
    "inverse-square": (direct(["patch at 1 m", "patch at 2 m", "patch at 4 m"], "wall"), 4),
    "cosine-falls": (
        direct(["near the zenith", "at 53 degrees", "at 74 degrees", "tilted to 0.6", "tilted to 0.28"], "wall"),
        4,
    ),
    "image-plane": (image_plane, 14),
    "aperture": (aperture, 12),
    "overlap": (overlap, 12),
    "grazing": (hidden_face(cuts_a=("0.25", "0.5"), cuts_b=("0.35", "0.55", "0.7", "0.85"), fp_cuts=((), ("0",))), 12),
    "hinge": (
        hidden_face(
            cuts_a=("0.025", "0.05", "0.1", "0.15", "0.25", "0.5"),
            cuts_b=("0.25", "0.35", "0.42", "0.47", "0.5", "0.54", "0.58", "0.65", "0.75", "0.87"),
            share=mpf(2) / 3,
        ),
        13,
    ),
    "half-spot": (cut_spot, 16),
    "half-gaussian": (cut_spot, 15),
    "blocked-camera": (blocked_camera, 6),
    "spot-in-view": (spot_in_view, 8),
    "checkerboard-wall": (hidden_face(cuts_a=("0.5",), cuts_b=("0.5",), fp_cuts=(CHECKS, CHECKS)), 12),
    "two-faces": (two_faces, 10),
}


def form_factors():
    """The geometric factor and the rule against the closed form factors of an element and a rectangle (Howell, B-3 and B-5)."""
    n, zero, one = nodes(24), mpf(0), mpf(1)
    a, b, c = mpf("0.7"), mpf("1.1"), mpf("0.9")
    up = [zero, zero, one]
    # Parallel rectangle a × b at distance c, its corner above the element.
    x, y = a / c, b / c
    p, q = sqrt(1 + x * x), sqrt(1 + y * y)
    truth = (x / p * atan(y / p) + y / q * atan(x / q)) / (2 * pi)
    found = sum(u * v * a * b * form([zero] * 3, up, [a * s, b * t, c], [zero, zero, -one]) for s, u in n for t, v in n) / pi
    assert abs(found / truth - 1) < mpf(10) ** -12, found / truth - 1
    # Perpendicular rectangle, a high and b wide, standing at distance c with a corner at the element's level.
    x, y = a / b, c / b
    truth = (atan(1 / y) - y / sqrt(x * x + y * y) * atan(1 / sqrt(x * x + y * y))) / (2 * pi)
    found = sum(u * v * a * b * form([zero] * 3, up, [c, b * t, a * s], [-one, zero, zero]) for s, u in n for t, v in n) / pi
    assert abs(found / truth - 1) < mpf(10) ** -12, found / truth - 1


def main():
    write = "--write" in sys.argv
    wanted = [a for a in sys.argv[1:] if not a.startswith("-")]
    form_factors()
    paths = sorted(FOLDER.glob("*.toml"))
    assert {p.stem for p in paths} == set(RECIPES), "every scene needs a recipe, every recipe a scene"
    wrong = 0
    for path in paths:
        if wanted and path.stem not in wanted:
            continue
        scene = Scene(path)
        recipe, n = RECIPES[path.stem]
        lines = scene.text.splitlines()
        places = [i for i, text in enumerate(lines) if text.startswith("flux = ")]
        assert len(places) == len(scene.known)
        for known, place in zip(scene.known, places):
            at = (known["pixel"], known["spot"], known.get("bounces"))
            coarse, fine = recipe(scene, *at, n), recipe(scene, *at, n + n // 4 + 1)
            change = abs(coarse / fine - 1) if fine else mpf(0)
            off = abs(mpf(known["flux"]) / fine - 1) if fine else mpf(known["flux"])
            right = change < mpf(10) ** -11 and (write or off < mpf(10) ** -11)
            wrong += not right
            text = mp.nstr(fine, 17, min_fixed=0, max_fixed=0) if fine else "0.0"
            lines[place] = f"flux = {text}"
            print(f"{path.stem}: {at}: {text}  rule {mp.nstr(change, 2)}  file {mp.nstr(off, 2)}{'' if right else '   WRONG'}")
        if write:
            path.write_text("\n".join(lines).rstrip() + "\n")
    sys.exit(f"{wrong} values are wrong" if wrong else 0)


main()
