"""generate(case, folder): the files of one case of cases.txt. Each broken file is a good mesh with one edit."""
import math
import os
import pathlib
import random
import struct

import command_lines
import gltf_files
import pose_scripts
import solids

CASES = dict(solids.CASES)


def case(function):
    CASES[function.__name__] = function
    return function


# ------------------------------------------------------------------------------------------------------------------- meshes

class Mesh:
    """Vertices (x, y, z) and faces (tuples of indices from 0)."""

    def __init__(self, vertices, faces):
        self.vertices, self.faces = [tuple(v) for v in vertices], [tuple(f) for f in faces]

    def moved(self, motion):
        """The same faces, vertices moved by a function of x, y, z."""
        return Mesh([motion(*v) for v in self.vertices], self.faces)

    def with_vertex(self, index, position):
        vertices = list(self.vertices)
        vertices[index] = position
        return Mesh(vertices, self.faces)

    def with_face(self, index, face):
        faces = list(self.faces)
        faces[index] = face
        return Mesh(self.vertices, faces)

    def plus(self, vertices=(), faces=()):
        return Mesh(self.vertices + list(vertices), self.faces + list(faces))


RINGS, SEGMENTS = 8, 16
EDITED_VERTEX, EDITED_FACE = 17, 5


def good():
    """A closed, lopsided blob of 130 vertices and 256 triangles; no mirror symmetry."""
    def place(theta, phi):
        r = 1 + 0.2 * math.sin(3 * theta + phi) + 0.1 * math.cos(2 * phi)
        return 1.3 * r * math.sin(theta) * math.cos(phi), r * math.sin(theta) * math.sin(phi), 2 * r * math.cos(theta)

    vertices = [place(math.pi * (i + 1) / (RINGS + 1), 2 * math.pi * k / SEGMENTS)
                for i in range(RINGS) for k in range(SEGMENTS)]
    north, south = len(vertices), len(vertices) + 1
    vertices += [place(0, 0), place(math.pi, 0)]
    faces = []
    for k in range(SEGMENTS):
        after = (k + 1) % SEGMENTS
        faces += [(north, k, after), (south, (RINGS - 1) * SEGMENTS + after, (RINGS - 1) * SEGMENTS + k)]
        for i in range(RINGS - 1):
            a, b = i * SEGMENTS + k, i * SEGMENTS + after
            faces += [(a, a + SEGMENTS, b + SEGMENTS), (a, b + SEGMENTS, b)]
    return Mesh(vertices, faces)


def sheet(motion, quads=False, n=8):
    """A grid of n x n squares over [-1, 1]^2, then moved by a function of its two coordinates."""
    vertices = [motion(2 * i / n - 1, 2 * k / n - 1) for i in range(n + 1) for k in range(n + 1)]
    faces = []
    for i in range(n):
        for k in range(n):
            a = i * (n + 1) + k
            corners = (a, a + n + 1, a + n + 2, a + 1)
            faces += [corners] if quads else [corners[:3], (corners[0],) + corners[2:]]
    return Mesh(vertices, faces)


def bend(x, y, z):
    return x + 0.3 * z * z, y, z


def bent():
    return good().moved(bend)


def saddle(x, y):
    return x, y, 0.6 * (x * x - y * y) + 0.1 * x


def roof(x, y):
    return x, y, 0.3 * abs(x) + 0.1 * y * y


# -------------------------------------------------------------------------------------------------------------------- files

def obj_lines(mesh):
    """Vertex i is in line i + 1, face f in line len(vertices) + f + 1."""
    return ["v {:.17g} {:.17g} {:.17g}".format(*v) for v in mesh.vertices] \
        + ["f " + " ".join(str(i + 1) for i in face) for face in mesh.faces]


def obj_text(mesh):
    return "\n".join(obj_lines(mesh)) + "\n"


