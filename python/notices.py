"""Writes the licences of all crates that are linked into the module (THIRD-PARTY.txt) and into the command
(../src/cli/commands/third_party.txt, which `phicam notices` prints); with --check fails where one is stale.

usage: python notices.py [--check]
"""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

HERE = Path(__file__).parent
#: What is linked, the manifest of that package, the file of its notices.
OUTPUTS = [
    ("phicam's Python module", HERE / "Cargo.toml", HERE / "THIRD-PARTY.txt"),
    ("The command phicam", HERE.parent / "Cargo.toml", HERE.parent / "src/cli/commands/third_party.txt"),
]


def cargo(manifest, *arguments):
    command = ["cargo", *arguments, "--manifest-path", str(manifest), "--locked"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def linked(manifest):
    """Name and version of every crate that is compiled in on this platform."""
    tree = cargo(manifest, "tree", "--prefix", "none", "-e", "normal,no-proc-macro", "-f", "{p}")
    return {tuple(line.replace(" v", " ").split()[:2]) for line in tree.splitlines() if line.strip()}


def texts(package):
    """Its licence texts: of several to choose from that of the MIT licence."""
    folder = Path(package["manifest_path"]).parent
    pattern = re.compile(r"(?i)(licen[sc]e|copying|notice)")
    files = sorted(f for f in folder.iterdir() if f.is_file() and pattern.match(f.name))
    if "MIT" in (package["license"] or ""):
        files = [f for f in files if "MIT" in f.name.upper()] or [f for f in files if "APACHE" not in f.name.upper()] or files
    return [f.read_text(encoding="utf-8", errors="replace").strip().replace("\r\n", "\n") for f in files]


def notices(what, manifest):
    wanted = linked(manifest)
    packages = json.loads(cargo(manifest, "metadata", "--format-version", "1"))["packages"]
    found = sorted((p["name"], p["version"], p) for p in packages if (p["name"], p["version"]) in wanted and p["source"])
    users, lines = defaultdict(list), [f"{what} is linked with these crates:", ""]
    for name, version, package in found:
        authors = ", ".join(package["authors"]) or "its authors"
        lines.append(f"{name} {version}: {package['license']}; {authors}")
        for text in texts(package):
            users[text].append(name)
    for text, names in users.items():
        lines += ["", "-" * 80, ", ".join(dict.fromkeys(names)), "-" * 80, "", text]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for what, manifest, output in OUTPUTS:
        text = notices(what, manifest)
        if "--check" not in sys.argv[1:]:
            output.write_text(text, encoding="utf-8")
        elif output.read_text(encoding="utf-8") != text:
            sys.exit(f"{output} is stale\n  cure: python {Path(__file__).name}")
