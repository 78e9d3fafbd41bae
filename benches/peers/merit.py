"""ε²T of Φcam: phicam beside Mitsuba 3 and mitransient, in one run, interleaved, on one thread.

usage: python merit.py [--phicam FILE] [--seconds S] [--repeats R] [--variant NAME] [-o FILE]

ε is the relative Frobenius error against converged quadrature, T the CPU time (s): lower is better. As long as ε² falls like 1/T, ε²T is the
same whatever the number of samples; where ε² falls faster, it falls with T. So every line is run at three numbers of samples, each four
times the one before, the largest what fits into S seconds; R times each with seeds of their own, and lines take turns. A rung's ε² is the
mean over the repeats, its T the median; a line counts with its best rung. The table goes to standard output, with -o to
FILE.md and FILE.json too, after every repeat.

T of phicam is that of the whole process less the least that a process costs that traces next to nothing, but writes the same files; T of a peer is
that of rendering alone, without loading the scene and compiling the kernel.

Needs numpy; the lines of the peers need `pip install mitsuba mitransient` and LLVM, and are skipped with a message without.
"""

import argparse
import importlib
import json
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit("skipped: numpy is not installed (pip install numpy)")

sys.dont_write_bytecode = True  # no folder of compiled modules beside the sources

import scenes
from program import Program, Traced

FINEST = 1e-5  # ε at which `factored` is compared
RUNGS = 3


