# ---- Laser spots --------------------------------------------------------------------------------------------------------


def emitter(lit, power):
    """What the beam lights: a Lambertian emitter of radiance albedo * irradiance / pi."""
    kind, centre, normal, albedo, size = lit
    n = np.array(normal)
    across, up = tangents(n)
    radius = {"point": POINT_RADIUS, "disc": size * SCALE, "gaussian": 3 * size * SCALE}[kind]
    shape = {
        "to_world": affine(across * radius, up * radius, n, place(centre) + LIFT * n),
        "bsdf": {"type": "diffuse", "reflectance": uniform(albedo)},
    }
    if kind == "gaussian":
        # Irradiance ~ exp(-2 r^2 / w^2) over a square of half-side 3 w.
        x = 3 * ((np.arange(256) + 0.5) / 128 - 1)
        profile = np.exp(-2 * (x[:, None] ** 2 + x[None, :] ** 2))
        area = (2 * radius) ** 2
        radiance = bitmap(power * albedo / np.pi / area * profile / profile.mean(), "bilinear")
        shape["type"] = "rectangle"
    else:
        share = size if kind == "point" else 1.0
        radiance = uniform(share * power * albedo / np.pi / (np.pi * radius**2))
        shape["type"] = "disk"
    shape["emitter"] = {"type": "area", "radiance": radiance}
    return shape


def glossy_point(lit):
    """Position, normal, unit vector to the laser and parameters in Mitsuba's shape of a point on a surface that is not
    Lambertian."""
    _, position, normal, _, number, (u, v) = lit
    s, p = SURFACES[number], np.array(position)
    if s["shape"] == "sphere":
        u, v = v, np.arccos(1 - 2 * u) / np.pi
    elif s["shape"] == "disc":
        x, y = ((p - np.array(s["centre"])) @ side / s["radius"] for side in tangents(np.array(s["normal"])))
        u, v = np.hypot(x, y), np.arctan2(y, x) / (2 * np.pi) % 1
    laser = np.array(LASER) - p
    return place(p), np.array(normal), laser / np.linalg.norm(laser), (u, v)


def scene(spot):
    """The Mitsuba dictionary of the scene while the laser lights `spot`."""
    d = {"type": "scene"}
    d.update({f"surface{i}": surface(s) for i, s in enumerate(SURFACES) if "back_of" not in s})
    glossy = [lit for lit in SPOTS[spot] if lit[0] == "glossy"]
    d.update({f"lit{i}": emitter(lit, POWER) for i, lit in enumerate(SPOTS[spot]) if lit not in glossy})
    for number in sorted({lit[4] for lit in glossy}):
        points = [lit for lit in glossy if lit[4] == number]
        power = POWER * sum(lit[3] for lit in points)
        d[f"glossy{number}"] = in_python()(bsdf(SURFACES[number]), power, [glossy_point(lit) for lit in points])
    return d


def intensity(lit, w):
    """What an ideal spot sends along the unit vector `w`, W/sr."""
    if lit[0] == "point":
        _, _, normal, albedo, share = lit
        return POWER * share * albedo / np.pi * max(0.0, w @ np.array(normal))
    _, normal, laser, uv = glossy_point(lit)
    frame = np.stack([*tangents(normal), normal])
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi, si.uv = mi.Vector3f((frame @ laser).tolist()), mi.Point2f(list(uv))
    f = mi.load_dict(bsdf(SURFACES[lit[4]])).eval(mi.BSDFContext(), si, mi.Vector3f((frame @ w).tolist()))[0]
    return POWER * lit[3] * float(np.array(f).ravel()[0])


def direct(world, spot):
    """Flux of the ideal spots themselves into the pixels that see them: camera samples would hardly ever meet them."""
    flux = np.zeros(COLUMNS * ROWS)
    eye, axis = np.array(PINHOLE), np.array(VIEW["normal"])
    corner, u, v = (np.array(VIEW[k]) for k in ("corner", "u", "v"))
    for lit in SPOTS[spot]:
        if lit[0] not in ("point", "glossy"):
            continue
        point, normal = np.array(lit[1]), np.array(lit[2])
        distance = np.linalg.norm(point - eye)
        w = (point - eye) / distance
        cos_lens = -w @ axis
        if w @ normal >= 0 or cos_lens <= 0:
            continue
        foot = eye + w * (axis @ (corner - eye)) / (axis @ w) - corner
        # Coordinates along u and v, which need not be perpendicular.
        (a, b), *_ = np.linalg.lstsq(np.stack([u, v], axis=1), foot, rcond=None)
        if not (0 <= a < 1 and 0 <= b < 1):
            continue
        o, e = place(eye), place(point)
        ray = mi.Ray3f(mi.Point3f(o.tolist()), mi.Vector3f(w.tolist()))
        ray.maxt = mi.Float(float(np.linalg.norm(e - o) * (1 - 1e-4)))
        if np.any(np.array(world.ray_test(ray))):
            continue
        pixel = min(int(a * COLUMNS), COLUMNS - 1) + min(int(b * ROWS), ROWS - 1) * COLUMNS
        flux[pixel] += intensity(lit, -w) * APERTURE_AREA * cos_lens / distance**2
    return flux


