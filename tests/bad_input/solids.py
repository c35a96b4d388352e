"""Cases of solids for generate.py: files of tetrahedra, each a good one with one edit, and lists of fixed vertices."""
import itertools
import math
import pathlib
import struct

CUBES = 2 # along each edge
EDITED_VERTEX, EDITED_TET = 5, 7


class Solid:
    """Vertices (x, y, z), tetrahedra (tuples of indices from 0), and elements that are not read:
    (Gmsh's type, nodes from 0)."""

    def __init__(self, vertices, tets, others=()):
        self.vertices, self.tets, self.others = [tuple(v) for v in vertices], [tuple(t) for t in tets], list(others)

    def moved(self, motion):
        return Solid([motion(*v) for v in self.vertices], self.tets, self.others)

    def with_vertex(self, index, position):
        return Solid([position if i == index else v for i, v in enumerate(self.vertices)], self.tets, self.others)

    def with_tet(self, index, tet):
        return Solid(self.vertices, [tet if i == index else t for i, t in enumerate(self.tets)], self.others)

    def plus(self, vertices=(), tets=(), others=()):
        return Solid(self.vertices + list(vertices), self.tets + list(tets), self.others + list(others))


def is_odd(order):
    return sum(a > b for a, b in itertools.combinations(order, 2)) % 2


def solid():
    """A warped block of cubes, each cut into six tetrahedra around a diagonal; one vertex is inside."""
    n = CUBES + 1
    vertices = [(x + 0.1 * math.sin(y + 2 * z), y + 0.1 * x * z, 1.5 * z)
                for x in range(n) for y in range(n) for z in range(n)]
    tets = []
    for cube in itertools.product(range(CUBES), repeat=3):
        for order in itertools.permutations(range(3)):
            corners = [list(cube)]
            for axis in order:
                corners.append([c + (i == axis) for i, c in enumerate(corners[-1])])
            a, b, c, d = ((x * n + y) * n + z for x, y, z in corners)
            tets.append((a, b, d, c) if is_odd(order) else (a, b, c, d))
    return Solid(vertices, tets)


def bend(x, y, z):
    return x + 0.2 * z * z, y, z


def flip(tet):
    return tet[0], tet[1], tet[3], tet[2]


# -------------------------------------------------------------------------------------------------------------------- files

def msh_lines(mesh):
    """Vertex i is in line i + 6; tetrahedron t, which has the tag t + 1, in line len(vertices) + t + 9."""
    elements = [(4, tet) for tet in mesh.tets] + mesh.others
    return ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(mesh.vertices))] \
        + ["{} {:.17g} {:.17g} {:.17g}".format(i + 1, *v) for i, v in enumerate(mesh.vertices)] \
        + ["$EndNodes", "$Elements", str(len(elements))] \
        + [" ".join(map(str, (i + 1, kind, 2, 0, 1) + tuple(v + 1 for v in nodes)))
           for i, (kind, nodes) in enumerate(elements)] \
        + ["$EndElements"]


def msh_text(mesh):
    return "\n".join(msh_lines(mesh)) + "\n"


def msh4_text(mesh):
    count, tets = len(mesh.vertices), len(mesh.tets)
    return "\n".join(["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Nodes", f"1 {count} 1 {count}", f"3 1 0 {count}"]
                     + [str(i + 1) for i in range(count)] + ["{:.17g} {:.17g} {:.17g}".format(*v) for v in mesh.vertices]
                     + ["$EndNodes", "$Elements", f"1 {tets} 1 {tets}", f"3 1 4 {tets}"]
                     + [" ".join(str(i + 1) for i in (t,) + tet) for t, tet in enumerate(mesh.tets)]
                     + ["$EndElements"]) + "\n"


