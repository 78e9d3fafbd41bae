"""How far a computation is."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

#: What `progress=` takes: nothing, a line on standard error, or a function of (done, of).
Progress = bool | Callable[[int, int], object] | None


class Told:
    """Passes on how much of the work is done."""

    def __init__(self, what: str, progress: Progress, total: int = 0) -> None:
        self.what, self.progress, self.total, self.shown = what, progress, total, 0.0
        #: Done before the computation that tells.
        self.before = 0

    def of(self, total: int) -> None:
        """How much there is to do."""
        self.total = total

    def __call__(self, done: int) -> None:
        done += self.before
        if callable(self.progress):
            self.progress(min(done, self.total), self.total)
        elif self.progress and (time.monotonic() - self.shown > 0.2 or done >= self.total):
            self.shown = time.monotonic()
            share = 100.0 * min(1.0, done / max(1, self.total))
            end = "\n" if done >= self.total else ""
            sys.stderr.write(f"\r{self.what}: {share:3.0f} %{end}")
            sys.stderr.flush()


def told(what: str, progress: Progress, total: int = 0) -> Told | None:
    """What a computation is to call; nothing where nobody wants to know."""
    return Told(what, progress, total) if progress else None
