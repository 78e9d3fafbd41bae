"""The program under test: its commands timed and measured, small scenes, what a folder holds."""

import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from typing import NamedTuple

# Exit codes that `phicam help` documents: of what is done, and of what is refused.
DONE = {0, 1, 4}
SCHEDULED = {"plan", "shard", "status", "merge", "slurm", "clean"}
STOPPED = 130
# Three photographs of 2 × 2 pixels; a picture on the hidden surface, so that copies are kept.
POINTS = "[[2.0, 3.0], [6.0, 7.0], [8.0, 3.0]]"


class Ended(NamedTuple):
    """How a command ended."""

    line: str
    code: int  # as a shell tells it: 128 + n where signal n ended it
    words: str  # what it says, on both outputs
    seconds: float  # by the clock
    cpu: float  # s
    peak: int  # most resident memory, bytes
    cut: bool  # whether its time was over

    @property
    def crashed(self) -> bool:
        """Whether it ended by a panic, an abort or a signal that nobody sent."""
        return "panicked" in self.words or not self.cut and (self.code == 101 or self.code >= 128)

    @property
    def is_documented(self) -> bool:
        """Whether its exit code is one that its command has."""
        is_scheduled = self.line.split()[0] in SCHEDULED
        codes = {0, 1, 3, 64, 65, 66, 74} if is_scheduled else DONE | {2}
        return self.code in codes and not self.crashed

    def account(self) -> str:
        """For who looks for the cause."""
        said = self.words.strip()[-600:]
        return f"`{self.line}`: exit code {self.code}, {self.seconds:.1f} s, {self.peak >> 20} MB\n{said}"


class Program:
    """phicam in a folder of its own."""

    def __init__(self, path: pathlib.Path, folder: pathlib.Path):
        self.path, self.folder = path.resolve(), folder

    def begin(self, line: str, space: int | None = None) -> "Child":
        """Starts a command, within `space` bytes of address space."""
        return Child(self, line, space)

    def __call__(self, line: str, most: float = 120.0, space: int | None = None) -> Ended:
        """Runs a command; Ctrl-C after `most` seconds."""
        return self.begin(line, space).end(most)

    def done(self, line: str) -> Ended:
        """Runs a command that has to do its work."""
        ended = self(line)
        if ended.code not in DONE or ended.crashed:
            raise SystemExit(f"this cannot be set up: {ended.account()}")
        return ended

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text)


class Child:
    """A command at work."""

    def __init__(self, program: Program, line: str, space: int | None):
        self.line, self.said = line, tempfile.TemporaryFile()
        limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (space, space))
        self.begun = time.monotonic()
        self.process = subprocess.Popen(
            [program.path, *line.split()],
            cwd=program.folder,
            stdin=subprocess.DEVNULL,
            stdout=self.said,
            stderr=subprocess.STDOUT,
            preexec_fn=limit if space else None,
        )

    def kill(self, how: int = signal.SIGKILL) -> None:
        """Sends a signal to it, unless it has ended."""
        self.process.send_signal(how)

    def end(self, most: float = 120.0) -> Ended:
        """Waits for its end; Ctrl-C after `most` seconds, kill -9 ten seconds later."""
        cut = threading.Event()

        def stop() -> None:
            cut.set()
            self.kill(signal.SIGINT)

        timers = [threading.Timer(most, stop), threading.Timer(most + 10.0, self.kill)]
        for timer in timers:
            timer.start()
        _, status, used = os.wait4(self.process.pid, 0)
        seconds = time.monotonic() - self.begun
        for timer in timers:
            timer.cancel()
        code = os.waitstatus_to_exitcode(status)
        code = 128 - code if code < 0 else code
        self.process.returncode = code
        self.said.seek(0)
        words = self.said.read().decode(errors="replace")
        self.said.close()
        cpu = used.ru_utime + used.ru_stime
        return Ended(self.line, code, words, seconds, cpu, used.ru_maxrss * 1024, cut.is_set())


def scene(program: Program, pixels: str, points: str = POINTS, elements: str = "[2, 2]") -> str:
    """The bench with other pixels, spots and elements."""
    text = program.done("scene export bench").words
    layout = re.compile(r'^layout = "square".*?^$', re.DOTALL | re.MULTILINE)
    text = layout.sub(f'layout = "list"\npoints = {points}\n', text, count=1)
    text = text.replace("pixels = [16, 16]", f"pixels = {pixels}")
    return text.replace("elements = [8, 8]", f"elements = {elements}")


def painted(text: str) -> str:
    """The scene with a picture on its hidden surface, edge.png."""
    board = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }"
    return text.replace(board, '{ image = "edge.png", transfer = "linear" }')


def fresh(place: pathlib.Path, whole: pathlib.Path) -> None:
    """Makes `place` a copy of the folder `whole`."""
    if place.is_symlink() or place.is_file():
        place.unlink()
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(whole, place)


# Times and what names them; a page that has them.
TIMED = re.compile(r"(^|/)((run|summary)\.json|report\.html)$")


def contents(folder: pathlib.Path) -> dict[str, bytes]:
    """The files below a folder and their bytes, without those that hold times."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    named = ((str(path.relative_to(folder)), path) for path in files)
    return {name: path.read_bytes() for name, path in named if not TIMED.search(name)}


def differences(one: dict[str, bytes], other: dict[str, bytes]) -> list[str]:
    """The names of files that two folders do not share."""
    return sorted(name for name in one | other if one.get(name) != other.get(name))


def kept(found: dict[str, bytes]) -> dict[str, bytes]:
    """Without what an ended process was writing, and its lock."""
    return {name: data for name, data in found.items() if ".phicam-" not in name}
