"""Pictures written by other programs."""

import os
import shutil

import numpy as np

from .case import EXACT, Case, run
from .light import rectangle
from .shapes import picture

# Constant blocks of 16 x 16 pixels lose little in a JPEG: grey ones nothing, colours two steps of 255.
COLOURS = 1e-2
OTHER = ("is no PNG, JPEG or OpenEXR picture", "save it as one of them")
COLOUR = ', transfer = "srgb", channel = "red"'
# Debian's name of ImageMagick 6; `convert` may be another program.
MAGICK = next((c for c in ("magick", "convert-im6.q16") if shutil.which(c)), "magick")

RANDOM = np.random.default_rng(26)
GREY8 = RANDOM.integers(20, 256, (9, 12)).astype(np.uint8)
GREY16 = RANDOM.integers(5000, 65536, (9, 12)).astype(np.uint16)
RGB8 = RANDOM.integers(20, 256, (9, 12, 3)).astype(np.uint8)
RGB16 = RANDOM.integers(5000, 65536, (9, 12, 3)).astype(np.uint16)
BLOCKS = np.kron(RANDOM.integers(40, 250, (3, 4)), np.ones((16, 16))).astype(np.uint8)
RGB_BLOCKS = np.kron(RANDOM.integers(60, 250, (3, 4, 3)), np.ones((32, 32, 1))).astype(np.uint8)
FLOATS = RANDOM.uniform(0.05, 0.95, (9, 12)).astype(np.float32)
RGB_FLOATS = RANDOM.uniform(0.05, 0.95, (9, 12, 3)).astype(np.float32)


def linear(x):
    """sRGB, IEC 61966-2-1."""
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def shown(path, layout, pixels, top=255, transfer="srgb", channel=None, allowed=EXACT):
    """Whole numbers up to `top`, rows from the top; a channel of colours."""
    values = np.asarray(pixels, float) / top
    values = linear(values) if transfer == "srgb" else values
    keys = f', transfer = "{transfer}"'
    if values.ndim == 3:
        channel = channel or "green"
        keys += f', channel = "{channel}"'
        weights = {"red": [1, 0, 0], "green": [0, 1, 0], "blue": [0, 0, 1], "luminance": [0.2126, 0.7152, 0.0722]}
        values = values[:, :, :3] @ np.array(weights[channel])
    return picture(path, layout, rectangle(values[::-1]), keys, allowed)


def refused(path, layout, *words, keys=', transfer = "srgb"'):
    """A picture that is to be refused with these words."""
    case = picture(path, layout, None, keys)
    return Case(path, layout, case.surface, None, words=words)