def off_text(mesh):
    return "\n".join(["OFF", f"{len(mesh.vertices)} {len(mesh.faces)} 0"]
                     + ["{:.17g} {:.17g} {:.17g}".format(*v) for v in mesh.vertices]
                     + [" ".join(map(str, (len(face),) + face)) for face in mesh.faces]) + "\n"


def ply_header(mesh, real="float", count="uchar", encoding="binary_little_endian"):
    return (f"ply\nformat {encoding} 1.0\nelement vertex {len(mesh.vertices)}\nproperty {real} x\nproperty {real} y\n"
            f"property {real} z\n"
            f"element face {len(mesh.faces)}\nproperty list {count} int vertex_indices\nend_header\n").encode()


def ply_body(mesh):
    return b"".join(struct.pack("<3f", *v) for v in mesh.vertices) \
        + b"".join(struct.pack(f"<B{len(face)}i", len(face), *face) for face in mesh.faces)


def ply_bytes(mesh):
    return ply_header(mesh) + ply_body(mesh)


def ply_text(mesh):
    return ply_header(mesh, real="double", encoding="ascii").decode() + off_text(mesh).split("\n", 2)[2]


def write(path, content):
    pathlib.Path(path).write_bytes(content if isinstance(content, bytes) else content.encode())


def write_mesh(path, mesh):
    content = {".obj": obj_text, ".ply": ply_bytes, ".off": off_text}[pathlib.Path(path).suffix](mesh)
    write(path, content)


def edited_line(mesh, number, text):
    """The OBJ file of a mesh with one line (from 1) replaced."""
    lines = obj_lines(mesh)
    lines[number - 1] = text
    return "\n".join(lines) + "\n"


def edited_vertex(text):
    return edited_line(bent(), EDITED_VERTEX + 1, text)


def edited_face(text):
    return edited_line(bent(), len(good().vertices) + EDITED_FACE + 1, text)


def write_both(folder, name, mesh):
    """The mesh and, with the same faces, a bent pose of it."""
    write_mesh(folder / f"{name}.obj", mesh)
    write_mesh(folder / f"{name}_bent.obj", mesh.moved(bend))


# -------------------------------------------------------------------------------------------------------------------- cases

def file_case(name, file, content):
    """A case that needs one file besides the good ones; content is a function without arguments."""
    CASES[name] = lambda folder: write(folder / file, content())


def mesh_case(name, file, mesh):
    CASES[name] = lambda folder: write_mesh(folder / file, mesh())


def both_case(name, file, mesh):
    CASES[name] = lambda folder: write_both(folder, file, mesh())


@case
def layers_contradict(folder):
    for name, height in (("flat", 0.2), ("flatter", 0.15)):
        write_mesh(folder / f"{name}.obj", good().moved(lambda x, y, z, height=height: (x, y, height * z)))


@case
def unreadable_file(folder):
    write_mesh(folder / "locked.obj", bent())
    os.chmod(folder / "locked.obj", 0)


@case
def folder(folder):
    (folder / "folder.obj").mkdir()


@case
def pipe(folder):
    os.mkfifo(folder / "pipe.obj")


file_case("empty_file", "empty.obj", lambda: "")
file_case("only_comments", "comments.obj", lambda: "# nothing\n\n# here\n")
mesh_case("no_vertices_ply", "nothing.ply", lambda: Mesh([], []))
mesh_case("no_faces", "points.obj", lambda: Mesh(good().vertices, []))
file_case("truncated_ply", "cut.ply", lambda: ply_bytes(bent())[:-7])
file_case("truncated_in_vertices", "cut.off", lambda: off_text(bent())[:3000] + "\n#" + " " * 5000)
file_case("truncated_obj", "cut.obj", lambda: obj_text(bent())[:-300].rstrip("0123456789 "))
file_case("obj_named_ply", "obj.ply", lambda: obj_text(bent()))
file_case("ply_named_obj", "ply.obj", lambda: ply_bytes(bent()))
file_case("picture_named_obj", "picture.obj", lambda: b"\x89PNG\r\n\x1a\n" + bytes(100))
file_case("lone_unknown_extension", "good.fbx", lambda: obj_text(good()))
file_case("unknown_extension", "good.xyz", lambda: obj_text(good()))
file_case("no_extension", "good", lambda: obj_text(good()))


