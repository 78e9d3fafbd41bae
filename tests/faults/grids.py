#!/usr/bin/env python3
"""Grids of faults: whatever happens to files, memory and processes, nothing is lost or silently wrong.

    tests/faults/grids.py PHICAM [--share S] [GRID ...]

    flips    every byte of every kind of file flipped once: found by which command, or harmless
    kinds    pipes, sockets, devices, folders, dangling links, 3 GB under every name: 2 s, 200 MB
    limits   little address space, scenes of eight sizes, each command: exit code 0 or 2, never an abort
    pairs    two processes in one folder: never mixed files, never two writers
    kills    kill -9 at any moment: nothing finished is lost, going on ends with the same bytes

All of them unless some are named, whole or a share of their cells drawn at random. Python's
standard library is enough. Exit code 1 where something is wrong, told cell by cell.
"""

import argparse
import pathlib
import sys
import tempfile
import time

sys.dont_write_bytecode = True

from flips import flips
from kills import kills
from kinds import kinds
from limits import limits
from pairs import pairs
from program import Program

GRIDS = {"flips": flips, "kinds": kinds, "limits": limits, "pairs": pairs, "kills": kills}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("phicam", type=pathlib.Path)
    parser.add_argument("grids", nargs="*", metavar="GRID", help=", ".join(GRIDS))
    parser.add_argument("--share", type=float, default=1.0, help="of the cells")
    asked = parser.parse_args()
    if unknown := set(asked.grids) - set(GRIDS):
        parser.error(f"no such grid: {', '.join(unknown)}")
    wrong = 0
    for name in asked.grids or GRIDS:
        begun = time.monotonic()
        print(f"== {name}", flush=True)
        with tempfile.TemporaryDirectory(prefix="phicam-grid-") as folder:
            found = GRIDS[name](Program(asked.phicam, pathlib.Path(folder)), asked.share)
        wrong += found
        print(f"== {name}: {found} wrong, {time.monotonic() - begun:.0f} s", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
