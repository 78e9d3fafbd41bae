# ---- Placement: Mitsuba's f32 coordinates are (p - ORIGIN) * SCALE, the scene then measures about 1000 ----------------------

ORIGIN = np.array(VIEW["corner"]) + 0.5 * (np.array(VIEW["u"]) + np.array(VIEW["v"]))


@functools.cache
def mesh(number):
    """Positions, triangles and, by triangle and corner, texture coordinates (or None) of one of MESHES, in its own space."""
    m = MESHES[number]
    read = lambda key, kind, *shape: np.frombuffer(base64.b64decode(m[key]), kind).reshape(shape)
    uv = read("uv", "<f4", -1, 3, 2) if "uv" in m else None
    return read("positions", "<f8", -1, 3), read("triangles", "<u4", -1, 3), uv


def placed(s):
    """The vertices of a mesh in the scene."""
    return mesh(s["mesh"])[0] @ np.array(s["axes"]) + np.array(s["translation"])


def _reach(s):
    if s["shape"] in ("sphere", "disc"):
        return np.linalg.norm(np.array(s["centre"]) - ORIGIN) + s["radius"]
    if s["shape"] == "mesh":
        return np.linalg.norm(placed(s) - ORIGIN, axis=1).max()
    c, u, v = (np.array(s[k]) for k in ("corner", "u", "v"))
    return max(np.linalg.norm(p - ORIGIN) for p in (c, c + u, c + v, c + u + v))


SCALE = 1000.0 / max(_reach(s) for s in SURFACES)
POINT_RADIUS = 0.1  # of the disk that stands for an ideal spot, in Mitsuba's coordinates
LIFT = 5e-3  # of the emitter above its surface, in Mitsuba's coordinates


def place(p):
    return (np.array(p) - ORIGIN) * SCALE


def affine(x, y, z, origin):
    """The transform with the given columns."""
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = x, y, z, origin
    return mi.ScalarTransform4f(m)


def tangents(n):
    """Two unit vectors that make a right-handed basis with `n`."""
    side = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    side /= np.linalg.norm(side)
    return side, np.cross(n, side)


# ---- Textures -----------------------------------------------------------------------------------------------------------


def bitmap(values, lookup="nearest", to_uv=None, wrap="clamp"):
    """Texel [j][i] covers u in [i, i + 1] / nu, v in [j, j + 1] / nv: Mitsuba's row 0 lies at v = 0, as ours does."""
    texture = {
        "type": "bitmap",
        "bitmap": mi.Bitmap(np.ascontiguousarray(values, dtype=np.float32)[:, :, None]),
        "raw": True,
        "filter_type": lookup,
        "wrap_mode": wrap,
    }
    if to_uv is not None:
        texture["to_uv"] = to_uv
    return texture


def checkerboard(nu, nv, dark, light):
    """Cell (0, 0), at the corner, is dark."""
    return np.where(np.add.outer(np.arange(nv), np.arange(nu)) % 2 == 0, dark, light)


def uniform(value):
    return {"type": "uniform", "value": float(value)}


def albedo_at(kind, value, u, v):
    """What phicam's texture is at parameters in [0, 1]."""
    if kind == "ramp":
        return value[0] + (value[1] - value[0]) * u
    wrap, texels = value if kind == "bilinear" else (None, value)
    texels = np.array(texels)
    nv, nu = texels.shape
    if wrap is None:
        return texels[np.minimum((v * nv).astype(int), nv - 1), np.minimum((u * nu).astype(int), nu - 1)]

    def neighbours(x, n):
        left = np.floor(x * n - 0.5).astype(int)
        inside = (lambda i: i % n) if wrap == "repeat" else (lambda i: np.clip(i, 0, n - 1))
        return inside(left), inside(left + 1), x * n - 0.5 - left

    (i, i1, s), (j, j1, t) = neighbours(u, nu), neighbours(v, nv)
    return (texels[j, i] * (1 - s) + texels[j, i1] * s) * (1 - t) + (texels[j1, i] * (1 - s) + texels[j1, i1] * s) * t


def square_of_disc(x, y):
    """The point of the unit square that Shirley and Chiu's map takes to (x, y) in the unit disc: phicam's parameters."""
    r, quarter = np.hypot(x, y), np.mod(np.arctan2(y, x) + np.pi / 4, 2 * np.pi) / (np.pi / 4) - 1
    a = np.select([quarter < 1, quarter < 3, quarter < 5], [r, (2 - quarter) * r, -r], (quarter - 6) * r)
    b = np.select([quarter < 1, quarter < 3, quarter < 5], [quarter * r, r, (4 - quarter) * r], -r)
    return 0.5 * (a + 1), 0.5 * (b + 1)