def pillow_files(folder):
    from PIL import Image

    def write(name, pixels, make, layout, *rest, mode=None, options=(), **keys):
        path = folder / name
        image = Image.fromarray(pixels)
        image = image.convert(mode) if mode else image
        image.save(path, **dict(options))
        return make(path, layout, *rest, **keys)

    yield "PNG", lambda: write("l.png", GREY8, shown, "PNG, grey 8", GREY8)
    yield "PNG", lambda: write("linear.png", GREY8, shown, "PNG, grey 8, linear", GREY8, transfer="linear")
    yield "PNG", lambda: write("i16.png", GREY16, shown, "PNG, grey 16", GREY16, top=65535)
    yield "PNG", lambda: write("bits.png", GREY8 > 120, shown, "PNG, grey 1", GREY8 > 120, top=1)
    yield "PNG", lambda: write("rgb.png", RGB8, shown, "PNG, RGB 8", RGB8)
    yield "PNG", lambda: write("red.png", RGB8, shown, "PNG, RGB 8, red", RGB8, channel="red")
    yield "PNG", lambda: write("y.png", RGB8, shown, "PNG, RGB 8, luminance", RGB8, channel="luminance")
    yield "PNG", lambda: write("rgba.png", RGB8, shown, "PNG, RGBA, opaque", RGB8, mode="RGBA")
    few = np.array([[20, 60, 100], [250, 90, 30], [140, 200, 170]], np.uint8)[GREY8 % 3]
    def palette():
        # Of three colours: found again by the converter, and exact.
        Image.fromarray(few).quantize(3, dither=Image.Dither.NONE).save(folder / "p.png")
        return shown(folder / "p.png", "PNG, palette", few, channel="blue")

    yield "PNG", palette
    yield "JPEG", lambda: write("l.jpg", BLOCKS, shown, "JPEG, grey", BLOCKS, options={"quality": 100})
    whole = {"quality": 100, "subsampling": 0}
    yield "JPEG", lambda: write("rgb.jpg", RGB_BLOCKS, shown, "JPEG, 4:4:4", RGB_BLOCKS, options=whole, allowed=COLOURS)
    halved = {"quality": 100, "subsampling": 2}
    yield "JPEG", lambda: write("half.jpg", RGB_BLOCKS, shown, "JPEG, 4:2:0", RGB_BLOCKS, options=halved, allowed=COLOURS)
    progressive = {**whole, "progressive": True}
    yield "JPEG", lambda: write("prog.jpg", RGB_BLOCKS, shown, "JPEG, progressive", RGB_BLOCKS, options=progressive, allowed=COLOURS)
    cure = "save it as RGB or grey"
    yield "JPEG", lambda: write("cmyk.jpg", RGB_BLOCKS, refused, "JPEG, CMYK", "CMYK", cure, mode="CMYK")
    clear = np.dstack([RGB8, np.full(RGB8.shape[:2], 128, np.uint8)])
    yield "PNG", lambda: write("clear.png", clear, refused, "PNG, RGBA, half transparent", "is not opaque", "lay it on a background", keys=COLOUR)
    for kind in ("tiff", "bmp", "gif", "webp"):
        yield kind.upper(), lambda k=kind: write(f"rgb.{k}", RGB8, refused, k.upper(), *OTHER)


def opencv_files(folder):
    os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
    import cv2

    def write(name, pixels, make, layout, *rest, options=(), **keys):
        own = pixels[:, :, ::-1] if pixels.ndim == 3 else pixels
        if not cv2.imwrite(str(folder / name), own, list(options)):
            raise RuntimeError("OpenCV did not write")
        return make(folder / name, layout, *rest, **keys)

    yield "PNG", lambda: write("l8.png", GREY8, shown, "PNG, grey 8", GREY8)
    yield "PNG", lambda: write("l16.png", GREY16, shown, "PNG, grey 16", GREY16, top=65535)
    yield "PNG", lambda: write("rgb8.png", RGB8, shown, "PNG, RGB 8", RGB8, channel="red")
    yield "PNG", lambda: write("rgb16.png", RGB16, shown, "PNG, RGB 16", RGB16, top=65535, channel="blue")
    bits = (255 * (GREY8 > 120)).astype(np.uint8)
    yield "PNG", lambda: write("1.png", bits, shown, "PNG, grey 1", bits, options=[cv2.IMWRITE_PNG_BILEVEL, 1])
    best = [cv2.IMWRITE_JPEG_QUALITY, 100]
    yield "JPEG", lambda: write("l.jpg", BLOCKS, shown, "JPEG, grey", BLOCKS, options=best)
    yield "JPEG", lambda: write("rgb.jpg", RGB_BLOCKS, shown, "JPEG, colour", RGB_BLOCKS, options=best, allowed=COLOURS)
    slow = [*best, cv2.IMWRITE_JPEG_PROGRESSIVE, 1]
    yield "JPEG", lambda: write("prog.jpg", RGB_BLOCKS, shown, "JPEG, progressive", RGB_BLOCKS, options=slow, allowed=COLOURS)
    whole = [cv2.IMWRITE_EXR_TYPE, cv2.IMWRITE_EXR_TYPE_FLOAT]
    yield "EXR", lambda: write("rgb.exr", RGB_FLOATS, floats, "EXR, float", RGB_FLOATS, options=whole)
    half = [cv2.IMWRITE_EXR_TYPE, cv2.IMWRITE_EXR_TYPE_HALF]
    rounded = RGB_FLOATS.astype(np.float16).astype(np.float32)
    yield "EXR", lambda: write("half.exr", rounded, floats, "EXR, half", rounded, options=half)
    yield "EXR", lambda: write("y.exr", FLOATS, floats, "EXR, grey", FLOATS, options=whole)
    for kind in ("tiff", "bmp"):
        yield kind.upper(), lambda k=kind: write(f"rgb.{k}", RGB8, refused, k.upper(), *OTHER)


