"""Meshes written by other programs."""

import numpy as np

from .case import run
from .shapes import BOARD, CELLS, SHEET, plain, refused, textured

UNKNOWN = ("ends in none of .ply, .obj, .gltf and .glb", "to one of these formats")


def trimesh_files(folder):
    import trimesh

    def bare(shape=SHEET):
        return trimesh.Trimesh(shape.positions, shape.triangles, process=False)

    def painted():
        mesh = bare()
        mesh.visual = trimesh.visual.TextureVisuals(uv=SHEET.uv, material=trimesh.visual.material.SimpleMaterial())
        return mesh

    def write(name, mesh, make, layout, *rest, **options):
        path = folder / name
        mesh.export(str(path), **options)
        return make(path, layout, *rest)

    for encoding in ("ascii", "binary"):
        yield "PLY", lambda e=encoding: write(f"{e}.ply", bare(), plain, f"PLY, {e}", encoding=e)
        yield "PLY", lambda e=encoding: write(f"uv_{e}.ply", painted(), textured, f"PLY, {e}, s t", encoding=e)
    coloured = bare()
    coloured.visual.face_colors = [200, 10, 30, 255]
    yield "PLY", lambda: write("colours.ply", coloured, plain, "PLY, colours of faces")
    yield "PLY", lambda: write("normals.ply", bare(), plain, "PLY, normals", vertex_normal=True)
    yield "OBJ", lambda: write("plain.obj", bare(), plain, "OBJ")
    yield "OBJ", lambda: write("uv.obj", painted(), textured, "OBJ, vt and a .mtl")
    yield "OBJ", lambda: write("normals.obj", painted(), textured, "OBJ, vt and vn", include_normals=True)
    yield "glTF", lambda: write("plain.glb", bare(), plain, "GLB")
    yield "glTF", lambda: write("uv.glb", painted(), textured, "GLB, coordinates")

    def apart(make):
        scene = trimesh.Scene()
        for k, part in enumerate(np.array_split(np.arange(len(SHEET.triangles)), 3)):
            mesh = trimesh.Trimesh(SHEET.positions, SHEET.triangles[part], process=False)
            place = trimesh.transformations.rotation_matrix(0.3 + k, [1, 2, 3], [4, 5, 6])
            mesh.apply_transform(np.linalg.inv(place))
            scene.add_geometry(mesh, transform=place)
        return make(scene)

    yield "glTF", lambda: apart(lambda s: write("scene.glb", s, plain, "GLB, three nodes, each turned"))

    def folder_of(name):
        for file, content in trimesh.exchange.gltf.export_gltf(trimesh.Scene([painted()])).items():
            (folder / (name if file.endswith(".gltf") else file)).write_bytes(content)
        return textured(folder / name, "glTF, buffers beside it")

    yield "glTF", lambda: folder_of("uv.gltf")
    for kind in ("stl", "off"):
        yield kind.upper(), lambda k=kind: write(f"plain.{k}", bare(), refused, k.upper(), *UNKNOWN)


def meshio_files(folder):
    import meshio

    def write(name, shape, make, layout, *rest, data=None, **options):
        path, kinds = folder / name, {3: "triangle", 4: "quad"}
        cells = [(kinds[len(shape.faces[0])], np.array(shape.faces))]
        meshio.Mesh(shape.positions, cells, point_data=data).write(path, **options)
        return make(path, layout, *rest)

    st = {"s": SHEET.uv[:, 0], "t": SHEET.uv[:, 1]}
    for binary in (False, True):
        word = "binary" if binary else "ascii"
        yield "PLY", lambda b=binary, w=word: write(f"{w}.ply", SHEET, plain, f"PLY, {w}, double", binary=b)
        yield "PLY", lambda b=binary, w=word: write(f"uv_{w}.ply", SHEET, textured, f"PLY, {w}, s t", data=st, binary=b)
        yield "PLY", lambda b=binary, w=word: write(f"quads_{w}.ply", BOARD, plain, f"PLY, {w}, quadrilaterals", BOARD, binary=b)
    yield "OBJ", lambda: write("plain.obj", SHEET, plain, "OBJ")
    yield "OBJ", lambda: write("uv.obj", SHEET, plain, "OBJ, vt that no face names", data={"obj:vt": SHEET.uv})
    for kind in ("stl", "off", "vtu"):
        yield kind.upper(), lambda k=kind: write(f"plain.{k}", SHEET, refused, k.upper(), *UNKNOWN)


