# ---- Materials ----------------------------------------------------------------------------------------------------------


def bsdf(s):
    """The BSDF of a surface's front."""
    return of_material(s["material"], lambda change=lambda rho: rho: texture(s, change))


def of_material(material, albedo):
    """`albedo(change)` is the texture, each value changed."""
    kind, *given = material
    if kind == "lambertian":
        return {"type": "diffuse", "reflectance": albedo()}
    if kind == "oren_nayar":
        in_python()
        return {"type": "phicam_oren_nayar", "r": given[0], "reflectance": albedo()}
    if kind == "conductor":
        alpha, eta, k = given
        return {
            "type": "roughconductor",
            "distribution": "ggx",
            "alpha": alpha,
            "eta": uniform(eta),
            "k": uniform(k),
            "specular_reflectance": albedo(),
        }
    if kind == "paint":
        in_python()
        alpha, eta = given
        return {"type": "phicam_paint", "eta": eta, "coat": plastic(alpha, eta, uniform(0)), "reflectance": albedo()}
    if kind == "coated":
        alpha, eta, internal = given
        theirs = internal_reflectance(alpha, eta)

        def ground(rho):
            light = rho / (1 - rho * internal)
            return light / (1 + light * theirs)

        return plastic(alpha, eta, albedo(ground))
    # A mixture: what its weights leave of 1 is black.
    parts = given[0]
    mixed, total = {"type": "diffuse", "reflectance": uniform(0)}, max(0.0, 1 - sum(p[0] for p in parts))
    for weight, rho, part in parts:
        total += weight
        constant = lambda change=lambda rho: rho, rho=rho: uniform(change(rho))
        share = weight / total if total > 0 else 0.0
        mixed = {"type": "blendbsdf", "weight": share, "before": mixed, "part": of_material(part, constant)}
    return mixed


def plastic(alpha, eta, reflectance):
    return {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": alpha,
        "int_ior": eta,
        "ext_ior": 1.0,
        "nonlinear": True,
        "diffuse_reflectance": reflectance,
    }


def direction(theta, phi):
    return mi.Vector3f([float(x) for x in (np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))])


def evaluated(material, theta_i, theta_o, phi):
    """f_r of a BSDF's dictionary, 1/sr: without the cosine that Mitsuba multiplies in."""
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = direction(theta_i, 0.0)
    value = mi.load_dict(material).eval(mi.BSDFContext(), si, direction(theta_o, phi))[0]
    return float(np.array(value).ravel()[0]) / np.cos(theta_o)


@functools.cache
def internal_reflectance(alpha, eta):
    """Mitsuba's F': f_r = coat + K rho / (1 - rho F'), so that the ground's light at rho = 1 over that at rho = 1/2 is
    (2 - F') / (1 - F')."""
    black, grey, white = (evaluated(plastic(alpha, eta, uniform(rho)), 0.9, 0.2, 1.57) for rho in (0, 0.5, 1))
    ratio = (white - black) / (grey - black)
    return (ratio - 2) / (ratio - 1)


def differences():
    """Largest relative difference of Mitsuba's BRDFs from the values of phicam's, by name of the surface."""
    found = {}
    for s in SURFACES:
        for rho, *angles, value in s.get("brdf", []):
            theirs = evaluated(of_material(s["material"], lambda change=lambda rho: rho: uniform(change(rho))), *angles)
            found[s["name"]] = max(found.get(s["name"], 0.0), abs(theirs / value - 1))
    return found