def floats(path, layout, values, allowed=EXACT):
    """An EXR: linear, rows from the top; of colours the green."""
    keys = "" if values.ndim == 2 else ', channel = "green"'
    values = values if values.ndim == 2 else values[:, :, 1]
    return picture(path, layout, rectangle(np.asarray(values, float)[::-1]), keys, allowed)


def imageio_files(folder):
    import imageio.v3 as iio

    def write(name, pixels, make, layout, *rest, options=(), **keys):
        iio.imwrite(folder / name, pixels, **dict(options))
        return make(folder / name, layout, *rest, **keys)

    yield "PNG", lambda: write("l8.png", GREY8, shown, "PNG, grey 8", GREY8)
    yield "PNG", lambda: write("l16.png", GREY16, shown, "PNG, grey 16", GREY16, top=65535)
    yield "PNG", lambda: write("rgb.png", RGB8, shown, "PNG, RGB 8", RGB8)
    yield "JPEG", lambda: write("l.jpg", BLOCKS, shown, "JPEG, grey", BLOCKS, options={"quality": 100})
    yield "TIFF", lambda: write("l.tiff", GREY8, refused, "TIFF", *OTHER)


def tifffile_files(folder):
    import tifffile

    def write(name, layout, **options):
        tifffile.imwrite(folder / name, GREY8, **options)
        return refused(folder / name, layout, *OTHER)

    yield "TIFF", lambda: write("l.tif", "TIFF, grey 8")
    yield "TIFF", lambda: write("big.tif", "TIFF, large offsets", bigtiff=True)


def pypng_files(folder):
    import png

    def write(name, rows, make, layout, *rest, options=(), **keys):
        rows = np.asarray(rows)
        with open(folder / name, "wb") as file:
            png.Writer(rows.shape[1], rows.shape[0], **dict(options)).write(file, rows.reshape(len(rows), -1).tolist())
        return make(folder / name, layout, *rest, **keys)

    for bits in (1, 2, 4, 8, 16):
        top = 2**bits - 1
        values = (GREY16.astype(np.int64) * (top + 1)) >> 16
        for interlaced in (False, True):
            word = ", interlaced" if interlaced else ""
            options = {"greyscale": True, "bitdepth": bits, "interlace": interlaced}
            yield "PNG", lambda b=bits, o=options, v=values, t=top, i=interlaced, w=word: write(
                f"grey{b}{i}.png", v, shown, f"PNG, grey {b}{w}", v, top=t, options=o)
    for bits in (1, 2, 4, 8):
        colours = RANDOM.integers(0, 256, (2**bits, 3))
        index = RANDOM.integers(0, 2**bits, (9, 12))
        options = {"palette": colours.tolist(), "bitdepth": bits}
        yield "PNG", lambda b=bits, o=options, c=colours[index], i=index: write(
            f"palette{b}.png", i, shown, f"PNG, palette {b}", c, channel="luminance", options=o)
    for interlaced in (False, True):
        options = {"greyscale": False, "bitdepth": 16, "interlace": interlaced}
        word = ", interlaced" if interlaced else ""
        yield "PNG", lambda o=options, i=interlaced, w=word: write(
            f"rgb16{i}.png", RGB16, shown, f"PNG, RGB 16{w}", RGB16, top=65535, options=o)
    gamma = {"greyscale": True, "bitdepth": 8, "gamma": 0.45455}
    yield "PNG", lambda: write("gamma.png", GREY8, shown, "PNG, a gamma chunk", GREY8, options=gamma)
    opaque = np.dstack([GREY8, np.full(GREY8.shape, 255)])
    alpha = {"greyscale": True, "alpha": True, "bitdepth": 8}
    yield "PNG", lambda: write("la.png", opaque, shown, "PNG, grey and alpha, opaque", GREY8, options=alpha)