def plyfile_files(folder):
    from plyfile import PlyData, PlyElement

    def write(name, make, layout, *rest, number="f4", index="i4", length="u1", uv=(), corners=False, strips=False, **options):
        columns = [(c, number) for c in ("x", "y", "z", *uv)]
        vertices = np.empty(len(SHEET.positions), columns)
        for c, values in zip(("x", "y", "z", *uv), np.concatenate([SHEET.positions, SHEET.uv], axis=1).T):
            vertices[c] = values
        lists = [("vertex_indices", index, (3,))] + ([("texcoord", "f4", (6,))] if corners else [])
        faces = np.empty(len(SHEET.faces), lists)
        faces["vertex_indices"] = SHEET.faces
        if corners:
            faces["texcoord"] = SHEET.uv[SHEET.triangles].reshape(-1, 6)
        lengths = {"vertex_indices": length, "texcoord": "u1"}
        kind = PlyElement.describe(faces, "tristrips" if strips else "face", len_types=lengths)
        elements = [PlyElement.describe(vertices, "vertex"), kind]
        PlyData(elements, comments=["of plyfile"], **options).write(folder / name)
        return make(folder / name, layout, *rest)

    for word, options in {"ascii": {"text": True}, "little": {"byte_order": "<"}, "big": {"byte_order": ">"}}.items():
        for number in ("f4", "f8"):
            name = f"{word}_{number}.ply"
            yield "PLY", lambda n=name, o=options, w=word, t=number: write(n, plain, f"PLY, {w}, {t}", number=t, **o)
        for pair in (("s", "t"), ("u", "v"), ("texture_u", "texture_v")):
            name = f"{word}_{pair[0]}.ply"
            yield "PLY", lambda n=name, o=options, w=word, p=pair: write(n, textured, f"PLY, {w}, {p[0]} {p[1]}", uv=p, **o)
        name = f"{word}_corners.ply"
        yield "PLY", lambda n=name, o=options, w=word: write(n, textured, f"PLY, {w}, texcoord of faces", corners=True, **o)
    yield "PLY", lambda: write("indices.ply", plain, "PLY, u4 indices, u4 lengths", index="u4", length="u4")
    yield "PLY", lambda: write("small.ply", plain, "PLY, i1 indices, u2 lengths", index="i1", length="u2")
    yield "PLY", lambda: write("strips.ply", refused, "PLY, strips", "strips or fans", "export the mesh as faces", strips=True)


def pygltflib_files(folder):
    import pygltflib as g

    def write(name, layout):
        points, index = SHEET.positions.astype("<f4"), SHEET.triangles.astype("<u2")
        uv = np.stack([SHEET.uv[:, 0], 1 - SHEET.uv[:, 1]], axis=1).astype("<f4")
        parts = [index.tobytes(), points.tobytes(), uv.tobytes()]
        starts = np.cumsum([0] + [len(p) for p in parts])
        root = g.GLTF2(
            scene=0, scenes=[g.Scene(nodes=[0])], nodes=[g.Node(mesh=0)],
            meshes=[g.Mesh(primitives=[g.Primitive(attributes=g.Attributes(POSITION=1, TEXCOORD_0=2), indices=0, material=0)])],
            materials=[g.Material()], buffers=[g.Buffer(byteLength=int(starts[-1]))],
            accessors=[
                g.Accessor(bufferView=0, componentType=g.UNSIGNED_SHORT, count=index.size, type=g.SCALAR),
                g.Accessor(bufferView=1, componentType=g.FLOAT, count=len(points), type=g.VEC3),
                g.Accessor(bufferView=2, componentType=g.FLOAT, count=len(uv), type=g.VEC2),
            ],
            bufferViews=[g.BufferView(buffer=0, byteOffset=int(s), byteLength=len(p)) for s, p in zip(starts, parts)],
        )
        root.set_binary_blob(b"".join(parts))
        if name.endswith(".gltf"):
            root.save(str(folder / "source.glb"))
            root = g.GLTF2().load(str(folder / "source.glb"))
            root.convert_buffers(g.BufferFormat.DATAURI if "data URI" in layout else g.BufferFormat.BINFILE)
        root.save(str(folder / name))
        return textured(folder / name, layout)

    yield "glTF", lambda: write("uv.glb", "GLB")
    yield "glTF", lambda: write("inline.gltf", "glTF, data URI")
    yield "glTF", lambda: write("beside.gltf", "glTF, a buffer beside it")