def msh4_bytes(mesh):
    count, tets = len(mesh.vertices), len(mesh.tets)
    return b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n$Nodes\n" \
        + struct.pack("<4Q3iQ", 1, count, 1, count, 3, 1, 0, count) + struct.pack(f"<{count}Q", *range(1, count + 1)) \
        + b"".join(struct.pack("<3d", *v) for v in mesh.vertices) + b"\n$EndNodes\n$Elements\n" \
        + struct.pack("<4Q3iQ", 1, tets, 1, tets, 3, 1, 4, tets) \
        + b"".join(struct.pack("<5Q", t + 1, *(v + 1 for v in tet)) for t, tet in enumerate(mesh.tets)) + b"\n$EndElements\n"


def medit_text(mesh):
    return "\n".join(["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(mesh.vertices))]
                     + ["{:.17g} {:.17g} {:.17g} 0".format(*v) for v in mesh.vertices]
                     + ["Tetrahedra", str(len(mesh.tets))] + [" ".join(str(i + 1) for i in tet) + " 0" for tet in mesh.tets]
                     + ["End"]) + "\n"


def vega_text(mesh):
    return "\n".join(["*VERTICES", f"{len(mesh.vertices)} 3 0 0"]
                     + ["{} {:.17g} {:.17g} {:.17g}".format(i + 1, *v) for i, v in enumerate(mesh.vertices)]
                     + ["*ELEMENTS", "TET", f"{len(mesh.tets)} 4 0"]
                     + [" ".join(str(i + 1) for i in (t,) + tet) for t, tet in enumerate(mesh.tets)]
                     + ["*MATERIAL soft", "ENU, 1000, 1e5, 0.45", "*MATERIAL hard", "ENU, 1000, 1e7, 0.3",
                        "*SET tip", "1, 2, 3,", "4", "*REGION", "allElements, soft", "*REGION", "tip, hard"]) + "\n"


def vtk_text(mesh):
    return "\n".join(["# vtk DataFile Version 3.0", "a solid", "ASCII", "DATASET UNSTRUCTURED_GRID",
                      f"POINTS {len(mesh.vertices)} double"]
                     + ["{:.17g} {:.17g} {:.17g}".format(*v) for v in mesh.vertices]
                     + [f"CELLS {len(mesh.tets)} {5 * len(mesh.tets)}"]
                     + [" ".join(map(str, (4,) + tet)) for tet in mesh.tets]
                     + [f"CELL_TYPES {len(mesh.tets)}"] + ["10"] * len(mesh.tets)) + "\n"


WRITERS = {".msh": msh_text, ".mesh": medit_text, ".veg": vega_text, ".vtk": vtk_text}


def write(path, content):
    pathlib.Path(path).write_bytes(content if isinstance(content, bytes) else content.encode())


def write_solid(path, mesh):
    write(path, WRITERS[pathlib.Path(path).suffix](mesh))


# -------------------------------------------------------------------------------------------------------------------- cases

CASES = {}


def case(name, files):
    """Besides the good pose solid.msh and a bent one: names and contents (solids or text) of further files."""
    def generate(folder):
        for file, content in {"solid.msh": solid(), "solid_bent.msh": solid().moved(bend), **files()}.items():
            (write_solid if isinstance(content, Solid) else write)(folder / file, content)
    CASES[name] = generate


def both(name, file, mesh):
    case(name, lambda: {f"{file}.msh": mesh(), f"{file}_bent.msh": mesh().moved(bend)})


def edited(number, text):
    """The Gmsh file of the bent solid with one line (from 1) replaced; None: left out."""
    lines = msh_lines(solid().moved(bend))
    lines[number - 1:number] = [] if text is None else [text]
    return "\n".join(lines) + "\n"


VERTEX_COUNT, TET_COUNT = len(solid().vertices), len(solid().tets)
VERTEX_LINE, TET_LINE = EDITED_VERTEX + 6, VERTEX_COUNT + EDITED_TET + 9
TET = solid().tets[EDITED_TET]


def vega_with(old, new):
    text = vega_text(solid().moved(bend))
    assert old in text
    return text.replace(old, new)


case("solid_good", lambda: {})
case("solid_formats", lambda: {"a.veg": solid().moved(lambda x, y, z: bend(x, z, -y)),
                               "b.mesh": solid().moved(lambda x, y, z: (x, y, z + 0.1 * x * x)),
                               "c.vtk": solid().moved(lambda x, y, z: (x, y + 0.1 * x * x, z)),
                               "d.msh": msh4_text(solid().moved(lambda x, y, z: (x, y + 0.2 * x * x, z))),
                               "e.msh": msh4_bytes(solid().moved(lambda x, y, z: (x, y, z + 0.2 * x * x)))})
case("solid_sparse_tags", lambda: {"sparse.msh": "\n".join(
    " ".join(str(7 * int(word)) if word.isdigit() and (k > 4 or k == 0) and len(line.split()) in (4, 9) else word
             for k, word in enumerate(line.split())) for line in msh_lines(solid().moved(bend))) + "\n"})
case("solid_garbage",
     lambda: {f"noise.{end}": WRITERS["." + end](solid())[:300] + "\x01\x02" * 500 for end in ("msh", "mesh", "veg", "vtk")})
case("solid_named_mesh", lambda: {"wrong.mesh": msh_text(solid())})
case("solid_nan", lambda: {"nan.msh": edited(VERTEX_LINE, f"{EDITED_VERTEX + 1} 0 nan 0")})
case("solid_decimal_comma", lambda: {"comma.veg": vega_with(" 0.1", " 0,1")})
case("solid_index_too_large", lambda: {"beyond.mesh": medit_text(solid().with_tet(EDITED_TET, (0, 1, 2, 9000)))})
case("solid_unknown_node", lambda: {"beyond.msh": solid().with_tet(EDITED_TET, (0, 1, 2, 9000))})
case("solid_truncated", lambda: {"cut.msh": msh4_bytes(solid().moved(bend))[:-200]})
case("solid_header_many",
     lambda: {"many.vtk": vtk_text(solid().moved(bend)).replace(f"POINTS {VERTEX_COUNT}", "POINTS 60000000")})
case("solid_too_few_numbers", lambda: {"short.msh": edited(VERTEX_LINE, f"{EDITED_VERTEX + 1} 0 0")})
case("solid_more_in_section",
     lambda: {"more.msh": msh_text(solid().moved(bend)).replace("$EndElements", "1 2 3\n$EndElements")})
case("solid_old_version", lambda: {"old.msh": edited(2, "4.0 0 8")})
case("solid_unknown_section", lambda: {"odd.mesh": medit_text(solid().moved(bend)).replace("End\n", "Tetrahydra\n0\nEnd\n")})
case("solid_hexahedron", lambda: {"hex.msh": solid().plus(others=[(5, (0, 1, 4, 3, 9, 10, 13, 12))])})
case("solid_vtk_hexahedron", lambda: {"hex.vtk": vtk_text(solid()).replace("\n10\n", "\n12\n", 1)})
case("solid_quadratic", lambda: {"quadratic.msh": solid().plus(others=[(11, tuple(range(10)))])})
case("solid_cubes", lambda: {"cubes.veg": vega_with("TET\n", "CUBIC\n")})
case("solid_triangles",
     lambda: {"skin.msh": solid().moved(bend).plus(others=[(2, (0, 1, 4)), (2, (0, 4, 3)), (1, (0, 1)), (15, (0,))])})
case("solid_only_triangles", lambda: {"skin.msh": Solid(solid().vertices, [], [(2, (0, 1, 4)), (2, (0, 4, 3))])})
case("solid_section_missing", lambda: {"part.msh": "\n".join(msh_lines(solid())[:VERTEX_COUNT + 6]) + "\n"})
case("solid_section_twice", lambda: {"twice.veg": vega_text(solid()) + "*ELEMENTS\nTET\n0 4 0\n"})
case("solid_tag_twice", lambda: {"tags.msh": edited(VERTEX_LINE, "1 0 0 0")})
case("solid_out_of_order", lambda: {"order.veg": vega_with(f"\n{EDITED_VERTEX + 1} ", "\n99 ")})
case("solid_materials_first", lambda: {"a.veg": solid(), "b.veg": vega_with("1e7", "1e8").replace("1e5", "1e6")})
case("solid_other_materials", lambda: {"a.veg": solid(), "b.veg": vega_with("1e7", "1e6")})
case("solid_stiff", lambda: {"bone.veg": vega_with("1e7", "1.7e10")})
case("solid_material_kind", lambda: {"rubber.veg": vega_with("ENU, 1000, 1e7, 0.3", "MOONEYRIVLIN, 1000, 1, 2, 3")})
case("solid_material_damaged", lambda: {"rubber.veg": vega_with("1e7, 0.3", "1e7, 0.5")})
case("solid_material_missing", lambda: {"bare.veg": vega_with("*REGION\nallElements, soft\n", "")})
case("solid_region_unknown", lambda: {"region.veg": vega_with("tip, hard", "tap, hard")})

both("solid_repeated_vertex", "twice", lambda: solid().with_tet(EDITED_TET, TET[:3] + TET[:1]))
case("solid_no_volume", lambda: {"flat.msh": solid().moved(bend).with_vertex(
    TET[3], tuple(sum(solid().moved(bend).vertices[i][k] for i in TET[:3]) / 3 for k in range(3)))})
case("solid_inverted", lambda: {"inverted.msh": solid().moved(bend).with_vertex(13, (9, 9, 9))})
both("solid_mixed", "mixed", lambda: solid().with_tet(EDITED_TET, flip(TET)))
both("solid_other_convention", "turned", lambda: Solid(solid().vertices, [flip(t) for t in solid().tets]))
both("solid_duplicate", "double", lambda: solid().plus(tets=[TET[1:3] + TET[:1] + TET[3:]]))


def with_fins(count):
    """Tetrahedra on top of each other at one face of the boundary, or at one inside."""
    a, b, c = (18, 21, 22) # on the side x = 2
    tip = [(4 + i, 1, 1) for i in range(count)]
    return solid().plus(tip, [(a, b, c, VERTEX_COUNT + i) for i in range(count)])


both("solid_three_at_face", "fin", lambda: with_fins(2))


def lying_inside():
    """Two tetrahedra on the same side of one face."""
    return Solid([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.2, 0.2, 1), (0.3, 0.3, 2)], [(0, 1, 2, 3), (0, 1, 2, 4)])