@case
def garbage(folder):
    for seed, extension in enumerate(("obj", "ply", "off")):
        write(folder / f"garbage.{extension}", random.Random(seed).randbytes(4 << 20))


file_case("garbage_after_header", "noise.ply",
          lambda: ply_header(bent()) + random.Random(3).randbytes(len(ply_body(bent()))))


def with_header(old, new):
    header = ply_header(bent()).decode()
    assert old in header
    return header.replace(old, new).encode() + ply_body(bent())


VERTEX_COUNT, FACE_COUNT = len(good().vertices), len(good().faces)
file_case("header_4e9_vertices", "huge.ply", lambda: with_header(f"vertex {VERTEX_COUNT}", "vertex 4000000000"))
file_case("header_many_vertices", "many.ply", lambda: with_header(f"vertex {VERTEX_COUNT}", "vertex 60000000"))
file_case("header_many_faces", "many.off", lambda: off_text(bent()).replace(f" {FACE_COUNT} 0", " 100000000 0", 1))
file_case("header_large_list", "list.ply", lambda: with_header("list uchar", "list uint"))
file_case("ply_header_damaged", "header.ply", lambda: with_header("property float y", "propertx float y"))
file_case("off_blank", "blank.off", lambda: "\n# nothing\n")
file_case("ply_header_long", "header.ply",
          lambda: with_header("element face", "".join(f"element e{i} 0\n" for i in range(20000)) + "element face"))
file_case("ply_without_z", "flat.ply", lambda: with_header("float z", "float w"))

file_case("nan_text", "nan.obj", lambda: edited_vertex("v 0 nan 0"))
file_case("bad_input_writes_nothing", "nan.obj", lambda: edited_vertex("v 0 nan 0"))
file_case("infinity_text", "inf.obj", lambda: edited_vertex("v 0 1e400 0"))
mesh_case("infinity_binary", "inf.ply", lambda: bent().with_vertex(EDITED_VERTEX, (0, math.inf, 0)))


def vertex_line():
    return obj_lines(bent())[EDITED_VERTEX]


file_case("underflow", "tiny.obj", lambda: edited_vertex(vertex_line().rsplit(" ", 1)[0] + " 1e-400"))
file_case("decimal_comma", "comma.obj", lambda: edited_vertex(vertex_line().replace(".", ",")))
file_case("mesh_too_small", "small.obj",
          lambda: "".join(f"v {i}e-20 0 0\n" if i else "v 0 0 0\n" for i in (0, 1)) + "f 1 2 1\n")
file_case("coordinate_too_large", "large.obj", lambda: edited_vertex("v 0 1e20 0"))
file_case("vertex_with_two_numbers", "short.obj", lambda: edited_vertex("v 0.5 0.5"))
file_case("unknown_statement", "odd.obj", lambda: edited_vertex("w" + vertex_line()[1:]))
file_case("free_form_surface", "surf.obj", lambda: obj_text(bent()) + "surf 0 1 0 1 1 2 3\n")
file_case("free_form_first", "call.obj", lambda: "call other.obj\n" + obj_text(bent()))
file_case("rare_statement_first", "merged.obj", lambda: "mg 1 0.5\n" + obj_text(bent()))
file_case("more_after_end", "more.off", lambda: off_text(bent()) + "3 0 1 2\n")

