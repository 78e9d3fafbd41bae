"""What one file is to show: how a scene names it, and the light that it must give, or why it is refused."""

import importlib
import importlib.metadata
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

# The largest of 27 relative differences where a file keeps what was written: traced light has a standard error below a third
# of it, which is asserted.
EXACT = 4e-4


@dataclass
class Case:
    """A file of another program."""

    path: Path
    layout: str
    # Keys of the surface in the scene.
    surface: str
    # By quadrature, pixels x spots, W; None where the file is to be refused.
    truth: np.ndarray | None
    allowed: float = EXACT
    # What the refusal must say: cause and cure.
    words: tuple[str, ...] = ()


@dataclass
class Program:
    """A program, how to see whether it is at hand, and what writes with it."""

    name: str
    # Writes into a folder: pairs of a layout and a function that returns a Case.
    files: object
    module: str | None = None
    package: str | None = None
    # A command and how it tells its version.
    command: list[str] | None = None

    def version(self):
        """Its version, or None where it is not at hand."""
        if self.module:
            try:
                importlib.import_module(self.module)
            except Exception:  # A broken installation is none.
                return None
            return importlib.metadata.version(self.package or self.module)
        if self.command:
            if not shutil.which(self.command[0]):
                return None
            told = subprocess.run(self.command, capture_output=True, text=True)
            words = (told.stdout + told.stderr).replace(",", " ").split()
            return next((w.strip("v") for w in words if w.strip("v")[:1].isdigit() and "." in w), "?")
        return "-"


def run(*command, stdin=None):
    """A command of another program, which must not fail."""
    done = subprocess.run([str(c) for c in command], capture_output=True, stdin=stdin)
    if done.returncode:
        raise RuntimeError(f"{command[0]}: {done.stderr.decode(errors='replace')[:200]}")
    return done.stdout
