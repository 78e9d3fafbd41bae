"""One small folder of each kind that phicam leaves, and the commands that read it."""

import pathlib
import re
from typing import NamedTuple

from program import Program, painted, scene

PATHS = "--samples 64"
NOISE = "study noise t.toml -o study --method pinv --boards 2 --elements 2 --seeds 2 --noise 1e-4,1e-2"
REPRODUCE = "reproduce table2 -o published --most-elements 8"
READ_EXPOSED = (
    "recover run --phi run/exposed/phi.npy --stderr run/exposed/phi.stderr.npy"
    " --method joint --keep-clipped -o again"
)

READ_CALIBRATED = (
    "recover run/calibrated --phi run/phi.npy --stderr run/phi.stderr.npy --method joint -o again"
)


class Folder(NamedTuple):
    """A folder and what reads it. What a command leaves in `again` is looked at, too."""

    name: str
    commands: list[str]


FOLDERS = [
    Folder(
        "run",
        [
            "stack run -o again",
            "validate run",
            "recover run --method joint -o again",
            READ_EXPOSED,
            READ_CALIBRATED,
            "expose run --sensor machine-vision --exposure 1us",
            "expose run --sensor ideal --exposure 1 -o again",
            "locate run",
            "calibrate run --free hinge.angle=0.1",
            "model t.toml -o run",
            f"render t.toml -o run {PATHS}",
            f"run t.toml -o run {PATHS}",
            "view run/phi.npy -o again.png --force",
            "scene check run/scene.toml",
        ],
    ),
    Folder("part", [f"render t.toml -o part {PATHS}", "validate part", "stack part -o again"]),
    Folder("study", [NOISE]),
    Folder("spots", ["study spots t.toml -o spots"]),
    Folder("published", [REPRODUCE]),
    Folder(
        "job",
        [
            "status job",
            "shard job --index 0",
            "merge job -o again",
            "slurm job --dry-run",
            "clean job --dry-run",
        ],
    ),
    Folder("merged", ["merge job -o merged", "stack merged -o again", "validate merged"]),
    Folder("imported", ["stack imported -o again", "recover imported --method pinv -o again"]),
    Folder(
        "in",
        ["import in/set.toml -o again", "import --frames in/spot-*.png --scene t.toml -o again"],
    ),
]


def set_up(program: Program) -> None:
    """Makes the folders."""
    program.done("target edge -o edge.png --linear --size 2,2")
    program.write("t.toml", painted(scene(program, "[2, 2]")))
    program.done(f"run t.toml -o run {PATHS}")
    # Not saturated.
    program.done("expose run --sensor machine-vision --exposure 1us")
    program.done("locate run")
    program.done("calibrate run --free hinge.angle=0.1")
    program.done(f"render t.toml -o part {PATHS} --spots 0..2")
    program.done(NOISE)
    program.done("study spots t.toml -o spots")
    program.done(REPRODUCE)
    program.done(f"plan t.toml -o job --shards 2 {PATHS}")
    for index in [0, 1]:
        program.done(f"shard job --index {index}")
    program.done("merge job -o merged")
    inputs = program.folder / "in"
    inputs.mkdir()
    for photograph in (program.folder / "run/exposed/counts").glob("*.png"):
        (inputs / photograph.name).write_bytes(photograph.read_bytes())
    program.write("in/set.toml", 'scene = "../t.toml"\nframes = "spot-*.png"\n')
    program.done("import --frames in/spot-*.png --scene t.toml -o imported")


def kind(name: str) -> str:
    """What a file is one of: frames are alike, and the files of every method."""
    name = re.sub(r"spot-\d+", "spot-N", name)
    name = re.sub(r"recovered/(joint|pinv|tikhonov)[a-z-]*\.", "recovered/METHOD.", name)
    name = re.sub(r"[0-9a-f]{12}-(\d+-\d+\.phs|)", lambda m: "ID-" + m[1] and m[1][-3:], name)
    return re.sub(r"spots-\d+-\d+", "spots-A-B", name)


def kinds(folder: pathlib.Path) -> dict[str, pathlib.Path]:
    """The smallest file of each kind below a folder, by its kind."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    files.sort(key=lambda path: path.stat().st_size, reverse=True)
    return {kind(str(path.relative_to(folder))): path for path in files}