def openexr_files(folder):
    import OpenEXR as x

    def write(name, values, make, layout, *rest, header=(), stored=None, **keys):
        own = {"compression": x.ZIP_COMPRESSION, "type": x.scanlineimage, **dict(header)}
        x.File(own, {"Y" if values.ndim == 2 else "RGB": values if stored is None else stored}).write(str(folder / name))
        return make(folder / name, layout, *rest, **keys)

    half = FLOATS.astype(np.float16)
    rgb_half = RGB_FLOATS.astype(np.float16)
    yield "EXR", lambda: write("y.exr", FLOATS, floats, "EXR, Y float", FLOATS)
    yield "EXR", lambda: write("y16.exr", half, floats, "EXR, Y half", half)
    yield "EXR", lambda: write("rgb.exr", RGB_FLOATS, floats, "EXR, RGB float", RGB_FLOATS)
    for name in ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24"):
        header = {"compression": getattr(x, f"{name}_COMPRESSION")}
        yield "EXR", lambda n=name, h=header: write(f"{n}.exr", rgb_half, floats, f"EXR, RGB half, {n}", rgb_half, header=h)
    for name in ("B44", "B44A", "DWAA", "DWAB"):
        header = {"compression": getattr(x, f"{name}_COMPRESSION")}
        # Lossy: constant blocks of 8 x 8 half pixels keep their values nearly.
        blocks = np.kron(rgb_half[:3, :4], np.ones((8, 8, 1))).astype(np.float16)
        yield "EXR", lambda n=name, h=header, b=blocks: write(f"{n}.exr", b, floats, f"EXR, {n}", b, header=h, allowed=3e-3)

    def window(data, display, values):
        corners = lambda w: (np.array(w[:2], np.int32), np.array(w[2:], np.int32))
        header = {"dataWindow": corners(data), "displayWindow": corners(display)}
        x0, y0, x1, y1 = data
        stored = values[: y1 - y0 + 1, : x1 - x0 + 1]
        width, height = display[2] - display[0] + 1, display[3] - display[1] + 1
        whole = np.zeros((height, width))
        for j in range(height):
            for i in range(width):
                a, b = i + display[0] - x0, j + display[1] - y0
                if 0 <= a < stored.shape[1] and 0 <= b < stored.shape[0]:
                    whole[j, i] = stored[b, a]
        name = "window_" + "_".join(str(k) for k in data) + ".exr"
        return write(name, values, floats, f"EXR, data {data} of {display}", whole, header=header, stored=np.ascontiguousarray(stored))

    yield "EXR", lambda: window((2, 1, 8, 5), (0, 0, 9, 9), FLOATS)
    yield "EXR", lambda: window((-3, -2, 8, 6), (0, 0, 5, 4), FLOATS)
    yield "EXR", lambda: window((5, 5, 16, 13), (5, 5, 16, 13), FLOATS)
    tiles = {"type": x.tiledimage, "tiles": x.TileDescription()}
    yield "EXR", lambda: write("tiled.exr", FLOATS, refused, "EXR, tiled", "it is tiled", "save it in scan lines", header=tiles, keys="")

    def parts():
        header = lambda: {"compression": x.ZIP_COMPRESSION, "type": x.scanlineimage}
        both = [x.Part(header(), {"Y": FLOATS}, name) for name in ("left", "right")]
        x.File(both).write(str(folder / "parts.exr"))
        return refused(folder / "parts.exr", "EXR, two parts", "more than one part", "save the first alone", keys="")

    yield "EXR", parts


