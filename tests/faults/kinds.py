"""What is no file, or 3 GB of nothing, under every name of a folder: every command answers at once."""

import collections
import math
import os
import pathlib
import random
import shutil
import socket

from folders import FOLDERS, Folder, kinds as kinds_of, set_up
from program import DONE, Ended, Program, fresh

SECONDS = 2.0
HANGS = 60.0
BYTES = 200e6
STRAYS = {"run": ["frames/stray", "files/stray"], "job": ["files/stray", "shards/stray", "shards/stray.phs"]}


def pipe(path: pathlib.Path) -> None:
    os.mkfifo(path)


def bound(path: pathlib.Path) -> None:
    # A socket's address is short.
    folder = os.open(path.parent, os.O_RDONLY)
    with socket.socket(socket.AF_UNIX) as s:
        s.bind(f"/proc/self/fd/{folder}/{path.name}")
    os.close(folder)


def huge(path: pathlib.Path) -> None:
    with path.open("wb") as file:
        file.truncate(3_000_000_000)


KINDS = {
    "pipe": pipe,
    "socket": bound,
    "device": lambda path: path.symlink_to("/dev/zero"),
    "folder": lambda path: path.mkdir(),
    "dangling link": lambda path: path.symlink_to("nowhere"),
    "3 GB": huge,
}


def fault(ended: Ended, name: str, is_needed: bool) -> str:
    """What is wrong with an answer, or nothing; `is_needed`: an error has to name the file."""
    # Where more processes want to run than can, the clock says nothing of this one.
    seconds = ended.cpu if os.getloadavg()[0] > (os.cpu_count() or 1) else ended.seconds
    if ended.cut or seconds > SECONDS:
        return f"it takes {ended.seconds:.1f} s, {ended.cpu:.1f} s of them at work"
    if ended.peak > BYTES:
        return f"it takes {ended.peak / 1e6:.0f} MB"
    if not ended.is_documented:
        return f"exit code {ended.code}"
    last = name.rsplit("/", 1)[-1]
    named = [last, last.rsplit("-", 1)[-1], last.split(".")[0], "scene.toml"]
    if is_needed and ended.code not in DONE and not any(n in ended.words for n in named):
        return "it names no file"
    return ""


class Grid:
    """The cells of one folder."""

    def __init__(self, program: Program, folder: Folder, whole: pathlib.Path):
        self.program, self.folder, self.whole = program, folder, whole
        self.place = program.folder / folder.name
        self.known = {}
        for line in folder.commands:
            self.known[line] = self.run(line).code in DONE
            fresh(self.place, whole)
        self.codes = collections.defaultdict(collections.Counter)
        self.slowest, self.largest, self.wrong = {}, {}, 0

    def run(self, line: str) -> Ended:
        """Runs a command in folders of which one is not as it was."""
        again = self.program.folder / "again"
        shutil.rmtree(again, ignore_errors=True)
        return self.program(line, most=HANGS)

    def cell(self, name: str, kind: str, line: str) -> None:
        """One kind under one name, and one command."""
        fresh(self.place, self.whole)
        path = self.place / name
        path.unlink(missing_ok=True)
        KINDS[kind](path)
        ended = self.run(line)
        # A link to nothing is nothing, which has other words.
        what = fault(ended, name, self.known[line] and kind != "dangling link")
        self.codes[line][ended.code] += 1
        self.slowest[line] = max(self.slowest.get(line, 0.0), ended.cpu)
        self.largest[line] = max(self.largest.get(line, 0), ended.peak)
        if what:
            self.wrong += 1
            print(f"  {kind} as {self.folder.name}/{name}: {what}: {ended.account()}", flush=True)

    def show(self) -> None:
        print(f"\n{self.folder.name + '/':60} {'cells':>6} {'CPU s':>5} {'MB':>5}  exit codes")
        for line, codes in self.codes.items():
            by = ", ".join(f"{code}: {n}" for code, n in sorted(codes.items()))
            peak = self.largest[line] / 1e6
            print(f"{line[:60]:60} {codes.total():6} {self.slowest[line]:5.2f} {peak:5.0f}  {by}", flush=True)


def kinds(program: Program, share: float) -> int:
    """Prints a line for each command of each folder; the number of wrong answers."""
    set_up(program)
    wrong = 0
    for folder in FOLDERS:
        fresh(program.folder / f"{folder.name}-whole", program.folder / folder.name)
    for folder in FOLDERS:
        whole = program.folder / f"{folder.name}-whole"
        grid = Grid(program, folder, whole)
        names = [str(path.relative_to(whole)) for path in kinds_of(whole).values()]
        cells = [
            (name, kind, line)
            for name in sorted(names + STRAYS.get(folder.name, []))
            for kind in KINDS
            for line in folder.commands
        ]
        for cell in random.Random(1).sample(cells, math.ceil(share * len(cells))):
            grid.cell(*cell)
        grid.show()
        wrong += grid.wrong
        fresh(grid.place, whole)
    return wrong