both("solid_same_side", "overlap", lying_inside)
both("solid_unused_vertex", "lonely", lambda: solid().plus([(0, 0, 0)]))
both("solid_vertex_of_triangle", "lonely", lambda: solid().plus([(0, 0, 0)], others=[(2, (0, 1, VERTEX_COUNT))]))


def two_tets(shared):
    """Two tetrahedra that share some of the vertices 0, 1, 2."""
    vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.2, 0.3, -1), (-3, 0.5, -1), (-3, -1, -1.5)]
    second = {3: (0, 2, 1, 4), 2: (0, 1, 4, 5), 1: (0, 6, 4, 5), 0: None}[shared]
    used = sorted(set((0, 1, 2, 3) + second))
    return Solid([vertices[i] for i in used], [(0, 1, 2, 3), tuple(used.index(i) for i in second)])


both("solid_hinge", "hinge", lambda: two_tets(2))
both("solid_components", "parts", lambda: Solid(solid().vertices + [(x + 9, y, z) for x, y, z in solid().vertices],
                                                solid().tets + [tuple(i + VERTEX_COUNT for i in t) for t in solid().tets]))


def ring():
    """The block without the cubes in two opposite columns, closed again on one level: it touches itself along an edge."""
    corners = [solid().tets[6 * i:6 * i + 6] for i in range(CUBES ** 3)] # by cube x y z
    keep = [i for i in range(CUBES ** 3) if i not in (1, 7)] # z = 1 at (0, 0) and at (1, 1)
    return Solid(solid().vertices, [t for i in keep for t in corners[i]])


