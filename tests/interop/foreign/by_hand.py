"""Layouts that the formats allow and few programs write."""

import base64
import json
import struct
import zlib

import numpy as np

from .shapes import BOARD, CELLS, LETTER, SHEET, plain, refused, textured


def lines(head, rows):
    return "".join(f"{head} {' '.join(repr(float(x)) for x in row)}\n" for row in rows)


def obj(shape, corner, uv=True):
    """An OBJ whose corners are what `corner` makes of an index from 1."""
    text = lines("v", shape.positions) + (lines("vt", shape.uv) if uv else "")
    return text + "".join("f " + " ".join(corner(k + 1) for k in face) + "\n" for face in shape.faces)


def png(levels):
    """Grey of 8 bits, rows from the top."""
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(int(x) for x in row) for row in levels)
    head = struct.pack(">IIBBBBB", len(levels[0]), len(levels), 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def files(folder):
    """Pairs of a layout and what writes it."""

    def text(name, content, make, layout, *rest, **keys):
        path = folder / name
        path.write_text(content) if isinstance(content, str) else path.write_bytes(content)
        return make(path, layout, *rest, **keys)

    n = len(SHEET.positions)
    yield "OBJ", lambda: text("plain.obj", obj(SHEET, lambda k: f"{k}", False), plain, "OBJ, f v")
    yield "OBJ", lambda: text("vt.obj", obj(SHEET, lambda k: f"{k}/{k}"), textured, "OBJ, f v/vt")
    back = obj(SHEET, lambda k: f"{k - n - 1}/{k - n - 1}")
    yield "OBJ", lambda: text("negative.obj", back, textured, "OBJ, negative indices")
    quads = obj(BOARD, lambda k: f"{k}/{k}")
    yield "OBJ", lambda: text("quads.obj", quads, textured, "OBJ, quadrilaterals", BOARD)
    faces = [x for x in obj(SHEET, lambda k: f"{k}/{k}").splitlines(True) if x.startswith("f")]
    first = "".join(faces) + lines("v", SHEET.positions) + lines("vt", SHEET.uv)
    yield "OBJ", lambda: text("early.obj", first, textured, "OBJ, faces before vertices")
    joined = obj(SHEET, lambda k: f"{k}/{k} \\\n ").replace("\n\n", "\n").replace("\n", "\r\n")
    yield "OBJ", lambda: text("joined.obj", joined, textured, "OBJ, lines that go on, CR LF")
    for k in range(7):
        corners = " ".join(str((k + j) % 7 + 1) for j in range(7))
        content = lines("v", LETTER.positions) + f"f {corners}\n"
        yield "OBJ", lambda k=k, content=content: text(f"m{k}.obj", content, plain, f"OBJ, an M from corner {k}", LETTER)
    flipped = obj(SHEET, lambda k: f"{k}/{k}").splitlines(True)
    flipped = "".join("f " + " ".join(reversed(x.split()[1:])) + "\n" if x.startswith("f") else x for x in flipped)
    yield "OBJ", lambda: text("flipped.obj", flipped, textured, "OBJ, wound the other way, flip", more=", flip = true")
    tiled = obj(SHEET, lambda k: f"{k}/{k}").splitlines(True)
    far = 2.5 * SHEET.uv - 0.25
    tiled = "".join(x for x in tiled if not x.startswith("vt")) + lines("vt", far)
    levels = np.round(255 * CELLS)
    (folder / "tile.png").write_bytes(png(levels[::-1]))
    tile, tiles = '{ image = "tile.png", transfer = "linear", wrap = "repeat" }', SHEET.truth(levels / 255, True, far)
    yield "OBJ", lambda: text(
        "tiles.obj", tiled, textured, "OBJ, coordinates over several tiles", texture=tile, truth=tiles, elements='"faces"'
    )
    crossed = lines("v", BOARD.positions[[0, 6, 1, 5]]) + "f 1 2 3 4\n"
    yield "OBJ", lambda: text("crossed.obj", crossed, refused, "OBJ, a bow tie", "line 5", "cross", "divide")
    yield "OBJ", lambda: text("short.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", refused, "OBJ, no such vertex", "line 4")
    for kind, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        head = f"ply\nformat {kind} 1.0\nelement face {len(SHEET.faces)}\nproperty list ushort uint vertex_index\n"
        head += f"element vertex {n}\nproperty double z\nproperty uchar red\nproperty double x\nproperty double y\n"
        body = b"".join(struct.pack(order + "H3I", 3, *f) for f in SHEET.faces)
        body += b"".join(struct.pack(order + "dBdd", p[2], 9, p[0], p[1]) for p in SHEET.positions)
        content = head.encode() + b"end_header\n" + body
        yield "PLY", lambda k=kind, c=content: text(f"early_{k}.ply", c, plain, f"PLY, {k}, faces first, z before x")
    yield from gltf_files(text)


def gltf_files(text):
    """Buffers, indices and nodes of glTF."""
    positions = SHEET.positions.astype("<f4").tobytes()
    uv = np.stack([SHEET.uv[:, 0], 1 - SHEET.uv[:, 1]], axis=1).astype("<f4")
    triangles = np.array(SHEET.faces)

    def document(views, accessors, attributes, mode=4, indices=True, node=None, **more):
        blob, list_of_views = b"", []
        for data, extra in views:
            list_of_views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data), **extra})
            blob += data + bytes(-len(data) % 4)
        primitive = {"attributes": attributes, "mode": mode} | ({"indices": len(accessors) - 1} if indices else {})
        uri = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
        root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, **(node or {})}]}
        root |= {"meshes": [{"primitives": [primitive]}], "bufferViews": list_of_views, "accessors": accessors}
        return json.dumps(root | {"buffers": [{"byteLength": len(blob), "uri": uri}]} | more)

    def accessor(view, kind, count, component, **more):
        return {"bufferView": view, "type": kind, "count": count, "componentType": component, **more}

    n, k = len(SHEET.positions), triangles.size
    place, corner = accessor(0, "VEC3", n, 5126), accessor(1, "VEC2", n, 5126)
    both = {"POSITION": 0, "TEXCOORD_0": 1}
    for name, size, component in (("u1", 1, 5121), ("u2", 2, 5123), ("u4", 4, 5125)):
        content = document(
            [(positions, {}), (uv.tobytes(), {}), (triangles.astype(f"<u{size}").tobytes(), {})],
            [place, corner, accessor(2, "SCALAR", k, component)], both)
        yield "glTF", lambda c=content, s=name: text(f"{s}.gltf", c, textured, f"glTF, indices of {s}, data URI")
    woven = np.concatenate([SHEET.positions.astype("<f4"), uv], axis=1).astype("<f4").tobytes()
    content = document(
        [(woven, {"byteStride": 20}), (triangles.astype("<u2").tobytes(), {})],
        [place, accessor(0, "VEC2", n, 5126, byteOffset=12), accessor(1, "SCALAR", k, 5123)], both)
    yield "glTF", lambda c=content: text("woven.gltf", c, textured, "glTF, interleaved")
    unrolled = [SHEET.positions[triangles].astype("<f4").tobytes(), uv[triangles].tobytes()]
    content = document([(d, {}) for d in unrolled], [{**place, "count": k}, {**corner, "count": k}], both, indices=False)
    yield "glTF", lambda c=content: text("unrolled.gltf", c, textured, "glTF, without indices")
    # Coordinates as whole numbers of 16 bits: SHEET's own, rounded.
    whole = np.round(uv * 65535).astype("<u2")
    rounded = np.stack([whole[:, 0] / 65535, 1 - whole[:, 1] / 65535], axis=1)
    content = document(
        [(positions, {}), (whole.tobytes(), {}), (triangles.astype("<u2").tobytes(), {})],
        [place, accessor(1, "VEC2", n, 5123, normalized=True), accessor(2, "SCALAR", k, 5123)], both)
    truth = SHEET.truth(CELLS, uv=rounded)
    yield "glTF", lambda c=content: text("whole.gltf", c, textured, "glTF, normalised u16 coordinates", truth=truth)
    # A strip of the first row of quadrilaterals, and a fan of one.
    for mode, name, run in ((5, "strip", [7, 0, 8, 1, 9, 2]), (6, "fan", [0, 1, 8, 7])):
        content = document(
            [(positions, {}), (np.array(run, "<u2").tobytes(), {})],
            [place, accessor(1, "SCALAR", len(run), 5123)], {"POSITION": 0}, mode)
        faces = [[7, 0, 8], [0, 1, 8], [8, 1, 9], [1, 2, 9]] if mode == 5 else [[0, 1, 8], [0, 8, 7]]
        part = type(SHEET)(SHEET.positions, faces)
        yield "glTF", lambda c=content, s=name, p=part: text(f"{s}.gltf", c, plain, f"glTF, a {s}", p)
    # A node's rotation by 90 degrees about z, scale and translation, undone in the positions.
    moved = ((SHEET.positions - [1, 2, 3]) / 2)[:, [1, 0, 2]] * [1, -1, 1]
    node = {"translation": [1, 2, 3], "scale": [2, 2, 2], "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)]}
    matrix = {"matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]}
    mirror = {"scale": [-1, 1, 1]}
    for name, own, points in (("trs", node, moved), ("matrix", matrix, moved), ("mirror", mirror, SHEET.positions * [-1, 1, 1])):
        # With a mirror the front is where the corners run clockwise.
        index = triangles[:, ::-1] if name == "mirror" else triangles
        content = document(
            [(points.astype("<f4").tobytes(), {}), (uv.tobytes(), {}), (index.astype("<u2").tobytes(), {})],
            [place, corner, accessor(2, "SCALAR", k, 5123)], both, node=own)
        yield "glTF", lambda c=content, s=name: text(f"{s}.gltf", c, textured, f"glTF, a node with {s}")
    wrong = SHEET.positions.copy()
    wrong[[3, 20]] += 1.0
    content = document(
        [(wrong.astype("<f4").tobytes(), {}), (uv.tobytes(), {}), (np.array([3, 20], "<u2").tobytes(), {}),
         (SHEET.positions[[3, 20]].astype("<f4").tobytes(), {}), (triangles.astype("<u2").tobytes(), {})],
        [{**place, "sparse": {"count": 2, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}}},
         corner, accessor(4, "SCALAR", k, 5123)], both)
    yield "glTF", lambda: text("sparse.gltf", content, textured, "glTF, sparse positions")
    draco = document([(positions, {})], [place], {"POSITION": 0}, indices=False, extensionsRequired=["KHR_draco_mesh_compression"])
    yield "glTF", lambda: text("draco.gltf", draco, refused, "glTF, Draco", "KHR_draco_mesh_compression", "export the mesh without it")
    morph = document([(positions, {})], [place], {"POSITION": 0}, indices=False).replace('"2.0"', '"1.0"')
    yield "glTF", lambda: text("old.gltf", morph, refused, "glTF 1.0", "version `1.0`", "as glTF 2.0")
