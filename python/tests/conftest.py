"""Scenes and photographs that several tests share."""

import os
import subprocess
from pathlib import Path

import pytest

import phicam


@pytest.fixture(scope="session")
def scene():
    return phicam.Scene("bench").replace({"laser.spots.per_side": 4, "camera.pixels": (8, 6)})


@pytest.fixture(scope="session")
def phi(scene):
    return phicam.render(scene, samples=64)


@pytest.fixture(scope="session")
def command():
    """The program `phicam`, whose path is in PHICAM."""
    path = os.environ.get("PHICAM")
    if not path:
        pytest.skip("PHICAM names no program to compare with")
    path = Path(path).resolve()

    def run(*arguments, code=0):
        done = subprocess.run([path, "-q", *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        return done.stdout

    run.program = path
    return run
