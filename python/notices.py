"""Writes THIRD-PARTY.txt: the licences of all crates that are linked into the module; with --check fails where it is stale.

usage: python notices.py [--check]
"""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

HERE = Path(__file__).parent
MANIFEST = ["--manifest-path", str(HERE / "Cargo.toml"), "--locked"]
OUTPUT = HERE / "THIRD-PARTY.txt"


def cargo(*arguments):
    return subprocess.run(["cargo", *arguments, *MANIFEST], capture_output=True, text=True, check=True).stdout


def linked():
    """Name and version of every crate that is compiled in on this platform."""
    tree = cargo("tree", "--prefix", "none", "-e", "normal,no-proc-macro", "-f", "{p}")
    return {tuple(line.replace(" v", " ").split()[:2]) for line in tree.splitlines() if line.strip()}


def texts(package):
    """Its licence texts: of several to choose from that of the MIT licence."""
    folder = Path(package["manifest_path"]).parent
    pattern = re.compile(r"(?i)(licen[sc]e|copying|notice)")
    files = sorted(f for f in folder.iterdir() if f.is_file() and pattern.match(f.name))
    if "MIT" in (package["license"] or ""):
        files = [f for f in files if "MIT" in f.name.upper()] or [f for f in files if "APACHE" not in f.name.upper()] or files
    return [f.read_text(encoding="utf-8", errors="replace").strip().replace("\r\n", "\n") for f in files]


def notices():
    wanted = linked()
    packages = json.loads(cargo("metadata", "--format-version", "1"))["packages"]
    found = sorted((p["name"], p["version"], p) for p in packages if (p["name"], p["version"]) in wanted and p["source"])
    users, lines = defaultdict(list), ["phicam's Python module is linked with these crates:", ""]
    for name, version, package in found:
        authors = ", ".join(package["authors"]) or "its authors"
        lines.append(f"{name} {version}: {package['license']}; {authors}")
        for text in texts(package):
            users[text].append(name)
    for text, names in users.items():
        lines += ["", "-" * 80, ", ".join(dict.fromkeys(names)), "-" * 80, "", text]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    text = notices()
    if "--check" in sys.argv[1:]:
        if OUTPUT.read_text(encoding="utf-8") != text:
            sys.exit(f"{OUTPUT} is stale\n  cure: python {Path(__file__).name}")
    else:
        OUTPUT.write_text(text, encoding="utf-8")
