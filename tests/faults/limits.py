"""Little address space, scenes of eight sizes, each command: exit code 0 or 2, never an abort."""

import collections
import os
import random
import shutil

from program import STOPPED, Ended, Program, scene

GIB = 1 << 30
SPACES = [1, 2, 4, 6]
# What works longer is interrupted, and has to end soon after.
LONG = 4.0
SOON = 2.0


def ring(count: int) -> str:
    """So many spots on the wall."""
    points = ([0.5 + 10.5 * (k % 100) / 99, 0.5 + 2.0 * (k // 100) / 100] for k in range(count))
    return str([list(p) for p in points])


# Pixels, spots, elements.
SIZES = {
    "16 × 16 px, 8 spots, 4 elements": ("[16, 16]", 8, "[2, 2]"),
    "64 × 64 px, 100 spots, 64 elements": ("[64, 64]", 100, "[8, 8]"),
    "16 px, 10 000 spots, 64 elements": ("[4, 4]", 10_000, "[8, 8]"),
    "256 × 256 px, 100 spots, 1024 elements": ("[256, 256]", 100, "[32, 32]"),
    "1024 × 1024 px, 4 spots, 64 elements": ("[1024, 1024]", 4, "[8, 8]"),
    "2048 × 2048 px, 10 spots, 4 elements": ("[2048, 2048]", 10, "[2, 2]"),
    "4096 × 4096 px, 1 spot, 4 elements": ("[4096, 4096]", 1, "[2, 2]"),
    "8192 × 8192 px, 1 spot, 4 elements": ("[8192, 8192]", 1, "[2, 2]"),
}
FEW = "--samples 32"
OF_SCENE = [
    "scene check s.toml",
    "scene show s.toml -o out.svg",
    "scene view s.toml --samples 1 --size 64,64 -o out.png",
    "scene export s.toml --mitsuba -o out.py",
    f"render s.toml -o out {FEW}",
    f"render s.toml -o out {FEW} --estimator shared",
    f"render s.toml -o out {FEW} --estimator factored",
    f"run s.toml -o out {FEW} --estimator shared",
    "model s.toml -o out",
    "model s.toml -o out --integration quadrature",
    f"plan s.toml -o out --shards 2 {FEW}",
    "study budget s.toml -o out",
    "study tolerance s.toml -o out",
    "study convergence s.toml -o out",
    "study power s.toml -o out",
    "study noise s.toml -o out",
    "study coverage s.toml -o out",
    "study spots s.toml -o out",
    "study brdf s.toml -o out",
    "study indicator s.toml -o out",
    "study layout s.toml -o out",
]
OF_RUN = [
    "stack done -o out",
    "validate done",
    "recover done --method joint -o out",
    "recover done --method tikhonov -o out",
    "recover done -o out",
    "expose done --sensor ccd --exposure 1 -o out",
    "locate done -o out",
    "calibrate done --free hinge.angle=0.1 -o out",
    "view done/phi.npy -o out.png",
    "shard job --index 0",
    "merge job -o out",
]


def run_of_this_size(program: Program) -> bool:
    """A run and a plan of the scene, where this machine makes them soon."""
    paths = "--samples 32 --estimator factored"
    lines = [f"render s.toml -o done {paths}", f"plan s.toml -o job --shards 1 {paths}"]
    return all(program(line, most=60.0).code == 0 for line in [*lines, "shard job --index 0"])


def outcome(ended: Ended) -> str:
    """The exit code, or that it worked until its time was over and then ended soon; else wrong.

    writing: it said that what is finished is being written, and ended when it was.
    """
    is_soon = ended.seconds < LONG + SOON or os.getloadavg()[0] > (os.cpu_count() or 1)
    if ended.cut and not ended.crashed and ended.code == STOPPED:
        if is_soon:
            return "at work"
        if "is being written" in ended.words:
            return "writing"
    return str(ended.code) if ended.is_documented else f"WRONG: {ended.code}"


def remove(program: Program, names: list[str]) -> None:
    for path in (program.folder / name for name in names):
        shutil.rmtree(path, ignore_errors=True)
        path.unlink(missing_ok=True)


def limits(program: Program, share: float) -> int:
    """Prints a line for each command; the number of wrong answers."""
    counts, wrong, chosen = collections.defaultdict(collections.Counter), 0, random.Random(1)
    for size, (pixels, spots, elements) in SIZES.items():
        if chosen.random() > 10.0 * share:
            continue
        program.write("s.toml", scene(program, pixels, ring(spots), elements))
        lines = OF_SCENE + (OF_RUN if run_of_this_size(program) else [])
        slow = set()
        for space, line in [(space, line) for space in SPACES for line in lines]:
            if chosen.random() > share:
                continue
            # With more memory it works as long.
            found = "at work" if line in slow else ""
            if not found:
                ended = program(line, most=LONG, space=space * GIB)
                found = outcome(ended)
            if found in {"at work", "writing"}:
                slow.add(line)
            elif found.startswith("WRONG"):
                wrong += 1
                print(f"  {space} GiB, {size}: {ended.account()}", flush=True)
            counts[line][found] += 1
            remove(program, ["out", "out.svg", "out.png", "out.py"])
        remove(program, ["done", "job"])
        print(f"{size}: {len(lines)} commands, {len(slow)} at work for {LONG:.0f} s", flush=True)
    print(f"\n{'':60} cells by exit code")
    for line, codes in counts.items():
        print(f"{line[:60]:60} {', '.join(f'{c}: {n}' for c, n in sorted(codes.items()))}")
    return wrong
