"""limits.py TOOL ASSET [SCALE]: the table of limits in .github/SECURITY.md is true. Of each row, an input one step beyond
the value is refused with the message of the row, and one at the value is not refused with it. Rows of cost: good and
hostile files of every format stay below. ASSET: any good asset, of which the header is changed. SCALE: how many times
larger the costly files are (default: 1, which says little of memory; 20 takes half a minute)."""
import array
import itertools
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import gltf_files  # noqa: E402
import solids  # noqa: E402
from asset_checksums import with_checksums  # noqa: E402

DOCUMENT = Path(__file__).resolve().parents[2] / ".github/SECURITY.md"
OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
SOLID = solids.Solid([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2, 3)], [])


def table():
    """Limit: (value, message). Of rows of cost the message is empty."""
    rows = re.findall(r"^\| ([^|]+) \| `([0-9.e+]+)` \| (?:(P\d{4})[^|]*)?\|", DOCUMENT.read_text(), re.M)
    return {name: (float(value) if re.search(r"[.e]", value) else int(value), message) for name, value, message in rows}


# -- one input of the limited kind: (words of the command, file names and contents)

def check(name, content, *more):
    return ["check", name, name, *more], {name: content}


def sparse_file(size):
    return ["check", "large.ply", "large.ply"], {"large.ply": size}


def ply(element):
    return lambda count: check("a.ply", f"ply\nformat ascii 1.0\nelement {element} {count}\nproperty float x\n"
                                        "property float y\nproperty float z\nend_header\n0 0 0\n")