def vtk_files(folder):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    def body(uv=True):
        data, points, faces = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
        points.SetData(numpy_to_vtk(SHEET.positions, deep=True))
        for face in SHEET.faces:
            faces.InsertNextCell(3, face)
        data.SetPoints(points)
        data.SetPolys(faces)
        if uv:
            coordinates = numpy_to_vtk(SHEET.uv.astype(np.float32), deep=True)
            coordinates.SetName("TCoords")
            data.GetPointData().SetTCoords(coordinates)
        return data

    def write(writer, name, make, layout, *rest, uv=True, setup=None):
        writer.SetFileName(str(folder / name))
        writer.SetInputData(body(uv))
        if setup:
            setup(writer)
        writer.Write()
        return make(folder / name, layout, *rest)

    for word, order in (("little", "SetDataByteOrderToLittleEndian"), ("big", "SetDataByteOrderToBigEndian")):
        setup = lambda w, o=order: (w.SetFileTypeToBinary(), getattr(w, o)(), w.SetTextureCoordinatesNameToTextureUV())
        yield "PLY", lambda w=word, s=setup: write(vtk.vtkPLYWriter(), f"{w}.ply", textured, f"PLY, {w}", setup=s)
    yield "PLY", lambda: write(vtk.vtkPLYWriter(), "ascii.ply", textured, "PLY, ascii", setup=lambda w: w.SetFileTypeToASCII())
    yield "OBJ", lambda: write(vtk.vtkOBJWriter(), "plain.obj", plain, "OBJ", uv=False)
    yield "OBJ", lambda: write(vtk.vtkOBJWriter(), "uv.obj", textured, "OBJ, vt")

    def gltf(name, layout):
        blocks = vtk.vtkMultiBlockDataSet()
        building = vtk.vtkMultiBlockDataSet()
        building.SetBlock(0, body())
        blocks.SetBlock(0, building)
        writer = vtk.vtkGLTFWriter()
        writer.SetFileName(str(folder / name))
        writer.SetInputDataObject(blocks)
        writer.SetSaveTextures(False)
        writer.Write()
        return plain(folder / name, layout)

    yield "glTF", lambda: gltf("vtk.gltf", "glTF, double strides")
    yield "STL", lambda: write(vtk.vtkSTLWriter(), "plain.stl", refused, "STL", *UNKNOWN)


def pyvista_files(folder):
    import pyvista

    def write(name, make, layout, *rest, **options):
        data = pyvista.PolyData.from_regular_faces(SHEET.positions, SHEET.triangles)
        data.active_texture_coordinates = SHEET.uv.astype(np.float32)
        data.save(folder / name, **options)
        return make(folder / name, layout, *rest)

    for binary in (False, True):
        word = "binary" if binary else "ascii"
        yield "PLY", lambda b=binary, w=word: write(f"{w}.ply", textured, f"PLY, {w}", binary=b)
    yield "OBJ", lambda: write("uv.obj", textured, "OBJ")
    yield "STL", lambda: write("plain.stl", refused, "STL", *UNKNOWN)


def open3d_files(folder):
    import open3d as o

    def body(uv=False, normals=False):
        mesh = o.geometry.TriangleMesh(o.utility.Vector3dVector(SHEET.positions), o.utility.Vector3iVector(SHEET.triangles))
        if uv:
            mesh.triangle_uvs = o.utility.Vector2dVector(SHEET.uv[SHEET.triangles].reshape(-1, 2))
        if normals:
            mesh.compute_vertex_normals()
        return mesh

    def write(name, mesh, make, layout, *rest, **options):
        if not o.io.write_triangle_mesh(str(folder / name), mesh, **options):
            raise RuntimeError("open3d did not write")
        return make(folder / name, layout, *rest)

    for ascii in (False, True):
        word = "ascii" if ascii else "binary"
        yield "PLY", lambda a=ascii, w=word: write(f"{w}.ply", body(normals=True), plain, f"PLY, {w}", write_ascii=a)
    yield "OBJ", lambda: write("plain.obj", body(), plain, "OBJ")
    yield "OBJ", lambda: write("uv.obj", body(True), textured, "OBJ, vt and a .mtl")
    for kind in ("glb", "gltf"):
        yield "glTF", lambda k=kind: write(f"plain.{k}", body(), plain, k)
        yield "glTF", lambda k=kind: write(f"normals.{k}", body(normals=True), plain, f"{k}, normals")
    for kind in ("stl", "off"):
        yield kind.upper(), lambda k=kind: write(f"plain.{k}", body(normals=True), refused, k.upper(), *UNKNOWN)


