"""Every byte of a file flipped once: who finds it, or why it does no harm; none silently wrong."""

import collections
import math
import pathlib
import random
import re
import shutil

from folders import FOLDERS, NOISE, PATHS, READ_CALIBRATED, READ_EXPOSED, REPRODUCE, kinds, set_up
from program import DONE, Ended, Program, contents, fresh

# Of a longer file, or where a reader takes longer, a sample of its bytes.
ALL_UP_TO = 16 * 1024
LONG = 0.15
SAMPLE = 256
# What reads the files of a folder whose names match, or vouches for them; every one is asked.
READERS = [
    ("run", "", ["stack run -o again"]),
    ("run", r"^(run.json|scene.toml|files/.*|phi[a-z.]*)$", ["validate run"]),
    ("run", r"^(run.json|scene.toml|phi[a-z.]*)$", ["recover run --method joint -o again"]),
    ("run", r"^exposed/(phi[a-z.]*|saturated.npy)$", [READ_EXPOSED]),
    ("run", r"^located/", ["locate run"]),
    ("run", r"^calibrated/", ["calibrate run --free hinge.angle=0.1"]),
    ("run", r"^calibrated/(scene.toml|files/.*)$", [READ_CALIBRATED]),
    ("run", r"^exposed/", ["expose run --sensor machine-vision --exposure 1us"]),
    ("run", r"^(run.json|scene.toml|frames/.*)$", [f"render t.toml -o run {PATHS}"]),
    ("part", "", [f"render t.toml -o part {PATHS}"]),
    ("study", "", [NOISE]),
    ("spots", "", ["study spots t.toml -o spots"]),
    ("published", "", [REPRODUCE]),
    ("job", "", ["status job", "merge job -o again", "shard job --index 0"]),
    ("merged", "", ["stack merged -o again", "validate merged", "merge job -o merged"]),
    ("imported", "", ["stack imported -o again"]),
    ("imported", r"^[^/]*$", ["recover imported --method pinv -o again"]),
]
OUTCOMES = ["refused", "told", "mended", "none", "wrong"]


class Reader:
    """A command that reads a folder, and what it does while nothing is changed."""

    def __init__(self, program: Program, whole: pathlib.Path, place: pathlib.Path, line: str):
        self.program, self.whole, self.place, self.line = program, whole, place, line
        fresh(place, whole)
        self.known, self.results = self.run()
        if self.known.crashed:
            raise SystemExit(self.known.account())
        self.writes = contents(place) != contents(whole)
        fresh(place, whole)

    def run(self):
        """How it ends, and what it leaves."""
        again = self.program.folder / "again"
        shutil.rmtree(again, ignore_errors=True)
        ended = self.program(self.line)
        found = contents(self.place)
        if again.exists():
            found |= {f"again/{name}": data for name, data in contents(again).items()}
        return ended, found

    def outcome(self, name: str, changed: bytes) -> str:
        """One of OUTCOMES, and of a wrong one the account, with the file `name` changed.

        refused: an error that names the file. told: the work is done, and a remark names it. mended:
        the same results, and the file is whole again. none: the same results.
        """
        path = self.place / name
        path.write_bytes(changed)
        ended, found = self.run()
        now = path.read_bytes() if path.exists() else b""
        if now != changed or self.writes:
            fresh(self.place, self.whole)
        else:
            path.write_bytes((self.whole / name).read_bytes())
        more = [x for x in said(ended) if x not in said(self.known)]
        is_named = any(word in line for word in names(name) for line in more)
        if not ended.is_documented:
            return "wrong\n" + ended.account()
        if ended.code not in DONE and (ended.code != self.known.code or more):
            return "refused" if is_named else "wrong: it does not name the file\n" + ended.account()
        # The file itself, and copies of it, are as they were found.
        known = self.results | {key: data for key, data in found.items() if data == changed}
        same = {**found, name: b""} == {**known, name: b""}
        if is_named and (same or "warning" in ended.words):
            return "told"
        # Whoever traces a run again names its folder, and leaves the file whole.
        if not same or ended.code != self.known.code or (more and now == changed):
            return "wrong: other results\n" + ended.account()
        return "none" if now == changed else "mended"


def said(ended: Ended) -> list[str]:
    """What a command says, but for times."""
    return [line for line in ended.words.splitlines() if not line.startswith("time ")]


def names(name: str) -> list[str]:
    """Words that name a file: its own name, of a copy that which the scene gives it, or the scene."""
    last = name.rsplit("/", 1)[-1]
    return [last, last.split("-", 1)[-1], "scene.toml"] if "files/" in name else [last]


def tally(readers: list[Reader], whole: pathlib.Path, name: str, share: float) -> collections.Counter:
    """Over the changes of single bytes: how many had which outcome by which reader, and in all."""
    data, counts = (whole / name).read_bytes(), collections.Counter()
    some, slow = range(len(data)), any(reader.known.seconds > LONG for reader in readers)
    count = len(data) if len(data) <= ALL_UP_TO and not slow else min(len(data), SAMPLE)
    some = random.Random(1).sample(some, math.ceil(share * count))
    for at in some:
        changed = bytearray(data)
        changed[at] ^= 1 << at % 8
        found = [reader.outcome(name, bytes(changed)) for reader in readers]
        words = [outcome.split(":")[0].split("\n")[0] for outcome in found]
        if "wrong" in words:
            if counts["wrong"] < 3:
                print(f"  byte {at} of {name}, {data[at]:#x} flipped to {changed[at]:#x}: {found}")
            counts["wrong"] += 1
        else:
            counts[min(words, key=OUTCOMES.index)] += 1
        for reader, word in zip(readers, words):
            counts[reader.line, word] += 1
    return counts


def flips(program: Program, share: float) -> int:
    """Prints a table for each folder; the number of changes with a wrong outcome."""
    set_up(program)
    wrong = 0
    for folder in dict.fromkeys(folder for folder, _, _ in READERS):
        place, whole = program.folder / folder, program.folder / f"{folder}-whole"
        fresh(whole, place)
        readers = [
            (pattern, Reader(program, whole, place, line))
            for name, pattern, lines in READERS
            if name == folder
            for line in lines
        ]
        print(f"\n{folder + '/':40}   bytes  flips" + "".join(f"{o:>8}" for o in OUTCOMES))
        for kind, path in sorted(kinds(whole).items()):
            name = str(path.relative_to(whole))
            own = [reader for pattern, reader in readers if re.search(pattern, name)]
            counts = tally(own, whole, name, share)
            sums = [counts[outcome] for outcome in OUTCOMES]
            wrong += counts["wrong"]
            print(f"{kind:40} {path.stat().st_size:7} {sum(sums):6}" + "".join(f"{n:8}" for n in sums))
            for reader in own:
                by = ", ".join(f"{counts[reader.line, o]} {o}" for o in OUTCOMES if counts[reader.line, o])
                print(f"    {reader.line[:60]}: {by}", flush=True)
    return wrong