def ply_faces(count):
    return check("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                          f"element face {count}\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n")


def ply_header(lines):
    comments = "comment none\n" * (lines - 6)
    return check("a.ply", f"ply\nformat ascii 1.0\n{comments}element vertex 1\nproperty float x\nproperty float y\n"
                          "property float z\nend_header\n0 0 0\n")


def coordinate(size):
    return check("a.obj", OBJ.replace("v 1 1", f"v {size!r} 1"))


def poses(count):
    names = [f"{i}.obj" for i in range(count)]
    return ["check", *names], {name: OBJ.replace("1 1 0", f"1 1 {i / count}") for i, name in enumerate(names)}


def nested(depth):
    return "[" * depth + "]" * depth


def gltf_depth(depth):
    return check("a.gltf", '{"asset": {"version": "2.0"}, "extras": ' + nested(depth - 1) + "}")


def material_text(size):
    file = gltf_files.Gltf()
    file.mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    file.json["materials"] = [{"name": "m" * (size - len('{"name":""}'))}]
    return check("a.glb", file.glb())


def images(count):
    file = gltf_files.Gltf()
    file.mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    file.json["images"] = [{"uri": "a.png"}] * count
    return check("a.glb", file.glb())


def uri_folders(count):
    buffers = json.dumps([{"byteLength": 1, "uri": "a/" * count + "a.bin"}])
    return check("a.gltf", '{"asset": {"version": "2.0"}, "buffers": ' + buffers + "}")


def config_depth(depth):
    return ["bake", "--config", "a.json"], {"a.json": '{"poses": ' + nested(depth - 1) + "}"}


def json_memory(factor):
    """Objects that take forty times their text, beyond the limit; numbers, at the limit."""
    items = "{}," * 1000000 if factor != int(factor) else "1," * 1500000
    return check("a.gltf", '{"asset": {"version": "2.0"}, "extras": [' + items + "0]}")


def gltf(fill):
    """A maker: fill(gltf, limit) reads as many numbers of the file as `limit` says, which depends on the file's size."""
    def make(free_count, per_byte, *choices):
        size = 0
        for _ in range(8):
            file = gltf_files.Gltf()
            fill(file, free_count + per_byte * size)
            blob = file.glb()
            if size == len(blob):
                return ["check", *["a.glb" + choice for choice in choices or [""]], "b.obj"], {"a.glb": blob, "b.obj": OBJ}
            size = len(blob)
        raise AssertionError("the file's size does not settle")
    return make


def shared(gltf, limit, numbers, component, cost):
    """Accessors that share bytes and take `limit` together; each costs something besides."""
    size = 50000
    count = (limit - cost - 10000) // (30000 + cost)
    last = limit - cost - count * (30000 + cost)
    whole = gltf.json["accessors"][gltf.accessor(numbers * (size // len(numbers)), component)]
    gltf.json["accessors"] += [{**whole, "count": 30000}, {**whole, "count": last}]
    first = len(gltf.json["accessors"]) - 2
    return [first] * count + [first + 1]


def drawn(gltf, limit):
    primitive = gltf.mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    indices = shared(gltf, limit - 96 * len(gltf.json["nodes"]), [0, 1], 5121, 9 + 64 + 64)
    gltf.json["meshes"][0]["primitives"] = [{**primitive, "indices": i} for i in indices]


# In 32 poses.
def drawn_often(gltf, limit):
    primitive = gltf.mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    indices = shared(gltf, -(-limit // 32), [0, 1], 5121, 9)
    gltf.json["meshes"][0]["primitives"] = [{**primitive, "indices": i} for i in indices]


def layer_range(weight):
    return ["bake", "a.obj", "b.obj", "--blend", "layers", f"--range=0:{weight}", "-o", "a.pliant", "--preview"], \
        {"a.obj": OBJ, "b.obj": OBJ.replace("1 1 0", "1 1 0.5")}


def grid(points):
    """Of three poses, along whose edges the grid has `steps` steps."""
    steps = int(math.sqrt(2 * points))
    return ["average", "a.obj", "b.obj", "c.obj", "--grid", str(steps), "-o", "a_%d.ply"], \
        {f"{name}.obj": OBJ.replace("1 1 0", f"1 1 {z}") for name, z in (("a", 0), ("b", 0.5), ("c", 0.7))}


def pose(motions):
    return ["pose", "a.msh", "script.txt", "-o", "bent.msh"], \
        {"a.msh": solids.msh_text(SOLID), "script.txt": f"box -9 -9 -9 9 9 9 {motions}\n"}


def header_field(offset, asset):
    def make(value):
        blob = bytearray(asset)
        struct.pack_into("<I", blob, offset, value)
        return ["validate", "a.pliant"], {"a.pliant": with_checksums(blob)}
    return make


def makers(asset):
    return {
        "bytes of a file that the baker reads": sparse_file,
        "vertices of a mesh": ply("vertex"),
        "faces of a mesh": ply_faces,
        "magnitude of a coordinate": coordinate,
        "lines of a PLY header": ply_header,
        "depth of the JSON of glTF": gltf_depth,
        "memory of the JSON of glTF, in its bytes": json_memory,
        "numbers that a glTF scene draws, beside 8 for each byte": lambda count: gltf(drawn)(count, 8),
        "numbers that all poses of a glTF file read and draw, beside 128 for each byte":
            lambda count: gltf(drawn_often)(count, 128, *["#rest"] * 32),
        "bytes of the name of a glTF mesh or morph target":
            lambda size: check("a.gltf", '{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}], "meshes": [{"name": "'
                               + "n" * size + '"}]}'),
        "images of a glTF file": images,
        "folders in the URI of a buffer or image": uri_folders,
        "bytes of the materials, samplers and textures of a glTF file, as JSON without blanks": material_text,
        "depth of configurations and manifests": config_depth,
        "poses": poses,
        "magnitude of a layer's weight, in its range": layer_range,
        "points of `average --grid`": grid,
        "degrees of all turns of a line of `pliant pose`": lambda degrees: pose(f"turn 0 0 0 0 0 1 {degrees}"),
        "diagonals of all moves of a line": lambda diagonals: pose(f"move {diagonals} 0 0"),
        "motions of a line": lambda count: pose("move 0 0 0 " * count),
        "vertices of an asset": header_field(32, asset),
        "triangles of an asset": header_field(36, asset),
        "dimension of an asset": header_field(40, asset),
        "poses of an asset (of layers: one more)": header_field(44, asset),
    }


# -- the tool

def run(tool, words, files, folder):
    for name, content in files.items():
        if isinstance(content, int):
            with open(folder / name, "wb") as file:
                file.truncate(content)
        else:
            (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return subprocess.run([tool, *words], cwd=folder, capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL)


def refuses(tool, make, value, message):
    with tempfile.TemporaryDirectory(prefix="pliant-limits-") as folder:
        done = run(tool, *make(value), Path(folder))
    # Of an asset, whose one number stands for every rule, the rule as well.
    pattern = rf"\b{message}\b" + (r".*a count in the asset" if message == "P5102" else "")
    return re.search(pattern, done.stderr) is not None, done


def check_limit(tool, name, make, value, message):
    beyond = value * 1.01 if isinstance(value, float) else value + 1
    is_refused, done = refuses(tool, make, beyond, message)
    if not is_refused:
        yield f"{name}: {beyond} is not refused with {message}: {done.returncode} {done.stderr[:300]}"
    if name in ("bytes of a file that the baker reads", "points of `average --grid`") or name.startswith("numbers that all"):
        return  # the value itself takes minutes
    is_refused, done = refuses(tool, make, value, message)
    if is_refused:
        yield f"{name}: {value} is refused: {done.stderr[:300]}"


# -- what reading costs

LINES = 100000 * int(sys.argv[3] if len(sys.argv) > 3 else 1)


def costly_files():
    """Of every format, one element again and again, which is no good, or of which there are too many: name and content; of
    files with short elements also how many vertices and corners; another pose, where the first one twice says too little."""
    vertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    yield "a.obj", OBJ + "f 1 1 1\n" * LINES
    yield "a.obj", OBJ + "v nan 0 0\n" * LINES
    yield "a.obj", OBJ + "f 9 1 2\n" * LINES
    yield "a.obj", OBJ + "o part\n" * LINES
    yield "a.off", f"OFF {4} {LINES} 0\n" + vertices + "3 0 0 0\n" * LINES
    yield "a.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" \
        f"element face {LINES}\nproperty list uchar int vertex_indices\nend_header\n" + vertices + "3 0 1 2\n" * LINES
    many = solids.Solid(SOLID.vertices, SOLID.tets * (LINES // 4), [])
    yield "a.msh", solids.msh_text(many)
    yield "a.msh", solids.msh4_text(many)
    yield "a.mesh", solids.medit_text(many)
    yield "a.veg", solids.vega_text(many)
    yield "a.vtk", solids.vtk_text(many)
    yield "a.gltf", '{"asset": {"version": "2.0"}, "nodes": [' + "{}," * LINES + "{}]}"
    file = gltf_files.Gltf()
    file.mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    file.json["materials"] = [{"k" * 5 * LINES: {f"{i}": {} for i in range(LINES // 2)}}]
    yield "a.glb", file.glb()
    set_rows = solids.vega_text(SOLID) + "*SET s\n" + "1," * LINES + "1\n*REGION\n" + "s,m\n" * LINES
    yield "a.veg", set_rows
    yield "a.msh", solids.msh_text(SOLID) + "$" + "$End" * 2 * LINES + "Z\n" + "$End" * 10 * LINES
    short = "ply\nformat binary_little_endian 1.0\n" + "element vertex {}\nproperty char x\nproperty char y\n" \
        "property char z\nelement face {}\nproperty list uchar uchar vertex_indices\nend_header\n"
    triangle, face = bytes([0, 0, 0, 1, 0, 0, 0, 1, 0]), bytes([3, 0, 1, 2])
    many = short.format(3 * LINES, 1).encode() + triangle * LINES
    yield "a.ply", many + face, 3 * LINES, 3, many[:-1] + b"\1" + face
    yield "a.ply", short.format(3, LINES).encode() + triangle + face * LINES, 3, 3 * LINES
    # All triangles of 60 vertices: 58 at each edge.
    crowd = b"".join(bytes([3, *corners]) for corners in itertools.combinations(range(60), 3))
    first, other = (bytes(c for i in range(60) for c in (i, i * i % 101, (i * i * i + pose * i) % 97)) for pose in (0, 1))
    head = short.format(60, len(crowd) // 4).encode()
    yield "a.ply", head + first + crowd, 60, 3 * len(crowd) // 4, head + other + crowd
    yield "a.obj", OBJ + "f" + " 1 2 3" * LINES + "\n", 4, 3 * LINES
    # Flat poses across two directions by which the weld sorted vertices once: all were at one height.
    points, corners = [(x, y) for x in range(400) for y in range(400)], [400 * x + y for x in range(399) for y in range(399)]
    faces = "".join(f"f {i + 1} {i + 401} {i + 402} {i + 2}\n" for i in corners)
    yield "a.obj", "".join(f"v {0.7930 * x + 0.2837 * y} {-0.5392 * y} {-0.5392 * x}\n" for x, y in points) + faces, 0, 0, \
        "".join(f"v {0.7930 * x} {0.6 * y - 0.2837 * x} {0.7930 / 0.5392 * 0.6 * y}\n" for x, y in points) + faces
    yield "a.ply", cube(0), 0, 0, cube(1)
    grid = "".join(f"v {x} {y} {math.sin(x + y)}\n" for x in range(200) for y in range(200))
    faces = "".join(f"f {i} {i + 1} {i + 201} {i + 200}\n" for i in range(1, 39800) if i % 200)
    yield "a.obj", grid + faces


# 7^6 vertices, each near all of them and at a vertex in none but its own of both poses, which no direction tells apart.
def cube(pose):
    steps = [1.05e-6 * x for x in range(7)]
    near = itertools.product(steps, repeat=6)
    points = [*itertools.chain.from_iterable(p[3 * pose:3 * pose + 3] for p in near), 0, 0, 0, .6, 0, 0, .6, .6, .6]
    count = len(points) // 3
    corners = itertools.chain.from_iterable((3, i, i + 1, i + 2) for i in range(0, count - 2))
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty double x\nproperty double y\n" \
        f"property double z\nelement face {count - 2}\nproperty list int int vertex_indices\nend_header\n"
    return head.encode() + array.array("d", points).tobytes() + array.array("i", corners).tobytes()


def check_cost(tool, costs, name, content, vertices=0, corners=0, other=None):
    poses = [text.encode() if isinstance(text, str) else text for text in (content, other or content)]
    with tempfile.TemporaryDirectory(prefix="pliant-limits-") as folder:
        names = [name, "other" + Path(name).suffix]
        for file, pose in zip(names, poses):
            (Path(folder) / file).write_bytes(pose)
        nothing = {stream: subprocess.DEVNULL for stream in ("stdin", "stdout", "stderr")}
        child = subprocess.Popen([tool, "check", *names], cwd=folder, **nothing)
        _, status, usage = os.wait4(child.pid, 0)
    size = sum(map(len, poses))
    allowed = {"processor seconds": 3 + costs["processor seconds for a MiB of meshes"] * size / 2**20,
               "bytes": (128 << 20) + costs["bytes of memory for a byte of meshes"] * size
                        + 2 * costs["bytes for a vertex, beside these"] * vertices
                        + 2 * costs["bytes for a corner of a face, beside these"] * corners}
    taken = {"processor seconds": usage.ru_utime + usage.ru_stime, "bytes": usage.ru_maxrss * 1024}
    print(f"{name} of {size / 2**20:.1f} MiB: {taken['processor seconds']:.2f} s, {taken['bytes'] >> 20} MiB")
    if os.waitstatus_to_exitcode(status) not in (0, 3):
        yield f"{name}: exit code {os.waitstatus_to_exitcode(status)}"
    for what, most in allowed.items():
        if taken[what] > most:
            yield f"{name}: {taken[what]:.3g} {what}, allowed {most:.3g}"


def main(tool, asset):
    limits = table()
    costs = {name: limits.pop(name)[0] for name in [*limits] if not limits[name][1]}
    made = makers(Path(asset).read_bytes())
    problems = [f"the table and this test name different limits: {sorted(set(limits) ^ set(made))}"] \
        if set(limits) != set(made) else []
    for name in sorted(set(limits) & set(made)):
        problems += check_limit(tool, name, made[name], *limits[name])
    for file in costly_files():
        problems += check_cost(tool, costs, *file)
    print(*problems, f"{len(made)} limits", sep="\n")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