@functools.cache
def in_python():
    """The BSDFs, registered, and the emitter that Mitsuba lacks, which is returned; the scalar variants cannot run such."""
    if mi.variant().startswith("scalar"):
        cure = "use --variant llvm_ad_rgb, for which LLVM must be installed"
        raise SystemExit(f"{mi.variant()} cannot run this scene, part of which is in Python: {cure}")
    zero = lambda x, active: dr.select(active, x, 0)

    class OrenNayar(mi.BSDF):
        """EON (Portsmouth, Kutz and Hill 2025), a rough matt surface; sampled by the cosine."""

        C1, C2 = 0.5 - 2 / (3 * np.pi), 2 / 3 - 28 / (15 * np.pi)

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.reflectance, self.r = props["reflectance"], props["r"]
            self.m_flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide
            self.m_components = [self.m_flags]

        def lost(self, mu):
            """1 - E(mu), the part of the light that a single scattering does not give back."""
            s = dr.safe_sqrt(1 - mu * mu)
            g = s * (dr.safe_acos(mu) - s * mu) + 2 / 3 * (s * mu * (1 + s + s * s) / (1 + s) - s)
            return self.r / (1 + self.C1 * self.r) * (self.C1 - g / np.pi)

        def eval(self, ctx, si, wo, active=True):
            active = active & (si.wi.z > 0) & (wo.z > 0)
            rho, wi = self.reflectance.eval(si, active), si.wi
            a = 1 / (1 + self.C1 * self.r)
            mean = a * (1 + self.C2 * self.r)
            s = wi.x * wo.x + wi.y * wo.y
            single = rho * a * (1 + self.r * dr.select(s > 0, s / dr.maximum(wi.z, wo.z), s))
            multiple = rho * rho * mean / (1 - rho * (1 - mean)) / (1 - mean) if self.r > 0 else 0
            return zero((single + multiple * self.lost(wi.z) * self.lost(wo.z)) / np.pi * wo.z, active)

        def pdf(self, ctx, si, wo, active=True):
            return zero(mi.warp.square_to_cosine_hemisphere_pdf(wo), active & (si.wi.z > 0) & (wo.z > 0))

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def sample(self, ctx, si, sample1, sample2, active=True):
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo = mi.warp.square_to_cosine_hemisphere(sample2)
            bs.pdf, bs.eta = self.pdf(ctx, si, bs.wo, active), 1
            bs.sampled_type, bs.sampled_component = mi.UInt32(+mi.BSDFFlags.DiffuseReflection), mi.UInt32(0)
            return bs, zero(self.eval(ctx, si, bs.wo, active) / bs.pdf, active & (bs.pdf > 0))

        def to_string(self):
            return f"OrenNayar[r = {self.r}]"

    class Paint(mi.BSDF):
        """A `roughplastic` over black, above a ground that gets all light that this coat does not reflect. Its reflectance
        E is measured here, by its own sampling; sampled by the coat and by the cosine, as often."""

        NODES, SIDE = 256, 200

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.reflectance, self.coat, self.eta = props["reflectance"], props["coat"], props["eta"]
            glossy, diffuse = mi.BSDFFlags.GlossyReflection, mi.BSDFFlags.DiffuseReflection
            self.m_components = [glossy | mi.BSDFFlags.FrontSide, diffuse | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0] | self.m_components[1]
            x = np.arange(self.NODES + 1) / self.NODES
            through = 1 - self.reflected(np.maximum(x * x, 1e-4))
            # 2 int mu T dmu over x = sqrt(mu), by trapezoids.
            integrand = 4 * x**3 * through
            self.internal = 1 - float(np.mean(integrand[1:] + integrand[:-1]) / 2) / self.eta**2
            self.through = mi.Float(through.astype(np.float32))

        def reflected(self, mu):
            """E(mu): the means of what the coat's samples weigh."""
            middles = (np.arange(self.SIDE) + 0.5) / self.SIDE
            mu, u, v = (mi.Float(g.ravel().astype(np.float32)) for g in np.meshgrid(mu, middles, middles, indexing="ij"))
            si = dr.zeros(mi.SurfaceInteraction3f, len(mu))
            si.wi = mi.Vector3f(dr.safe_sqrt(1 - mu * mu), 0, mu)
            weights = np.array(self.coat.sample(mi.BSDFContext(), si, 0.0, mi.Point2f(u, v))[1][0], dtype=np.float64)
            return weights.reshape(-1, self.SIDE**2).mean(axis=1)

        def transmittance(self, mu):
            x = dr.safe_sqrt(mu) * self.NODES
            k = dr.minimum(mi.UInt32(x), self.NODES - 1)
            low, high = dr.gather(mi.Float, self.through, k), dr.gather(mi.Float, self.through, k + 1)
            return low + (x - mi.Float(k)) * (high - low)

        def eval(self, ctx, si, wo, active=True):
            active = active & (si.wi.z > 0) & (wo.z > 0)
            rho = self.reflectance.eval(si, active)
            ground = rho / (1 - rho * self.internal) / (np.pi * self.eta**2)
            through = self.transmittance(si.wi.z) * self.transmittance(wo.z)
            return zero(self.coat.eval(ctx, si, wo, active) + ground * through * wo.z, active)

        def pdf(self, ctx, si, wo, active=True):
            active = active & (si.wi.z > 0) & (wo.z > 0)
            both = self.coat.pdf(ctx, si, wo, active) + mi.warp.square_to_cosine_hemisphere_pdf(wo)
            return zero(0.5 * both, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def sample(self, ctx, si, sample1, sample2, active=True):
            is_coat = sample1 < 0.5
            glossy = self.coat.sample(ctx, si, 0.0, sample2, active & is_coat)[0].wo
            bs = dr.zeros(mi.BSDFSample3f)
            bs.wo = dr.select(is_coat, glossy, mi.warp.square_to_cosine_hemisphere(sample2))
            bs.pdf, bs.eta = self.pdf(ctx, si, bs.wo, active), 1
            bs.sampled_type, bs.sampled_component = mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(0)
            return bs, zero(self.eval(ctx, si, bs.wo, active) / bs.pdf, active & (bs.pdf > 0))

        def to_string(self):
            return f"Paint[eta = {self.eta}]"

    class Points(mi.Emitter):
        """Points of one surface that the beam lights: intensity power * f_r(to the laser, w) * cos(w) over their number. They
        have equal shares of the power: each is chosen as often."""

        def __init__(self, material, power, points):
            mi.Emitter.__init__(self, mi.Properties())
            self.m_flags = mi.EmitterFlags.DeltaPosition
            self.bsdf, self.power, self.count = mi.load_dict(material), power, len(points)
            columns = lambda rows: [mi.Float(np.array(c, dtype=np.float32)) for c in zip(*rows)]
            at, normal, laser, uv = zip(*points)
            self.at, self.normal = mi.Point3f(*columns(at)), mi.Normal3f(*columns(normal))
            self.laser, self.uv = mi.Vector3f(*columns(laser)), mi.Point2f(*columns(uv))

        def sample_direction(self, it, sample, active=True):
            k = dr.minimum(mi.UInt32(sample.x * self.count), self.count - 1)
            ds = dr.zeros(mi.DirectionSample3f)
            ds.p, ds.n = dr.gather(mi.Point3f, self.at, k, active), dr.gather(mi.Normal3f, self.normal, k, active)
            ds.time, ds.pdf, ds.delta, ds.emitter = it.time, 1, True, mi.EmitterPtr(self)
            line = ds.p - it.p
            ds.dist = dr.norm(line)
            ds.d = line / ds.dist
            si = dr.zeros(mi.SurfaceInteraction3f)
            si.uv = dr.gather(mi.Point2f, self.uv, k, active)
            si.sh_frame = mi.Frame3f(ds.n)
            si.wi = si.sh_frame.to_local(dr.gather(mi.Vector3f, self.laser, k, active))
            f = self.bsdf.eval(mi.BSDFContext(), si, si.sh_frame.to_local(-ds.d), active)
            return ds, zero(self.power * f / (ds.dist * ds.dist), active)

        def pdf_direction(self, it, ds, active=True):
            return mi.Float(0)

        def eval_direction(self, it, ds, active=True):
            return mi.Spectrum(0)

        def eval(self, si, active=True):
            return mi.Spectrum(0)

        def bbox(self):
            return mi.BoundingBox3f(mi.Point3f(0), mi.Point3f(0))

        def to_string(self):
            return f"Points[{self.count}]"

    mi.register_bsdf("phicam_oren_nayar", OrenNayar)
    mi.register_bsdf("phicam_paint", Paint)
    return Points


