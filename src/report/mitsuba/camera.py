# ---- Camera -------------------------------------------------------------------------------------------------------------


def sample(world, integrator, sampler, pixel):
    """Flux samples (W) of `pixel`: an integer, or an array of them in the vectorised variants."""
    vector = lambda x: mi.Vector3f(np.asarray(x).tolist())
    eye, normal = vector(place(PINHOLE)), vector(VIEW["normal"])
    corner, u, v = vector(place(VIEW["corner"])), vector(np.array(VIEW["u"]) * SCALE), vector(np.array(VIEW["v"]) * SCALE)
    jitter = sampler.next_2d()
    a = (mi.Float(pixel % COLUMNS) + jitter.x) / COLUMNS
    b = (mi.Float(pixel // COLUMNS) + jitter.y) / ROWS
    line = corner + u * a + v * b - eye
    distance2 = dr.dot(line, line)
    w = line * dr.rsqrt(distance2)
    cos = dr.dot(w, normal)
    ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(eye), w))
    radiance = integrator.sample(world, sampler, ray)[0]
    footprint = np.linalg.norm(np.cross(VIEW["u"], VIEW["v"])) * SCALE**2 / (COLUMNS * ROWS)
    return radiance[0] * (cos * cos / distance2) * (footprint * APERTURE_AREA * SCALE**2)


def render(spot, spp, seed, max_bounces):
    """Column `spot` of the matrix and its standard error."""
    pixels = COLUMNS * ROWS
    total, squares = np.zeros(pixels), np.zeros(pixels)
    if not SPOTS[spot]:  # the beam lights nothing
        return total, squares
    world = mi.load_dict(scene(spot))
    ideal = SPOTS[spot][0][0] in ("point", "glossy")
    integrator = mi.load_dict(
        {"type": "path", "max_depth": max_bounces, "rr_depth": 1_000_000, "hide_emitters": ideal}
    )
    jit = not mi.variant().startswith("scalar")
    step = max(1, 2**20 // pixels) if jit else spp
    done = 0
    while done < spp:
        n = min(step, spp - done)
        seed32 = int(np.random.SeedSequence([seed, spot, done]).generate_state(1)[0])
        sampler = mi.load_dict({"type": "independent", "sample_count": 1})
        if jit:
            sampler.seed(seed32, pixels * n)
            x = sample(world, integrator, sampler, dr.arange(mi.UInt32, pixels * n) // n)
            x = np.array(x, dtype=np.float64).reshape(pixels, n)
        else:
            sampler.seed(seed32)
            x = np.array([[sample(world, integrator, sampler, p) for _ in range(n)] for p in range(pixels)])
        total += x.sum(axis=1)
        squares += (x * x).sum(axis=1)
        done += n
    mean = total / spp
    variance = np.maximum(squares / spp - mean * mean, 0.0) * spp / (spp - 1)
    return mean + (direct(world, spot) if ideal else 0.0), np.sqrt(variance / spp)


# ---- Command line -------------------------------------------------------------------------------------------------------


def choose(spot):
    """llvm_ad_rgb where it works, else scalar_rgb, which is some hundred times slower.

    Dr.Jit finds the LLVM library by itself (or in DRJIT_LIBLLVM_PATH), but aborts the process where that is too old for
    it: so the attempt is made in a process of its own.
    """
    with tempfile.TemporaryDirectory() as folder:
        trial = ["--variant", "llvm_ad_rgb", "--spp", "2", "--spots", f"{spot}..{spot + 1}", "-o", f"{folder}/phi.npy"]
        if subprocess.run([sys.executable, __file__, *trial], capture_output=True).returncode == 0:
            return "llvm_ad_rgb"
    print("llvm_ad_rgb does not work here (is LLVM installed and recent?): using scalar_rgb, slow", file=sys.stderr)
    return "scalar_rgb"


def main():
    def spot_range(text):
        a, dots, b = text.partition("..")
        if not (dots and a.isdecimal() and b.isdecimal() and int(a) < int(b) <= len(SPOTS)):
            raise argparse.ArgumentTypeError(f"write A..B with A < B <= {len(SPOTS)}, the number of spots")
        return range(int(a), int(b))

    def at_least(least):
        def number(text):
            if not text.isdecimal() or int(text) < least:
                raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} on")
            return int(text)

        return number

    parser = argparse.ArgumentParser(description=f"Flux matrix of the phicam scene {NAME!r} by Mitsuba 3".replace("%", "%%"))
    parser.add_argument("-o", "--output", type=Path, default=Path("phi.npy"), help="pixels x spots, W")
    parser.add_argument("--spots", type=spot_range, default=range(len(SPOTS)), metavar="A..B", help="only spots A to B - 1")
    parser.add_argument("--spp", type=at_least(2), default=4096, help="samples per pixel and spot (4096)")
    parser.add_argument("--seed", type=at_least(0), default=1)
    parser.add_argument("--max-bounces", type=at_least(1), default=MAX_BOUNCES, help=f"surfaces met ({MAX_BOUNCES})")
    parser.add_argument("--variant", help="Mitsuba variant: llvm_ad_rgb (default where it works), scalar_rgb, cuda_ad_rgb")
    args = parser.parse_args()
    try:
        mi.set_variant(args.variant or choose(args.spots[0]))
    except (ImportError, ValueError) as e:
        sys.exit(f"{args.variant}: {e}")
    for name, difference in differences().items():
        print(f"surface {name!r}: Mitsuba's BRDF within {difference:.1e} of phicam's (relative, at its tabulated angles)", file=sys.stderr)
    columns = []
    for spot in args.spots:
        if sys.stderr.isatty():
            print(f"\rspot {spot} ({len(columns) + 1} of {len(args.spots)}) ", end="", file=sys.stderr, flush=True)
        columns.append(render(spot, args.spp, args.seed, args.max_bounces))
    print(f"Mitsuba {mi.__version__}, {mi.variant()}: {len(columns)} spots done", file=sys.stderr)
    phi, stderr = (np.ascontiguousarray(np.stack(c, axis=1)) for c in zip(*columns))
    np.save(args.output.with_suffix(".npy"), phi)
    np.save(args.output.with_suffix(".stderr.npy"), stderr)


if __name__ == "__main__":
    main()