def portable(path, pixels):
    """A picture as PGM or PPM, which both programs below read."""
    pixels = np.asarray(pixels)
    kind, top = ("P5" if pixels.ndim == 2 else "P6"), 65535 if pixels.dtype == np.uint16 else 255
    head = f"{kind}\n{pixels.shape[1]} {pixels.shape[0]}\n{top}\n".encode()
    path.write_bytes(head + pixels.astype(">u2" if top > 255 else "u1").tobytes())
    return path


def magick_files(folder):
    def write(name, pixels, make, layout, *rest, options=(), **keys):
        run(MAGICK, portable(folder / (name + ".ppm"), pixels), *options, folder / name)
        return make(folder / name, layout, *rest, **keys)

    yield "PNG", lambda: write("l8.png", GREY8, shown, "PNG, grey 8", GREY8)
    yield "PNG", lambda: write("l16.png", GREY16, shown, "PNG, grey 16", GREY16, top=65535)
    yield "PNG", lambda: write("rgb.png", RGB8, shown, "PNG, RGB 8", RGB8)
    yield "PNG", lambda: write("rgb16.png", RGB16, shown, "PNG, RGB 16", RGB16, top=65535)
    turns = ["-interlace", "PNG"]
    yield "PNG", lambda: write("interlaced.png", RGB8, shown, "PNG, interlaced", RGB8, options=turns)
    best = ["-quality", "100", "-sampling-factor", "4:4:4"]
    yield "JPEG", lambda: write("l.jpg", BLOCKS, shown, "JPEG, grey", BLOCKS, options=best)
    yield "JPEG", lambda: write("rgb.jpg", RGB_BLOCKS, shown, "JPEG, colour", RGB_BLOCKS, options=best, allowed=COLOURS)
    slow = [*best, "-interlace", "JPEG"]
    yield "JPEG", lambda: write("prog.jpg", RGB_BLOCKS, shown, "JPEG, progressive", RGB_BLOCKS, options=slow, allowed=COLOURS)
    for kind in ("tiff", "bmp", "gif", "webp"):
        yield kind.upper(), lambda k=kind: write(f"rgb.{k}", RGB8, refused, k.upper(), *OTHER)


def netpbm_files(folder):
    def write(tool, name, pixels, make, layout, *rest, options=(), **keys):
        with open(portable(folder / (name + ".ppm"), pixels), "rb") as source:
            (folder / name).write_bytes(run(tool, *options, stdin=source))
        return make(folder / name, layout, *rest, **keys)

    yield "PNG", lambda: write("pnmtopng", "l8.png", GREY8, shown, "PNG, grey 8", GREY8)
    yield "PNG", lambda: write("pnmtopng", "l16.png", GREY16, shown, "PNG, grey 16", GREY16, top=65535)
    yield "PNG", lambda: write("pnmtopng", "rgb.png", RGB8, shown, "PNG, palette or RGB", RGB8)
    yield "PNG", lambda: write("pnmtopng", "i.png", RGB8, shown, "PNG, interlaced", RGB8, options=["-interlace"])
    best = ["-quality=100", "-sample=1x1"]
    yield "JPEG", lambda: write("pnmtojpeg", "l.jpg", BLOCKS, shown, "JPEG, grey", BLOCKS, options=best)
    yield "JPEG", lambda: write("pnmtojpeg", "rgb.jpg", RGB_BLOCKS, shown, "JPEG, colour", RGB_BLOCKS, options=best, allowed=COLOURS)
    slow = [*best, "-progressive"]
    yield "JPEG", lambda: write("pnmtojpeg", "p.jpg", RGB_BLOCKS, shown, "JPEG, progressive", RGB_BLOCKS, options=slow, allowed=COLOURS)