def used_only(mesh):
    used = sorted({i for t in mesh.tets for i in t})
    return Solid([mesh.vertices[i] for i in used], [tuple(used.index(i) for i in t) for t in mesh.tets])


both("solid_touching_edge", "ring", lambda: used_only(ring()))

case("solid_and_surface", lambda: {})
case("surface_and_solid", lambda: {})
case("solid_other_count", lambda: {"longer.msh": solid().moved(bend).plus([(9, 9, 9)], [(18, 21, 22, VERTEX_COUNT)])})
case("solid_other_tets", lambda: {"other.msh": solid().moved(bend).with_tet(EDITED_TET, solid().tets[0])})
case("solid_reordered", lambda: {"order.msh": Solid(solid().moved(bend).vertices, solid().tets[1:] + solid().tets[:1])})
case("solid_corners_turned",
     lambda: {"turned.msh": Solid(solid().moved(bend).vertices, [(t[1], t[2], t[0], t[3]) for t in solid().tets])})
case("solid_mirrored", lambda: {"mirrored.msh": solid().moved(bend).moved(lambda x, y, z: (x, -y, z))})
case("solid_centimetres", lambda: {"large.msh": solid().moved(bend).moved(lambda x, y, z: (100 * x, 100 * y, 100 * z))})
case("solid_identical", lambda: {"same.msh": solid()})