def pymeshlab_files(folder):
    import pymeshlab

    def write(name, make, layout, *rest, wedge=False, vertex=False, **options):
        own = {"v_tex_coords_matrix": SHEET.uv} if vertex else {}
        own |= {"w_tex_coords_matrix": SHEET.uv[SHEET.triangles].reshape(-1, 2)} if wedge else {}
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(SHEET.positions, SHEET.triangles, **own))
        meshes.save_current_mesh(str(folder / name), **options)
        return make(folder / name, layout, *rest)

    for binary in (False, True):
        word = "binary" if binary else "ascii"
        yield "PLY", lambda b=binary, w=word: write(f"{w}.ply", plain, f"PLY, {w}", binary=b)
        yield "PLY", lambda b=binary, w=word: write(
            f"wedge_{w}.ply", textured, f"PLY, {w}, texcoord of faces", wedge=True, binary=b, save_wedge_texcoord=True)
        yield "PLY", lambda b=binary, w=word: write(
            f"vertex_{w}.ply", textured, f"PLY, {w}, coordinates of vertices", vertex=True, binary=b, save_vertex_coord=True)
    yield "OBJ", lambda: write("plain.obj", plain, "OBJ")
    yield "OBJ", lambda: write("wedge.obj", textured, "OBJ, vt and a .mtl", wedge=True, save_wedge_texcoord=True)
    for kind in ("stl", "off", "dae", "x3d"):
        yield kind.upper(), lambda k=kind: write(f"plain.{k}", refused, k.upper(), *UNKNOWN)


def gmsh_files(folder):
    import gmsh

    def write(name, make, layout, *rest):
        gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        surface = gmsh.model.addDiscreteEntity(2)
        tags = np.arange(1, len(SHEET.positions) + 1)
        gmsh.model.mesh.addNodes(2, surface, tags, SHEET.positions.ravel())
        gmsh.model.mesh.addElementsByType(surface, 2, [], (SHEET.triangles + 1).ravel())
        gmsh.write(str(folder / name))
        gmsh.finalize()
        return make(folder / name, layout, *rest)

    yield "PLY2", lambda: write("plain.ply2", refused, "PLY2", *UNKNOWN)
    yield "STL", lambda: write("plain.stl", refused, "STL", *UNKNOWN)
    yield "MSH", lambda: write("plain.msh", refused, "MSH", *UNKNOWN)


def stl_files(folder):
    from stl import mesh

    def write():
        data = np.zeros(len(SHEET.triangles), mesh.Mesh.dtype)
        data["vectors"] = SHEET.positions[SHEET.triangles]
        mesh.Mesh(data).save(str(folder / "plain.stl"))
        return refused(folder / "plain.stl", "STL", *UNKNOWN)

    yield "STL", write


def assimp_files(folder):
    from .by_hand import obj

    source = folder / "source.obj"
    source.write_text(obj(SHEET, lambda k: f"{k}/{k}"))

    def write(name, kind, make, layout, *rest):
        run("assimp", "export", source, folder / name, f"-f{kind}")
        return make(folder / name, layout, *rest)

    yield "OBJ", lambda: write("uv.obj", "obj", textured, "OBJ, vt and a .mtl")
    yield "OBJ", lambda: write("nomtl.obj", "objnomtl", textured, "OBJ, vt")
    yield "PLY", lambda: write("ascii.ply", "ply", textured, "PLY, ascii, s t")
    yield "PLY", lambda: write("binary.ply", "plyb", textured, "PLY, binary, s t")
    yield "glTF", lambda: write("uv.glb", "glb2", textured, "GLB")
    yield "glTF", lambda: write("uv.gltf", "gltf2", textured, "glTF, a buffer beside it")
    yield "STL", lambda: write("plain.stl", "stl", refused, "STL", *UNKNOWN)
