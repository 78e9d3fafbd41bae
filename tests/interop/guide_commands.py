"""Runs the commands that README.md and the guide show, and compares what they print with what stands there.

usage: python guide_commands.py PROGRAM [--slow] [PAGE.md …]

Every `phicam …` line of a block ```sh runs, in order, in a temporary folder of its page; `cargo run --release -- …` counts as `phicam …`, other lines are
not run. Exit code 0 is due, or what a comment says: `# exit 1`. Lines with `# minutes` run only if --slow is given, lines with `# yours` need
files that are not here and never run.

Each line of a block ```text directly after that is looked for in what the block's commands printed, in order, white space apart. A line `…` stands for any
lines; what stands behind `…` in a line is not compared. `# PATH is scenes/NAME.png` after a command: the file that it left is that picture.
Exit code 1, with words, where something differs.
"""

import argparse
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["README.md", "src/cli/guide/tutorial.md", "src/cli/guide/scenes.md", "src/cli/guide/gallery.md"]
SHOWN = re.compile(r"^```sh\n(?P<commands>.*?)^```\n(?:\n*```text\n(?P<printed>.*?)^```\n)?", re.M | re.S)
PROGRAM = re.compile(r"^(phicam|cargo run --release --) ")


def squeezed(line):
    return " ".join(line.split())


def commands(block):
    """The lines of a block as pairs (command, comment), continued lines joined."""
    lines = block.replace("\\\n", " ").splitlines()
    pairs = (re.split(r"\s+#\s", line, maxsplit=1) for line in lines)
    return [(command.strip(), "".join(comment)) for command, *comment in pairs if PROGRAM.match(command)]


def missing(expected, printed):
    """The first line of `expected` that is not found in `printed` behind the one before it, or None."""
    rest = iter([squeezed(line) for line in printed.splitlines()])
    for line in map(squeezed, expected.splitlines()):
        start, cut, _ = line.partition("…")
        if start and not any(other.startswith(start.rstrip()) if cut else other == line for other in rest):
            return line
    return None


def check_page(page, program, slow):
    """Runs the commands of a page; returns how many it shows, how many ran, and what is wrong in words."""
    wrong, found, ran = [], 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for shown in SHOWN.finditer((ROOT / page).read_text(encoding="utf-8")):
            printed, complete = "", True
            for command, comment in commands(shown["commands"]):
                found += 1
                if "yours" in comment or ("minutes" in comment and not slow):
                    complete = False
                    continue
                line = PROGRAM.sub(lambda _: shlex.quote(str(program)) + " ", command)
                done = subprocess.run(
                    ["bash", "-c", line], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8"
                )
                ran, printed = ran + 1, printed + done.stdout
                stated = re.search(r"exit (\d+)", comment)
                due = int(stated[1]) if stated else 0
                if done.returncode != due:
                    wrong.append(f"{page}: `{command}` ends with exit code {done.returncode}, not {due}:\n{done.stdout[-2000:]}")
                picture = re.search(r"(\S+) is (scenes/\S+)", comment)
                if picture and (Path(folder) / picture[1]).read_bytes() != (ROOT / picture[2]).read_bytes():
                    wrong.append(f"{page}: {picture[2]} is not what `{command}` draws")
            if shown["printed"] and complete:
                line = missing(shown["printed"], printed)
                if line is not None:
                    wrong.append(f"{page}: no line “{line}” where it is due in what was printed:\n{printed}")
    return found, ran, wrong


arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
arguments.add_argument("program", type=Path)
arguments.add_argument("pages", nargs="*", default=PAGES)
arguments.add_argument("--slow", action="store_true", help="run lines with the comment `# minutes` too")
given = arguments.parse_intermixed_args()
failed = False
for page in given.pages:
    found, ran, wrong = check_page(page, given.program.resolve(), given.slow)
    if not found:
        wrong.append(f"{page}: no commands found")
    failed |= bool(wrong)
    print(*wrong, f"{page}: {ran} of {found} commands run, {len(wrong)} wrong", sep="\n")
sys.exit(failed)