class Line:
    """One row of the table: a way to Φcam, and what it was seen to cost."""

    def __init__(self, who, how, sampler, scene, truth, run, start, least=0.0):
        self.who, self.how, self.sampler, self.scene, self.truth, self.run = who, how, sampler, scene, truth, run
        self.samples, self.rungs = start, {}
        self.least = least  # s; a rung that takes less does not count: its time is lost in what was subtracted

    def name(self):
        return f"{self.who}, {self.how}, {self.sampler}, {self.scene}"

    def calibrate(self, seconds):
        """Warms up (peers compile their kernels) and finds the largest number of samples, in steps of 4, within `seconds`."""
        self.run(self.samples // 4, 0)
        _, before = self.run(self.samples // 4, 0)
        while True:
            _, spent = self.run(self.samples, 0)
            # T is a constant and a slope: from n to 4 n it grows by four times what it grew by from n/4 to n.
            if spent + 4 * max(spent - before, 0.0) > seconds:
                break
            before, self.samples = spent, self.samples * 4
        self.rungs = {self.samples // 4**k: [] for k in reversed(range(RUNGS))}

    def measure(self, samples, seed):
        phi, spent = self.run(samples, seed)
        error = np.linalg.norm(phi - self.truth) / np.linalg.norm(self.truth)
        scale = float((phi * self.truth).sum() / (self.truth**2).sum())
        self.rungs[samples].append((float(error), spent, scale))

    def results(self):
        out = []
        for samples, runs in self.rungs.items():
            error2 = statistics.fmean(e * e for e, _, _ in runs)
            spent = statistics.median(t for _, t, _ in runs)
            out.append({
                "samples": samples, "error": error2**0.5, "seconds": spent, "merit": error2 * spent,
                "scale": statistics.fmean(s for _, _, s in runs), "runs": runs,
            })  # fmt: skip
        return out

    def best(self, finest=None):
        allowed = [r for r in self.results() if r["seconds"] >= self.least and (finest is None or r["error"] <= finest)]
        return min(allowed, key=lambda r: r["merit"], default=None)


def timed(peer):
    """`run` of a peer: CPU time of rendering alone, without loading the scene and compiling the kernel."""

    def run(samples, seed):
        begin = time.process_time()
        phi = peer.render(samples, seed)
        return phi, time.process_time() - begin

    return run


def works(variant):
    """Whether Mitsuba runs in `variant`: Dr.Jit may abort its process where LLVM is missing, so another one tries."""
    trial = f"import mitsuba as mi; mi.set_variant('{variant}'); import drjit as dr; dr.eval(dr.arange(mi.Float, 4) + 1)"
    return subprocess.run([sys.executable, "-c", trial], capture_output=True).returncode == 0


def peers(program, scene, variant, truth):
    """The lines of Mitsuba and mitransient, and their versions."""
    try:
        import drjit as dr
        import mitsuba as mi
    except ImportError:
        print("skipped: Mitsuba is not installed (pip install mitsuba mitransient)", file=sys.stderr)
        return [], {}
    if not works(variant):
        print(f"skipped: Mitsuba does not run as {variant} here (is LLVM installed?)", file=sys.stderr)
        return [], {}
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    dr.set_thread_count(0)  # the main thread does all the work
    program.exported(scene, "exported")
    sys.path.insert(0, str(program.folder))
    exported = importlib.import_module("exported")
    from mitsuba_path import Path as MitsubaPath

    versions, lines = {"mitsuba": mi.__version__}, []
    for sampler in ("independent", "multijitter"):
        path = MitsubaPath(exported, sampler)
        lines.append(Line("Mitsuba path", "one render per spot", sampler, "thesis", truth, timed(path), 64))
    try:
        import mitransient
        from capture import Capture
    except ImportError:
        print("skipped: mitransient is not installed (pip install mitransient)", file=sys.stderr)
        return lines, versions
    versions["mitransient"] = mitransient.__version__
    for how, exhaustive in (("one render per spot", False), ("exhaustive", True)):
        for sampler in ("independent", "multijitter"):
            capture = Capture(exported, sampler, exhaustive)
            lines.append(Line("mitransient", how, sampler, "thesis", truth, timed(capture), 64))
    return lines, versions


def own(program, files, truths):
    fixed = min(program.render(files["thesis"], "factored", "sobol", 32, k)[1] for k in range(9))  # the least favours the peers
    print(f"fixed cost of a process of phicam: {fixed:.3f} s", file=sys.stderr)
    wanted = [("thesis", e, s) for e in ("independent", "shared", "factored") for s in ("pcg", "sobol")]
    wanted += [("turned", "factored", "sobol"), ("disc", "factored", "sobol")]
    lines = []
    for scene, estimator, sampler in wanted:
        run = Traced(program, files[scene], estimator, sampler, fixed).run
        lines.append(Line("phicam", estimator, sampler, scene, truths[scene], run, 512, fixed))
    return lines, fixed


def ratios(lines):
    """Peer's ε²T over phicam's: what is asked, the ratio measured."""

    def of(who, how, sampler=None, scene="thesis", finest=None):
        found = [x for x in lines if x.who == who and x.scene == scene and (how is None or x.how == how)]
        rungs = [x.best(finest) for x in found if sampler is None or x.sampler == sampler]
        return min((r["merit"] for r in rungs if r), default=None)

    any_nlos = of("mitransient", None)
    per_spot = of("mitransient", "one render per spot")
    per_spot_independent = of("mitransient", "one render per spot", "independent")
    asked = [
        ("factored, Sobol', ε ≤ 1e-5 / best of mitransient", of("phicam", "factored", "sobol", "thesis", FINEST), any_nlos, 1e6),
        ("the same, board turned by 20°", of("phicam", "factored", "sobol", "turned", FINEST), any_nlos, 1e4),
        ("the same, spot a disc of 0.5 in.", of("phicam", "factored", "sobol", "disc", FINEST), any_nlos, 1e4),
        ("shared, Sobol' / best of mitransient", of("phicam", "shared", "sobol"), any_nlos, 1e4),
        ("independent, Sobol' / best of one render per spot", of("phicam", "independent", "sobol"), per_spot, 300),
        ("independent, PCG / independent of one render per spot", of("phicam", "independent", "pcg"), per_spot_independent, 10),
    ]
    return [
        {"what": what, "phicam": mine, "peer": theirs, "ratio": theirs / mine if mine and theirs else None, "asked": least}
        for what, mine, theirs, least in asked
    ]


def processor():
    try:
        for row in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if row.startswith("model name"):
                return row.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def recorded(lines, versions, variant, repeats, fixed):
    """What the files hold."""

    def row(line):
        finest = FINEST if (line.how, line.sampler) == ("factored", "sobol") else None
        best = (line.best(finest) or {}).get("samples")
        return {
            "who": line.who, "how": line.how, "sampler": line.sampler, "scene": line.scene, "best": best,
            "rungs": line.results(),
        }  # fmt: skip

    return {
        "date": date.today().isoformat(),
        "processor": processor(),
        "versions": versions,
        "variant": variant,
        "repeats": repeats,
        "fixed_seconds": fixed,
        "lines": [row(line) for line in lines],
        "ratios": ratios(lines),
    }


def markdown(record):
    peers_used = ", ".join(f"{k} {v}" for k, v in record["versions"].items()) or "no peer installed"
    out = [
        f"{record['date']}, {record['processor']}, one thread; {peers_used}, {record['variant']}; {record['repeats']} repeats a rung.",
        "",
        "| | way | sampler | scene | samples | ε | T (s) | ε²T | scale |",
        "| --- | --- | --- | --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for line in record["lines"]:
        for r in line["rungs"]:
            mark = "**" if r["samples"] == line["best"] else ""
            out.append(
                f"| {line['who']} | {line['how']} | {line['sampler']} | {line['scene']} | {r['samples']} | {r['error']:.1e} "
                f"| {r['seconds']:.2f} | {mark}{r['merit']:.1e}{mark} | {r['scale']:.5f} |"
            )
    out += ["", "| ε²T of the peer over ε²T of phicam | phicam | peer | ratio | aim: at least |", "| --- | ---: | ---: | ---: | ---: |"]
    number = lambda x: "–" if x is None else f"{x:.1e}"
    for r in record["ratios"]:
        out.append(f"| {r['what']} | {number(r['phicam'])} | {number(r['peer'])} | {number(r['ratio'])} | {r['asked']:.0e} |")
    return "\n".join(out) + "\n"


def main():
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description="ε²T of phicam, Mitsuba 3 and mitransient.")
    parser.add_argument("--phicam", type=Path, default=root / "target" / "release" / "phicam")
    parser.add_argument("--seconds", type=float, default=24.0, help="CPU time of the longest run of a line (24)")
    parser.add_argument("--repeats", type=int, default=5, help="runs a rung (5)")
    parser.add_argument("--variant", default="llvm_ad_mono", help="of Mitsuba; the fastest on a CPU unless given")
    parser.add_argument("-o", "--output", type=Path, help="FILE.md and FILE.json")
    args = parser.parse_args()
    if not args.phicam.exists():
        sys.exit(f"skipped: {args.phicam} does not exist (cargo build --release)")
    with tempfile.TemporaryDirectory() as folder:
        program = Program(args.phicam.resolve(), Path(folder))
        files = scenes.write(Path(folder))
        truths = {name: program.converged(path) for name, path in files.items()}
        theirs, versions = peers(program, files["thesis"], args.variant, truths["thesis"])
        lines, fixed = own(program, files, truths)
        lines += theirs
        for line in lines:
            line.calibrate(args.seconds)
            print(f"{line.name()}: up to {line.samples} samples", file=sys.stderr, flush=True)
        for repeat in range(1, args.repeats + 1):
            for rung in range(RUNGS):
                for line in lines:
                    line.measure(list(line.rungs)[rung], repeat)
            record = recorded(lines, versions, args.variant, repeat, fixed)
            if args.output:
                args.output.with_suffix(".md").write_text(markdown(record), encoding="utf-8")
                args.output.with_suffix(".json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
            print(f"repeat {repeat} of {args.repeats} done", file=sys.stderr, flush=True)
    print(markdown(record))


if __name__ == "__main__":
    main()
