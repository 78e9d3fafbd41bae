"""Writes the MAT-files of version 7.3 that their reader is tested with, by h5py and hdf5storage, laid out as MATLAB does; and the same
arrays as version 5, by SciPy.

usage: python make_mat73.py          in a Python with numpy, scipy, h5py and hdf5storage

Values as in make_files.py: element (row, column, page) is (37·row + 101·column + 5·page) mod 251.
"""

from pathlib import Path

import h5py
import hdf5storage
import numpy as np
from scipy.io import savemat

here = Path(__file__).parent
HEADER = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\0\2IM"


def values(rows=5, columns=7, pages=1):
    r, c, p = np.ogrid[:rows, :columns, :pages]
    return (37 * r + 101 * c + 5 * p) % 251


def named(item, name, **more):
    item.attrs["MATLAB_class"] = np.bytes_(name)
    for key, value in more.items():
        item.attrs[f"MATLAB_{key}"] = value
    return item


def put(file, name, array, kind, dtype=None, **how):
    """A variable: MATLAB's first index runs fastest, HDF5's last one."""
    data = file.create_dataset(name, data=np.ascontiguousarray(array.T), dtype=dtype, **how)
    return named(data, kind, **({"int_decode": np.int32(1)} if kind in ("logical", "char") else {}))


def save(name, fill, **how):
    with h5py.File(here / name, "w", userblock_size=512, **how) as file:
        fill(file)
    with open(here / name, "r+b") as file:
        file.write(HEADER)


grey, frames = values()[..., 0], values(pages=3)
types = {
    "double": ("double", grey * 0.37),
    "single": ("single", (grey * 0.25).astype("f4")),
    "logical": ("logical", grey > 100),
    "frames": ("uint16", (257 * frames).astype("u2")),
}
for bits in (8, 16, 32, 64):
    types[f"int{bits}"] = (f"int{bits}", (grey - 125).astype(f"i{bits // 8}"))
    types[f"uint{bits}"] = (f"uint{bits}", grey.astype(f"u{bits // 8}"))
savemat(here / "types-v7.mat", {name: array for name, (_, array) in types.items()}, do_compression=True)


def plain(file):
    for name, (kind, array) in types.items():
        put(file, name, array, kind, dtype="u1" if kind == "logical" else None)


def packed(file):
    put(file, "double", types["double"][1], "double", chunks=(7, 5), compression=3)
    put(file, "single", types["single"][1], "single", chunks=(3, 2))
    put(file, "frames", types["frames"][1], "uint16", chunks=(2, 4, 3), compression=3, shuffle=True)
    put(file, "logical", types["logical"][1], "logical", dtype="u1", chunks=(4, 5), compression=9, shuffle=True, fletcher32=True)
    put(file, "int16", types["int16"][1], "int16", dtype=">i2", chunks=(7, 5))


def others(file):
    pair = np.zeros((7, 5), [("real", "f8"), ("imag", "f8")])
    named(file.create_dataset("complex", data=pair), "double")
    named(file.create_group("struct"), "struct")["x"] = 1.0
    named(file.create_group("sparse"), "double", sparse=np.uint64(5))["jc"] = np.arange(3, dtype="u8")
    target = file.create_group("#refs#").create_dataset("a", data=np.zeros((1, 1)))
    cell = file.create_dataset("cell", (1, 1), dtype=h5py.ref_dtype)
    cell[0, 0] = target.ref
    named(cell, "cell")
    put(file, "char", np.frombuffer("words".encode("utf-16le"), "u2")[None], "char")
    named(file.create_dataset("empty", data=np.array([0, 3], "u8")), "double", empty=np.uint8(1))
    file.create_dataset("unnamed", data=grey.T)
    file["elsewhere"] = h5py.SoftLink("/struct/x")
    put(file, "lzf", grey.astype("u1"), "uint8", chunks=(7, 5), compression="lzf")
    sparse = file.create_dataset("unwritten", (7, 5), "u1", chunks=(3, 3))
    sparse[:3, :3] = 1
    named(sparse, "uint8")


save("types-v73.mat", plain)
save("packed-v73.mat", packed)
save("others-v73.mat", others)
save("tree-v73.mat", lambda file: put(file, "photo", values(20, 37)[..., 0].astype("u1"), "uint8", chunks=(3, 3)))
save("later-v73.mat", lambda file: put(file, "photo", grey.astype("f8"), "double"), libver="latest")
(here / "python-v73.mat").unlink(missing_ok=True)
options = hdf5storage.Options(matlab_compatible=True, compress_size_threshold=0)
hdf5storage.write({"photo": frames.astype("u2")}, filename=str(here / "python-v73.mat"), options=options)
