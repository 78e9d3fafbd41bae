"""Writes the small picture files that the readers of photographs are tested with, by other programs than phicam.

usage: python make_files.py          in a Python with numpy, scipy, Pillow, tifffile, imagecodecs and h5py

Sample (row, column, channel, page) is (37·row + 101·column + 11·channel + 5·page) mod 251, times the step that the name of the file says
(s1, s257, ...). All pictures are of 5 rows × 7 columns unless they say otherwise.
"""

from pathlib import Path

import h5py
import numpy as np
import tifffile
from PIL import Image
from scipy.io import savemat

here = Path(__file__).parent


def values(channels=1, pages=1, rows=5, columns=7):
    p, r, c, k = np.ogrid[:pages, :rows, :columns, :channels]
    return (37 * r + 101 * c + 11 * k + 5 * p) % 251


grey, colour, stack = values()[0, :, :, 0], values(3)[0], values(1, 3)[..., 0]
write = lambda name, data, **how: tifffile.imwrite(here / name, data, metadata=None, software=False, **how)
write("grey8-s1-strips-lzw.tif", grey.astype("u1"), rowsperstrip=2, compression="lzw")
write("grey16-s257-big-endian.tif", (257 * grey).astype("u2"), byteorder=">")
big = values(1, 1, 20, 37)[0, :, :, 0]
write("grey16-s257-20x37-tiles-deflate.tif", (257 * big).astype("u2"), tile=(16, 16), compression="zlib", predictor=True)
write("grey32-s16777259.tif", (16777259 * grey).astype("u4"))
write("float32-s0.25-packbits.tif", (0.25 * grey).astype("f4"), compression="packbits")
write("colour16-s257-planar.tif", np.moveaxis((257 * colour).astype("u2"), 2, 0), photometric="rgb", planarconfig="separate")
write("colour8-s1.tif", colour.astype("u1"), photometric="rgb")
planes = lambda rows, columns: np.moveaxis(values(3, 1, rows, columns)[0].astype("u1"), 2, 0)
apart = {"photometric": "rgb", "planarconfig": "separate", "tile": (16, 16)}
write("colour8-s1-32x48-tiled-planes.tif", planes(32, 48), compression="zlib", **apart)
write("tiled-planes-cut.tif", planes(5, 7), **apart)
# Whole, as tifffile reads it, and its LZW stream ends otherwise than the crate expects.
write("tiled-lzw.tif", values(1, 1, 17, 17)[0, :, :, 0].astype("u1"), tile=(16, 16), compression="lzw", predictor=True)
write("pages8-s1-3.tif", stack.astype("u1"), photometric="minisblack")
write("grey8-s1-turned-6.tif", np.rot90(grey).astype("u1"), extratags=[(274, 3, 1, 6, True)])
write("white-is-zero.tif", grey.astype("u1"), photometric="miniswhite")
write("alpha.tif", values(4)[0].astype("u1"), photometric="rgb", extrasamples=["unassalpha"])
# Stored so that the noted orientation turns it upright: Pillow's own transposition undone.
undo = {1: None, 2: 0, 3: 3, 4: 1, 5: 5, 6: 2, 7: 6, 8: 4}
for code, how in undo.items():
    upright = Image.fromarray(grey.astype("u1"))
    stored = upright if how is None else upright.transpose(Image.Transpose(how))
    exif = Image.Exif()
    exif[274] = code
    stored.save(here / f"grey8-s1-turned-{code}.png", exif=exif)
    from PIL import ImageOps

    again = ImageOps.exif_transpose(Image.open(here / f"grey8-s1-turned-{code}.png"))
    assert np.array_equal(np.asarray(again), grey), code
exif = Image.Exif()
exif[274] = 6
flat = np.full((16, 8), 40, "u1")
flat[:8] = 200
Image.fromarray(flat).transpose(Image.Transpose.ROTATE_90).save(here / "halves-turned-6.jpg", exif=exif, quality=95)
four = {"frames": stack.astype("u2"), "picture": colour.astype("f8"), "name": "some words"}
savemat(here / "stack-v6.mat", four, do_compression=False)
savemat(here / "stack-v7.mat", four, do_compression=True)
savemat(here / "one-v7.mat", {"photo": (3 - grey).astype("i2")}, do_compression=True)
savemat(here / "complex-v7.mat", {"photo": grey * 1j}, do_compression=True)
with h5py.File(here / "stack-v73.mat", "w", userblock_size=512) as file:
    file["photo"] = grey
with open(here / "stack-v73.mat", "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
np.save(here / "stack-i2-fortran.npy", np.asfortranarray((stack - 100).astype(">i2")))
np.save(here / "stack-u1.npy", stack.astype("u1"))
np.save(here / "colour-f4.npy", (0.25 * colour).astype("f4"))