def fixed_text(vertices):
    return "# the foot\n\n" + "".join(f"{v}\n" for v in vertices)


FOOT = [0, 3, 6, 9, 12, 15, 18, 21, 24] # z = 0, where bending moves nothing


def shell_text(size, place=(1, 1, 1.5), face="f 1 3 5"):
    """An octahedron in the middle of the solid; its first face may be written otherwise."""
    corners = [[c + (size * sign if i == axis else 0) for i, c in enumerate(place)] for axis in range(3) for sign in (1, -1)]
    faces = [face] + [f"f {a} {b} {c}" for a, b, c in itertools.product((1, 2), (3, 4), (5, 6))][1:]
    return "\n".join(["v {:.17g} {:.17g} {:.17g}".format(*c) for c in corners] + faces) + "\n"


case("surface_of_surface", lambda: {})
case("surface_missing", lambda: {})
case("surface_index", lambda: {"shell.obj": shell_text(0.5, face="f 1 3 9")})
case("surface_nan", lambda: {"shell.obj": shell_text(0.5).replace("v 1 1.5 1.5", "v 1 nan 1.5")})
case("surface_far", lambda: {"shell.obj": shell_text(50, place=(100, 100, 150))})
case("surface_outside", lambda: {"shell.obj": shell_text(0.5).replace("v 1 1 2", "v 1 1 3.1")})
case("surface_concave",
     lambda: {"shell.obj": "v 0.5 0.5 1\nv 1 0.9 1\nv 1.5 0.5 1\nv 1 1.5 1\nf 1 2 3 4\n"})
case("surface_is_solid", lambda: {})
case("surface_without_area", lambda: {"shell.obj": "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n"})
case("output_is_surface", lambda: {"shell.obj": shell_text(0.5)})

case("fixed_good", lambda: {"fixed.txt": fixed_text(FOOT + FOOT[:2])})
case("fixed_missing", lambda: {})
case("fixed_not_a_number", lambda: {"fixed.txt": fixed_text(FOOT + ["7;"])})
case("fixed_two_a_line", lambda: {"fixed.txt": fixed_text(["0 3", 6, 9])})
case("fixed_out_of_range", lambda: {"fixed.txt": fixed_text(FOOT + [VERTEX_COUNT])})
case("fixed_too_few", lambda: {"fixed.txt": fixed_text(FOOT[:2])})
case("fixed_on_a_line",
     lambda: {"fixed.txt": fixed_text([0, 9, 18]), "line.msh": Solid([(0, 0, 0)] + solid().vertices[1:], solid().tets)})
case("fixed_all", lambda: {"fixed.txt": fixed_text(range(VERTEX_COUNT))})
case("fixed_moved", lambda: {"fixed.txt": fixed_text(FOOT + [26])})
case("fixed_surface", lambda: {"fixed.txt": fixed_text([7, 70, 100])})
case("output_is_fixed", lambda: {"fixed.txt": fixed_text(FOOT)})
