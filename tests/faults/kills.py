"""Kill -9 at any moment: nothing that was finished is lost, going on ends with the same bytes."""

import math
import pathlib
import random
import re
import shutil
import subprocess
from typing import NamedTuple

from program import Program, contents, differences, fresh, kept, scene

KILLS = 200


class Work(NamedTuple):
    """A command, what is there before it, and what it leaves."""

    line: str
    output: str  # its folder
    before: str = ""  # what its folder starts as
    untouched: str = ""  # a folder that it only reads


WORKS = {
    "render": Work("render s.toml -o out --samples {} --estimator shared", "out"),
    "run": Work("run s.toml -o out --samples {} --estimator shared", "out"),
    "render, replacing": Work("render s.toml -o out --samples {} --estimator shared --replace", "out", "base"),
    "recover": Work("recover base --method joint,tikhonov,pinv -o out", "out", "", "base"),
    "recover, again": Work("recover base --method joint,tikhonov,pinv -o out", "out", "recovered", "base"),
    "expose": Work("expose base --sensor ccd --exposure 1 -o out", "out", "", "base"),
    "expose, replacing": Work("expose base --sensor ccd --exposure 1 --seed 2 --replace", "base", "exposed"),
    "study": Work("study noise s.toml -o out --method pinv,joint --boards 2 --seeds 10", "out"),
    "merge": Work("merge job -o out", "out", "", "job"),
}


def set_up(program: Program) -> None:
    """A scene of 64 spots, a run of it, the same exposed, and a plan that is computed."""
    points = str([[1.0 + 0.15 * k, 3.0] for k in range(64)])
    program.write("s.toml", scene(program, "[16, 16]", points, "[4, 4]"))
    paths = "--samples 64 --estimator shared"
    program.done(f"render s.toml -o base {paths}")
    program.done(f"plan s.toml -o job --shards 3 {paths}")
    for index in range(3):
        program.done(f"shard job --index {index}")
    shutil.copytree(program.folder / "base", program.folder / "exposed")
    program.done("expose exposed --sensor ccd --exposure 1")
    program.done("recover base --method joint,tikhonov,pinv -o recovered")
    for name in ["base", "exposed", "job", "recovered"]:
        shutil.copytree(program.folder / name, program.folder / f"{name}-whole")


def begin_anew(program: Program, work: Work) -> None:
    """The folders as they are before the work."""
    shutil.rmtree(program.folder / "out", ignore_errors=True)
    for name in ["base", "job"]:
        fresh(program.folder / name, program.folder / f"{name}-whole")
    if work.before:
        fresh(program.folder / work.output, program.folder / f"{work.before}-whole")


def whole(program: Program, work: Work) -> tuple[str, float, dict[str, bytes]]:
    """The command with enough to do that moments of it can be met, what it takes, what it leaves."""
    samples = 1024
    while True:
        line = work.line.format(samples)
        begin_anew(program, work)
        seconds = program.done(line).seconds
        if seconds > 0.5 or line == work.line:
            return line, seconds, contents(program.folder / work.output)
        samples *= 4


# What is on its way to its place.
STAGED = re.compile(r"(^|/)[.](replacement|incoming|exposed-new|exposed-incoming)/")


def finished(place: pathlib.Path, results: dict[str, bytes]) -> set[str]:
    """The files that are what they will be, in their place or on their way to it."""
    found = kept(contents(place))
    # Photographs are finished together: their account is written last.
    whole = any(name.endswith(".exposed-new/exposure.json") for name in found)
    ready = [(n, data) for n, data in found.items() if whole or ".exposed-new/" not in n]
    named = ((STAGED.sub(r"\1", name), name, data) for name, data in ready)
    # Photographs wait beside their folder's others.
    return {
        last
        for name, path, data in named
        for last in [name, f"exposed/{name}"]
        if results.get(last) == data
    }


def differing(place: pathlib.Path, results: dict[str, bytes]) -> list[str]:
    """Files that are not as they are to be. A study's tasks say which process computed them."""
    names = differences(kept(contents(place)), results)
    return [name for name in names if not name.endswith(".phs")]


def kills(program: Program, share: float) -> int:
    """Prints a line for each work; the number of faults."""
    set_up(program)
    moments, wrong = random.Random(1), 0
    most = math.ceil(share * KILLS / len(WORKS))
    print(f"{'':20} killed  rounds  went on with files  s")
    for name, work in WORKS.items():
        line, seconds, results = whole(program, work)
        place = program.folder / work.output
        killed, rounds, met = 0, 0, 0
        while killed < most:
            begin_anew(program, work)
            rounds += 1
            before, faults = finished(place, results), []
            for _ in range(20):
                child = program.begin(line)
                moment = moments.uniform(0.0, 1.1 * seconds)
                try:
                    child.process.wait(timeout=moment)
                except subprocess.TimeoutExpired:
                    child.kill()
                    child.process.wait()
                if child.process.returncode == 0 or killed == most:
                    break
                killed += 1
                now = finished(place, results)
                met += bool(now - before)
                faults += [f"{lost} is lost" for lost in sorted(before - now)]
                before = now
            ended = program(line, most=1200.0)
            if ended.code not in {0, 1}:
                faults.append(ended.account())
            faults += [f"{n} has other bytes" for n in differing(place, results)]
            if work.untouched:
                there = contents(program.folder / work.untouched)
                known = contents(program.folder / f"{work.untouched}-whole")
                faults += [f"{n} was changed" for n in differences(there, known)]
            if faults:
                wrong += 1
                print(f"  {line}: " + "; ".join(faults[:8]), flush=True)
        print(f"{name:20} {killed:6} {rounds:7} {met:19}  {seconds:.2f}", flush=True)
    return wrong