def texture(s, change=lambda rho: rho):
    """The albedo of a surface, or `change` of it, in the parameters of Mitsuba's shape."""
    kind, value = s["albedo"]
    if kind == "constant":
        return uniform(change(value))
    if kind == "checkerboard":
        kind, value = "cells", checkerboard(*value)
    changed = lambda values: change(np.array(values, dtype=float))
    if s["shape"] == "disc":
        # Mitsuba's u is the radius and its v phi / 2 pi, counted from its first axis: the first of `tangents`.
        r, phi = (np.arange(2048) + 0.5) / 2048, 2 * np.pi * (np.arange(2048) + 0.5)[:, None] / 2048
        x, y = r * np.cos(phi), r * np.sin(phi)
        across, up = tangents(np.array(s["normal"]))
        ours = [x * (across @ np.array(s[k])) + y * (up @ np.array(s[k])) for k in ("s", "t")]
        return bitmap(changed(albedo_at(kind, value, *square_of_disc(*ours))))
    if s["shape"] == "sphere":
        # phicam's u is (1 - cos theta) / 2 and its v phi / 2 pi; Mitsuba's u is phi / 2 pi and its v theta / pi.
        u = 0.5 - 0.5 * np.cos(np.pi * (np.arange(4096) + 0.5) / 4096)
        if kind == "ramp":
            return bitmap(changed(albedo_at(kind, value, u, u))[:, None].repeat(2, axis=1), "bilinear")
        wrap, texels = value if kind == "bilinear" else ("clamp", value)
        # The row through the centres of each row of texels: Mitsuba interpolates between these.
        middles = (np.arange(len(texels)) + 0.5) / len(texels)
        return bitmap(changed(albedo_at(kind, value, u[:, None], middles[None, :])), "bilinear" if kind == "bilinear" else "nearest", wrap=wrap)
    if kind == "ramp":
        # Two texels with centres at 1/4 and 3/4: u in [0, 1] is mapped to what lies between them.
        between = mi.ScalarTransform4f().translate([0.25, 0, 0]).scale([0.5, 1, 1])
        return bitmap(changed([value, value]), "bilinear", between)
    if kind == "bilinear":
        return bitmap(changed(value[1]), "bilinear", wrap=value[0])
    return bitmap(changed(value), wrap="repeat" if kind == "tiles" else "clamp")


# ---- Surfaces -----------------------------------------------------------------------------------------------------------


def triangles(s):
    """A mesh: with texture coordinates every triangle has its own three corners."""
    positions, corners, uv = mesh(s["mesh"])
    positions = place(placed(s))
    if s["face"] == "inner":
        corners, uv = corners[:, ::-1], None if uv is None else uv[:, ::-1]
    back = SURFACES[s["back"]] if "back" in s else s
    textured = s["albedo"][0] != "constant" or back["albedo"][0] != "constant"
    if textured:
        # Without coordinates of its own phicam takes (0, 0) everywhere.
        uv = np.zeros((len(corners), 3, 2), dtype=np.float32) if uv is None else uv
        positions, corners = positions[corners].reshape(-1, 3), np.arange(3 * len(corners))
    material = bsdf(s)
    if "back" in s:
        material = {"type": "twosided", "front": material, "back": bsdf(back)}
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(material)
    shape = mi.Mesh(s["name"], len(positions), corners.size // 3, props=props, has_vertex_texcoords=textured)
    data = mi.traverse(shape)
    given = {"vertex_positions": positions.astype(np.float32), "faces": corners.astype(np.uint32)}
    if textured:
        given["vertex_texcoords"] = uv.astype(np.float32)
    for key, values in given.items():
        data[key] = type(data[key])(values.ravel())  # an array in the scalar variants too
    data.update()
    return shape


def surface(s):
    if s["shape"] == "mesh":
        return triangles(s)
    if s["shape"] == "sphere":
        return {
            "type": "sphere",
            "center": place(s["centre"]).tolist(),
            "radius": s["radius"] * SCALE,
            "flip_normals": s["face"] == "inside",
            "bsdf": bsdf(s),
        }
    n = np.array(s["normal"])
    lift = 0.5 * LIFT * n if s["panel"] else 0.0
    if s["shape"] == "disc":
        across, up = (side * s["radius"] * SCALE for side in tangents(n))
        return {"type": "disk", "to_world": affine(across, up, n, place(s["centre"]) + lift), "bsdf": bsdf(s)}
    u, v = np.array(s["u"]) * SCALE, np.array(s["v"]) * SCALE
    # Mitsuba's rectangle is [-1, 1]^2 in the plane z = 0.
    return {"type": "rectangle", "to_world": affine(u / 2, v / 2, n, place(s["corner"]) + (u + v) / 2 + lift), "bsdf": bsdf(s)}


