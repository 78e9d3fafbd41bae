"""Holds phicam to meshes and pictures that other programs wrote, in absolute watts.

usage: python foreign_files.py PHICAM [--only WORD ...] [--keep FOLDER]

Every program that is at hand writes files; the others are skipped, and told. PHICAM renders each: three spots, 3 x 3
pixels, estimator `factored`. The flux of every entry is held against quadrature over the arrays that the file was written
from (foreign/light.py, NumPy alone). Files of kinds that are not read must be refused with cause and cure, exit code 2.
Prints Markdown tables; exit code 1 if a file differs. --only: programs whose name contains a WORD.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

import numpy as np

from foreign import by_hand, meshes, pictures
from foreign.case import EXACT, Program
from foreign.light import SCENE

SAMPLES = 131072
# Seconds that one program may take for all its files.
LONGEST = 300
PROGRAMS = [
    Program("by hand", by_hand.files),
    Program("trimesh", meshes.trimesh_files, "trimesh"),
    Program("meshio", meshes.meshio_files, "meshio"),
    Program("plyfile", meshes.plyfile_files, "plyfile"),
    Program("pygltflib", meshes.pygltflib_files, "pygltflib"),
    Program("VTK", meshes.vtk_files, "vtk"),
    Program("PyVista", meshes.pyvista_files, "pyvista"),
    Program("Open3D", meshes.open3d_files, "open3d"),
    Program("MeshLab", meshes.pymeshlab_files, "pymeshlab"),
    Program("Gmsh", meshes.gmsh_files, "gmsh"),
    Program("numpy-stl", meshes.stl_files, "stl", "numpy-stl"),
    Program("Assimp", meshes.assimp_files, command=["assimp", "version"]),
    Program("Pillow", pictures.pillow_files, "PIL", "pillow"),
    Program("OpenCV", pictures.opencv_files, "cv2", "opencv-python-headless"),
    Program("imageio", pictures.imageio_files, "imageio"),
    Program("tifffile", pictures.tifffile_files, "tifffile"),
    Program("PyPNG", pictures.pypng_files, "png", "pypng"),
    Program("OpenEXR", pictures.openexr_files, "OpenEXR"),
    Program("ImageMagick", pictures.magick_files, command=[pictures.MAGICK, "-version"]),
    Program("Netpbm", pictures.netpbm_files, command=["pnmtopng", "-version"]),
]


def judged(phicam, case):
    """Whether a file is what it should be, what became of it, and its largest relative difference."""
    scene, out = (case.path.with_suffix(case.path.suffix + end) for end in (".toml", ".out"))
    scene.write_text(SCENE + case.surface)
    command = [phicam, "-q", "render", scene, "-o", out, "--estimator", "factored", "--samples", SAMPLES, "--replace"]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    said = " ".join(done.stderr.split())
    if case.truth is None:
        missing = [w for w in case.words if w not in said]
        return done.returncode == 2 and not missing, f"refused: {said}", None
    if done.returncode:
        return False, f"refused: {said}", None
    phi, error = np.load(out / "phi.npy"), np.load(out / "phi.stderr.npy")
    if phi.shape != case.truth.shape:
        return False, f"{phi.shape[0]} x {phi.shape[1]}", None
    apart, noise = float(np.abs(phi / case.truth - 1).max()), float((error / case.truth).max())
    is_quiet = noise < EXACT / 3
    return apart < case.allowed and is_quiet, "read" if is_quiet else f"read, noise {noise:.1e}", apart


def judge(program, args, folder):
    """Writes and renders the files of one program, a line of JSON each."""
    version = program.version()
    if version is None:
        return
    print(json.dumps({"version": version}))
    for form, write in program.files(folder):
        try:
            case = write()
        except Exception as failure:
            told = f"{type(failure).__name__}: {' '.join(str(failure).split())[:100]}"
            print(json.dumps({"form": form, "unwritten": told}))
            continue
        good, outcome, apart = judged(args.phicam, case)
        own = {"good": good, "outcome": outcome, "apart": apart, "is_read": case.truth is not None}
        print(json.dumps({"form": form, "layout": case.layout, "allowed": case.allowed, **own}), flush=True)


def of(program, args, root):
    """What a process of its own says of one program: libraries of several do not always bear each other."""
    folder = root / program.name.replace(" ", "_")
    folder.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, __file__, args.phicam, "--keep", folder, "--program", program.name]
    try:
        done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True, timeout=LONGEST)
        said, end = done.stdout, f"ended with {done.returncode}" if done.returncode else None
    except subprocess.TimeoutExpired as late:
        said, end = (late.stdout or b"").decode(), f"took more than {LONGEST} s"
    # Libraries print lines of their own.
    found = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
    return found + ([{"form": "all", "unwritten": end}] if end else [])


def compared(args, root):
    """Prints the tables; whether all is right."""
    print("| program | version | file | outcome | apart | allowed |\n| --- | --- | --- | --- | --- | --- |")
    sums, skipped, unwritten = defaultdict(lambda: [0, 0, 0.0, 0]), [], []
    asked = [p for p in PROGRAMS if not args.only or any(word.lower() in p.name.lower() for word in args.only)]
    for program in asked:
        version, *found = of(program, args, root) or [None]
        if version is None:
            skipped.append(program.name)
            continue
        version = version.get("version", "?")
        for own in found:
            if "unwritten" in own:
                unwritten.append(f"{program.name}, {own['form']}: {own['unwritten']}")
                continue
            numbers = "- | -" if own["apart"] is None else f"{own['apart']:.1e} | {own['allowed']:.0e}"
            outcome = own["outcome"] + ("" if own["good"] else " **WRONG**")
            print(f"| {program.name} | {version} | {own['layout']} | {outcome} | {numbers} |", flush=True)
            sum_of = sums[program.name, version, own["form"]]
            sum_of[0 if own["is_read"] else 1] += 1
            sum_of[2] = max(sum_of[2], own["apart"] or 0.0)
            sum_of[3] += not own["good"]
    print("\n| program | version | format | read | refused | worst difference | wrong |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for (name, version, form), (read, refused, worst, wrong) in sums.items():
        print(f"| {name} | {version} | {form} | {read} | {refused} | {f'{worst:.1e}' if read else '-'} | {wrong} |")
    print(f"\n{sum(s[0] + s[1] for s in sums.values())} files of {len({k[0] for k in sums})} programs.")
    print("Not at hand:", ", ".join(skipped) or "none")
    print("Not written:", "; ".join(unwritten) or "none")
    return bool(sums) and not any(wrong for *_, wrong in sums.values())


def main():
    parser = argparse.ArgumentParser(description="Compare the light of other programs' files with quadrature.")
    parser.add_argument("phicam", type=Path)
    parser.add_argument("--only", nargs="*", default=[], metavar="WORD")
    parser.add_argument("--keep", type=Path, metavar="FOLDER")
    parser.add_argument("--program", help=argparse.SUPPRESS)
    args = parser.parse_args()
    args.phicam = args.phicam.resolve()
    if args.program:
        return judge(next(p for p in PROGRAMS if p.name == args.program), args, args.keep)
    with tempfile.TemporaryDirectory() as temporary:
        sys.exit(0 if compared(args, args.keep or Path(temporary)) else 1)


if __name__ == "__main__":
    main()
