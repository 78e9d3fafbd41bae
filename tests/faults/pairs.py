"""Two processes in one folder: never mixed files, never two writers, nothing finished is lost."""

import collections
import math
import shutil

from program import DONE, Program, contents, differences, painted, scene

REFUSALS = ["is being written", "other settings", "other photographs", "another plan", "other scene"]
PAIRS = 200


def set_up(program: Program) -> None:
    """A scene, a run of it, and two plans that are computed."""
    program.done("target edge -o edge.png --linear --size 2,2")
    program.write("t.toml", painted(scene(program, "[2, 2]")))
    program.done("render t.toml -o base --samples 64")
    for job, samples in [("job", 64), ("other", 128)]:
        program.done(f"plan t.toml -o {job} --shards 1 --samples {samples}")
        program.done(f"shard {job} --index 0")


RENDER = "render t.toml -o out --samples {} --estimator shared"
RUN = "run t.toml -o out --samples {} --estimator shared"
RECOVER = "recover base --method {} -o out"
# Two commands of which each ends alone with what is then to be found.
CASES = {
    "render, same settings": [RENDER.format(4096)] * 2,
    "render, other settings": [RENDER.format(4096), RENDER.format(8192)],
    "render, other settings replace": [RENDER.format(4096), RENDER.format(8192) + " --replace"],
    "run, same settings": [RUN.format(4096)] * 2,
    "run, other settings": [RUN.format(4096), RUN.format(8192)],
    "render and run": [RENDER.format(4096), RUN.format(4096)],
    "recover, same method": [RECOVER.format("joint")] * 2,
    "recover, other methods": [RECOVER.format("joint"), RECOVER.format("tikhonov")],
    "merge, same plan": ["merge job -o out"] * 2,
    "merge, other plan": ["merge job -o out", "merge other -o out"],
    "merge and render": ["merge job -o out", RENDER.format(8192)],
    "recover and run": [RECOVER.format("joint"), RUN.format(4096)],
}


def pairs(program: Program, share: float) -> int:
    """Prints a line for each case; the number of pairs that went wrong."""
    set_up(program)
    out, wrong = program.folder / "out", 0
    rounds = math.ceil(share * PAIRS / len(CASES))
    print(f"{'':32} pairs  exit codes")
    for case, lines in CASES.items():
        # What each leaves alone, and each after the other.
        possible, alone = [], {}
        for order in {tuple(lines), tuple(reversed(lines))}:
            shutil.rmtree(out, ignore_errors=True)
            for line in order:
                alone.setdefault(line, program(line))
                if line not in order[:1]:
                    program(line)
                possible.append(contents(out))
        codes = collections.Counter()
        for number in range(rounds):
            shutil.rmtree(out, ignore_errors=True)
            children = [program.begin(line) for line in (lines, lines[::-1])[number % 2]]
            ended = [child.end() for child in children]
            codes[", ".join(str(e.code) for e in sorted(ended, key=lambda e: lines.index(e.line)))] += 1
            refused = [e for e in ended if e.code not in DONE]
            found = contents(out)
            faults = [e.account() for e in ended if e.crashed or not e.is_documented]
            faults += [e.account() for e in refused if not any(r in e.words for r in REFUSALS)]
            if len(refused) == 2:
                faults.append("neither has done its work")
            if found not in possible:
                nearest = min((differences(found, p) for p in possible), key=len)
                faults.append(f"the folder is that of neither: {nearest}")
            if faults:
                wrong += 1
                print(f"  {case}: " + "; ".join(faults), flush=True)
        by = "; ".join(f"{c}: {n}" for c, n in sorted(codes.items()))
        print(f"{case:32} {codes.total():5}  {by}", flush=True)
    return wrong