file_case("index_zero", "zero.obj", lambda: edited_face("f 0 1 2"))
file_case("index_too_large", "beyond.obj", lambda: edited_face("f 1 2 9001"))
file_case("index_before_start", "before.obj", lambda: edited_face("f 1 2 -9001"))
mesh_case("index_too_large_ply", "beyond.ply", lambda: bent().with_face(EDITED_FACE, (0, 1, 9001)))
file_case("face_with_two_corners", "line.obj", lambda: edited_face("f 1 2"))
file_case("many_errors", "spoilt.obj", lambda: "\n".join(obj_lines(bent())[VERTEX_COUNT // 2:]) + "\n")


def edited_corners(mesh):
    return mesh.faces[EDITED_FACE]


def flattened(mesh, height):
    """The third corner of the face is moved to the middle of its opposite edge, but for a part of its height."""
    a, b, c = (mesh.vertices[i] for i in edited_corners(mesh))
    middle = [(x + y) / 2 for x, y in zip(a, b)]
    return mesh.with_vertex(edited_corners(mesh)[2], tuple(m + height * (z - m) for m, z in zip(middle, c)))


both_case("repeated_vertex", "twice",
          lambda: good().with_face(EDITED_FACE, edited_corners(good())[:2] + edited_corners(good())[:1]))
def with_filled_gap(mesh):
    """Two more triangles: one that has a vertex in the middle of an edge, and one between that edge and a copy of the
    vertex, which is a millionth farther out."""
    a, b = edited_corners(mesh)[:2]
    middle = [(x + y) / 2 for x, y in zip(mesh.vertices[a], mesh.vertices[b])]
    count = len(mesh.vertices)
    return mesh.plus([middle, [1.000001 * x for x in middle]], [(a, count + 1, b), (count, 0, 1)])


mesh_case("zero_area", "flat.obj", lambda: flattened(good(), 0))
mesh_case("zero_area_in_second_pose", "flat_bent.obj", lambda: flattened(bent(), 0))
mesh_case("needle_in_second_pose", "needle.obj", lambda: flattened(bent(), 1e-8))
mesh_case("collapsed_pose", "collapsed.obj", lambda: good().moved(lambda x, y, z: (1, 2, 3)))
mesh_case("inside_out_part", "through.obj", lambda: good().moved(lambda x, y, z: (-0.05 * x, y, z)))
mesh_case("collapsed_part", "collapsed.obj", lambda: good().moved(lambda x, y, z: (x, y, z) if z < 1 else (0, 0, 1)))


# At both ends less than a tenth of the body, together more.
@case
def collapsed_parts(folder):
    end = 1.7
    for name, side in (("top", 1), ("bottom", -1)):
        pose = good().moved(lambda x, y, z, side=side: (x, y, z) if side * z < end else (0, 0, side * end))
        write_mesh(folder / f"{name}.obj", pose)


both_case("no_face_is_one", "lines", lambda: Mesh(good().vertices, [face[:2] + face[:1] for face in good().faces]))


def split(mesh):
    """Flat shading: every face has vertices of its own."""
    size = len(mesh.faces[0])
    return Mesh([mesh.vertices[i] for face in mesh.faces for i in face],
                [tuple(range(size * f, size * (f + 1))) for f in range(len(mesh.faces))])


both_case("zero_area_once_welded", "welded", lambda: with_filled_gap(good()))
both_case("flat_shaded", "split", lambda: split(good()))
both_case("flat_shaded_and_bad", "split",
          lambda: split(good().with_face(EDITED_FACE, edited_corners(good())[:2] + edited_corners(good())[:1])))
both_case("three_faces_at_edge", "fin", lambda: good().plus([(9, 9, 9)], [edited_corners(good())[:2] + (VERTEX_COUNT,)]))
both_case("flipped_face", "flipped", lambda: good().with_face(EDITED_FACE, edited_corners(good())[::-1]))
both_case("duplicate_face", "double", lambda: good().plus([], [edited_corners(good())[1:] + edited_corners(good())[:1]]))
both_case("duplicate_face_reversed", "double", lambda: good().plus([], [edited_corners(good())[::-1]]))
both_case("unreferenced_vertex", "lonely", lambda: good().plus([(0, 0, 0)]))


def joined_corners():
    """A sheet whose last corner is its first."""
    mesh = sheet(saddle)
    last = len(mesh.vertices) - 1
    return Mesh(mesh.vertices[:-1], [tuple(0 if i == last else i for i in face) for face in mesh.faces])


both_case("bow_tie", "bow", joined_corners)


def two_blobs(shares_vertex):
    """Two blobs beside each other; they may have their first vertex in common."""
    first = good()
    second = first.moved(lambda x, y, z: (x + 10, y, z))
    count = len(first.vertices)
    own = 1 if shares_vertex else 0 # first vertex that the second blob brings along
    names = [0] * own + [count + i for i in range(count - own)]
    return first.plus(second.vertices[own:], [tuple(names[i] for i in face) for face in second.faces])


both_case("touching_in_a_vertex", "touch", lambda: two_blobs(True))
both_case("two_components", "parts", lambda: two_blobs(False))


@case
def concave_face(folder):
    mesh = Mesh([(0, 0, 0), (4, 0, 0), (1, 1, 0), (0, 4, 0)], [(1, 2, 3, 0)])
    write_mesh(folder / "concave.obj", mesh)
    write_mesh(folder / "concave_bent.obj", mesh.with_vertex(3, (0, 4, 1)))


mesh_case("other_vertex_count", "longer.obj", lambda: bent().plus([(0, 0, 0)]))
mesh_case("other_faces", "other.obj", lambda: bent().with_face(EDITED_FACE, (0, 40, 80)))
mesh_case("fewer_faces", "fewer.obj", lambda: Mesh(bent().vertices, bent().faces[:-1]))


def permutation():
    order = list(range(VERTEX_COUNT))
    random.Random(1).shuffle(order)
    return order


@case
def renumbered(folder):
    order, mesh = permutation(), bent()
    vertices = [None] * VERTEX_COUNT
    for old, new in enumerate(order):
        vertices[new] = mesh.vertices[old]
    write_mesh(folder / "renumbered.obj", Mesh(vertices, [tuple(order[i] for i in face) for face in mesh.faces]))


mesh_case("reordered", "reordered.obj", lambda: Mesh(bent().vertices, bent().faces[1:] + bent().faces[:1]))
mesh_case("shuffled_vertices", "shuffled.obj", lambda: Mesh([bent().vertices[i] for i in permutation()], bent().faces))
mesh_case("mirrored", "mirrored.obj", lambda: bent().moved(lambda x, y, z: (-x, y, z)))


@case
def mirrored_sheet(folder):
    write_mesh(folder / "sheet.obj", sheet(saddle))
    write_mesh(folder / "sheet_mirrored.obj", sheet(saddle).moved(lambda x, y, z: (x, y, -z)))


mesh_case("centimetres", "centimetres.obj", lambda: good().moved(lambda x, y, z: (100 * x, 100 * y, 100 * z)))
mesh_case("identical_poses", "same.obj", good)
mesh_case("two_of_three_identical", "same.obj", good)


def turn(x, y, z):
    return 0.6 * x - 0.8 * y + 30, 0.8 * x + 0.6 * y - 20, z + 10


mesh_case("moved_pose", "moved.obj", lambda: good().moved(turn))
mesh_case("not_aligned", "turned.obj", lambda: bent().moved(turn))


@case
def all_at_once(folder):
    write(folder / "nan.obj", edited_vertex("v 0 nan 0"))
    write(folder / "zero.obj", edited_face("f 0 1 2"))
    write(folder / "unknown.xyz", obj_text(good()))


@case
def formats(folder):
    write_mesh(folder / "bent.ply", bent())
    write_mesh(folder / "third.off", bent().moved(bend))


def scaled(factor, offset=0.0):
    def motion(x, y, z):
        return factor * x + offset, factor * y + offset, factor * z + offset
    return motion


def write_moved(folder, name, extension, motion):
    write_mesh(folder / f"{name}{extension}", good().moved(motion))
    write_mesh(folder / f"{name}_bent{extension}", bent().moved(motion))


CASES["huge"] = lambda folder: write_moved(folder, "huge", ".obj", scaled(1e6))
CASES["tiny"] = lambda folder: write_moved(folder, "tiny", ".obj", scaled(1e-6))
CASES["far_from_origin"] = lambda folder: write_moved(folder, "far", ".obj", scaled(1, 1e6))
CASES["far_from_origin_single"] = lambda folder: write_moved(folder, "far", ".ply", scaled(500, 1e6))
mesh_case("twice_as_large", "larger.obj", lambda: bent().moved(scaled(2)))


@case
def isolated_triangle(folder):
    write_mesh(folder / "triangle.obj", Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    write_mesh(folder / "triangle_bent.obj", Mesh([(0, 0, 0), (1, 0, 0), (0.3, 0.8, 1)], [(0, 1, 2)]))


@case
def open_boundary(folder):
    write_mesh(folder / "sheet.obj", sheet(lambda x, y: (x, y, 0)))
    write_mesh(folder / "sheet_bent.obj", sheet(roof))


@case
def quads(folder):
    write_mesh(folder / "quads.obj", sheet(saddle, quads=True))
    write_mesh(folder / "quads_bent.obj", sheet(roof, quads=True))


mesh_case("rows_rotated", "rotated.obj",
          lambda: Mesh(bent().vertices, [f[i % 3:] + f[:i % 3] for i, f in enumerate(bent().faces)]))
both_case("slivers", "sliver", lambda: flattened(good(), math.radians(0.25)))


@case
def touching_vertices(folder):
    write_mesh(folder / "tube.obj",
               sheet(lambda x, y: (math.sin(math.pi * x) / math.pi, y, math.cos(math.pi * x) / math.pi)))
    write_mesh(folder / "tube_bent.obj", sheet(lambda x, y: (x, y, 0)))


file_case("unicode_name", "grüß 模型 a.obj", lambda: obj_text(good()))
file_case("dash_name", "-good.obj", lambda: obj_text(good()))
file_case("long_name", "n" * 240 + ".obj", lambda: obj_text(good()))


@case
def carriage_returns(folder):
    poses = good(), bent(), bent().moved(bend)
    for mesh, name, text in zip(poses, ("crlf.obj", "crlf.ply", "crlf.off"), (obj_text, ply_text, off_text)):
        write(folder / name, text(mesh).replace("\n", "\r\n"))


file_case("old_carriage_returns", "cr.obj", lambda: obj_text(good()).replace("\n", "\r"))
file_case("byte_order_mark", "bom.obj", lambda: b"\xef\xbb\xbf" + obj_text(good()).encode())


@case
def no_final_newline(folder):
    poses = good(), bent(), bent().moved(bend)
    for mesh, name, text in zip(poses, ("unended.obj", "unended.ply", "unended.off"), (obj_text, ply_text, off_text)):
        write(folder / name, text(mesh).rstrip("\n"))


@case
def slash_in_group(folder):
    lines = obj_lines(good())
    groups = ["mtllib a b/c.mtl", "o head/left eye", "g a/b c\\d", "s off", "usemtl skin/1", "vt 0 0", "vn 0 0 1"]
    write(folder / "groups.obj", "\n".join(lines[:VERTEX_COUNT] + groups + lines[VERTEX_COUNT:]) + "\n")


CASES["ghost_fin"] = CASES["three_faces_at_edge"]


gltf_files.add_cases(good)
for seams in ("gltf_seams_checked", "gltf_seams_baked"):
    CASES[seams] = lambda folder: write(folder / "a.glb", gltf_files.blob(split(good())).glb())
CASES.update(gltf_files.CASES)
CASES.update(pose_scripts.CASES)
CASES.update(command_lines.CASES)


def generate(name, folder):
    """Writes good.obj, bent.obj, good.ply, good.off and the files of the case into the folder."""
    folder = pathlib.Path(folder)
    for mesh, file in ((good(), "good.obj"), (bent(), "bent.obj"), (good(), "good.ply"), (good(), "good.off")):
        write_mesh(folder / file, mesh)
    CASES[name](folder)
