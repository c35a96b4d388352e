"""Cases of glTF for generate.py: a small good file with one edit each. Also what tests/baker/input/gltf makes its files
with."""
import base64
import copy
import json
import math
import struct

CASES = {}
FORMATS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Gltf:
    """The JSON and the bytes of one buffer."""

    def __init__(self):
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                     "meshes": [], "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0}]}
        self.bytes = b""

    def view(self, data):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data
        self.json["buffers"][0]["byteLength"] = len(self.bytes)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, rows, component=5126, **more):
        """Rows of numbers, or plain numbers."""
        rows = [row if isinstance(row, (tuple, list)) else (row,) for row in rows]
        data = b"".join(struct.pack(f"<{len(row)}{FORMATS[component]}", *row) for row in rows)
        self.json["accessors"].append({"bufferView": self.view(data), "componentType": component, "count": len(rows),
                                       "type": TYPES[len(rows[0])], **more})
        return len(self.json["accessors"]) - 1

    def mesh(self, vertices, faces, targets=(), names=(), **attributes):
        primitive = {"attributes": {"POSITION": self.accessor(vertices), **attributes},
                     "indices": self.accessor([i for face in faces for i in face], 5125)}
        if targets:
            primitive["targets"] = [{"POSITION": self.accessor(target)} for target in targets]
        self.json["meshes"].append({"name": "body", "primitives": [primitive],
                                    **({"extras": {"targetNames": list(names)}} if names else {})})
        return primitive

    def animation(self, name, *channels):
        """Channels: (node, path, interpolation, times, rows)."""
        animation = {"name": name, "channels": [], "samplers": []}
        for node, path, interpolation, times, rows in channels:
            animation["channels"].append({"sampler": len(animation["samplers"]), "target": {"node": node, "path": path}})
            animation["samplers"].append({"input": self.accessor(times), "output": self.accessor(rows),
                                          "interpolation": interpolation})
        self.json.setdefault("animations", []).append(animation)

    def glb(self):
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        data = self.bytes + b"\0" * (-len(self.bytes) % 4)
        chunks = (struct.pack("<II", len(text), 0x4E4F534A) + text
                  + (struct.pack("<II", len(data), 0x004E4942) + data if data else b""))
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def gltf(self, uri=None):
        """As text; without a uri the buffer is in it."""
        out = copy.deepcopy(self.json)
        out["buffers"][0]["uri"] = uri or "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        return json.dumps(out).encode()


def bend(vertex):
    return 0.3 * vertex[2] * vertex[2], 0.0, 0.0


def blob(mesh):
    """The good mesh with one target, "bent"."""
    out = Gltf()
    out.mesh(mesh.vertices, mesh.faces, [[bend(v) for v in mesh.vertices]], ["bent"])
    return out


def grid(side):
    vertices = [(x, y, 0.3 * math.sin(x + y)) for x in range(side) for y in range(side)]
    corners = [side * x + y for x in range(side - 1) for y in range(side - 1)]
    return vertices, [face for i in corners for face in ((i, i + side, i + 1), (i + 1, i + side, i + side + 1))]


def draco_fan(steps):
    """An edgebreaker stream whose symbols join one vertex again and again: each S walks around all of its faces."""
    def number(value):
        return bytes([value & 127 | 128]) + number(value >> 7) if value > 127 else bytes([value])
    bits = "111" * steps + "10000" * (steps - 1) # E, then S C C
    bits += "0" * (-len(bits) % 8)
    symbols, count = int(bits[::-1], 2).to_bytes(len(bits) // 8, "little"), steps + 3 * (steps - 1)
    header = b"DRACO\x02\x02\x01\x01\0\0\0" + number(3 * steps) + number(count) + b"\0" + number(count) + number(steps - 1)
    return header + b"\0" + number(len(symbols)) + symbols + b"\x80\x01" + bytes(65)


def draco_triangle(table, data_type=9, values=struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)):
    """An edgebreaker stream with valences, which has six tables of symbols."""
    return (b"DRACO\x02\x02\x01\x01\0\0\x02" + bytes([3, 1, 0, 1, 0, 0, 255, 1, 1]) + 6 * table
            + bytes([1, 255, 0, 0, 1, 0, data_type, 3, 0, 0, 0]) + values)


def add_cases(good):
    """Registers the cases; good() is the mesh of generate.py."""
    def case(name, edit=lambda g: None, file="a.glb", write=lambda g: g.glb()):
        def make(folder):
            gltf = blob(good())
            edit(gltf)
            (folder / file).write_bytes(write(gltf))
        CASES[name] = make

    def edited(name, *path, value):
        def edit(gltf):
            place = gltf.json
            for key in path[:-1]:
                place = place[key]
            place[path[-1]] = value
        case(name, edit)

    primitive = ("meshes", 0, "primitives", 0)
    case("gltf_good")
    case("gltf_with_others")
    case("gltf_text", file="a.gltf", write=lambda g: g.gltf())
    CASES["gltf_hash_in_name"] = lambda folder: (folder / "a#b.obj").write_text((folder / "good.obj").read_text())
    case("gltf_choice_unknown")
    case("gltf_no_time", lambda g: g.animation("Run", (0, "weights", "LINEAR", [0, 1], [0, 1])))
    case("gltf_time_not_a_number", lambda g: g.animation("Run", (0, "weights", "LINEAR", [0, 1], [0, 1])))
    case("gltf_time_after_end", lambda g: g.animation("Run", (0, "weights", "LINEAR", [0, 1], [0, 1])))
    case("gltf_animation_unknown", lambda g: g.animation("Run", (0, "weights", "LINEAR", [0, 1], [0, 1])))
    case("gltf_keys", lambda g: g.animation("Run", (0, "weights", "LINEAR", [1, 0], [0, 1])))
    case("gltf_animation_of_rig", lambda g: g.animation("Rig|Run", (0, "weights", "LINEAR", [0, 1], [0, 1])))
    case("gltf_target_unknown")
    case("gltf_target_misspelt")
    case("gltf_one_target")

    def many(gltf):
        gltf.json["meshes"] = []
        gltf.mesh(good().vertices, good().faces,
                  [[(0.01 * k * v[2] ** 2, 0, 0) for v in good().vertices] for k in range(1, 66)])
    case("gltf_many_targets", many)
    case("gltf_vrm", file="a.vrm", write=lambda g: g.glb())

    def lone_animation(gltf):
        gltf.animation("Run", (0, "weights", "LINEAR", [0, 3], [0, 1]))
        gltf.json["meshes"][0]["primitives"][0].pop("targets")
        gltf.json["animations"][0]["channels"][0]["target"]["path"] = "translation"
    case("gltf_one_pose_of_animation", lone_animation)
    case("gltf_one_pose", lambda g: g.json["meshes"][0]["primitives"][0].pop("targets"))

    case("gltf_not_gltf", write=lambda g: b"\x89PNG\r\n" + bytes(64))
    case("gltf_cut_off", write=lambda g: g.glb()[:-100])
    case("gltf_json_damaged", write=lambda g: g.glb().replace(b'"asset"', b'"asset,'))
    case("gltf_number", file="a.gltf", write=lambda g: g.gltf().replace(b'"asset":', b'"extras":1e400,"asset":'))
    case("gltf_objects", file="a.gltf", write=lambda g: b'{"extras":[' + b"{}," * 3000000 + b"{}]}")
    case("gltf_nesting", file="a.gltf", write=lambda g: b'{"asset":' + b"[" * 1000000)
    edited("gltf_initial_weight", "meshes", 0, "weights", value=[1e8])
    edited("gltf_version", "asset", "version", value="1.0")
    edited("gltf_least_version", "asset", "minVersion", value="2.1")
    edited("gltf_extension", "extensionsRequired", value=["KHR_materials_unlit", "ACME_secret"])
    edited("gltf_instancing", "nodes", 0, "extensions",
           value={"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}})
    edited("gltf_wrong_type", "accessors", 0, "count", value="many")
    edited("gltf_index", *primitive, "indices", value=99)
    edited("gltf_texture", "materials", value=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 7}}}])
    edited("gltf_negative", *primitive, "indices", value=-1)
    edited("gltf_accessor_outside", "accessors", 0, "byteOffset", value=64)
    edited("gltf_view_outside", "bufferViews", 0, "byteLength", value=1000000)
    edited("gltf_huge_count", "accessors", 0, "count", value=4294967295)
    edited("gltf_huge_numbers", "bufferViews", 0, "byteOffset", value=9007199254740992)
    edited("gltf_huge_sparse", "accessors", 0, "sparse",
           value={"count": 1 << 40, "indices": {"bufferView": 0, "componentType": 5125},
                  "values": {"bufferView": 0}})
    edited("gltf_accessor_type", "accessors", 0, "type", value="VEC4")
    edited("gltf_component_type", "accessors", 0, "componentType", value=5124)
    edited("gltf_no_triangles", *primitive, "mode", value=1)
    edited("gltf_node_circle", "nodes", value=[{"mesh": 0, "children": [1]}, {"children": [0]}])
    edited("gltf_target_count", *primitive, "targets", 0, "POSITION", value=1)

    def instances(gltf):
        gltf.json.update(scenes=[], nodes=[{"mesh": 0}] * 60000)
        del gltf.json["scene"]
    case("gltf_instances", instances)

    def corners(gltf):
        mesh = gltf.json["meshes"][0]
        mesh["primitives"][0]["indices"] = gltf.accessor([0, 1, 2] * 10000, 5121)
        mesh["primitives"] *= 1000
    case("gltf_shared_corners", corners)
    edited("gltf_shared_names", "meshes", 0, "name", value="n" * 257)
    edited("gltf_zero_in_name", "meshes", 0, "extras", value={"targetNames": ["a\0b"]})

    def zero_keys(gltf):
        material = {}
        for _ in range(40):
            material = {"": material, "\0": 0}
        gltf.json["materials"] = [material]
    case("gltf_zero_keys", zero_keys)
    edited("gltf_target_name", "meshes", 0, "extras", value={"targetNames": ["t" * 257]})

    def weights(gltf):
        gltf.json["nodes"] += [{"mesh": 0}] * 3000
        gltf.json["meshes"][0]["primitives"][0]["targets"] += [{}] * 3000
    case("gltf_many_weights", weights)

    def skins(gltf):
        matrices = gltf.accessor([(0,) * 16] * 10000)
        gltf.json["skins"] = [{"joints": [0], "inverseBindMatrices": matrices}] * 1000
    case("gltf_shared_skins", skins)

    case("gltf_many_joints", lambda g: g.json.update(skins=[{"joints": [0] * 600000}]))
    case("gltf_many_nodes", lambda g: g.json.update(nodes=g.json["nodes"] + [{}] * 300000))

    case("gltf_images_beyond", lambda g: g.json.update(images=[{"uri": "a.png"}] * 4097))

    def keys(gltf):
        times = gltf.accessor(range(30000))
        gltf.json["animations"] = [{"channels": [], "samplers": [{"input": times, "output": times}] * 5000}]
    case("gltf_shared_keys", keys)

    def deltas(gltf):
        primitive = gltf.json["meshes"][0]["primitives"][0]
        primitive["attributes"]["POSITION"] = shape = gltf.accessor([(i, i % 7, i % 3) for i in range(3000)])
        primitive["targets"] = [{"POSITION": shape}] * 3000
        gltf.animation("all", (0, "weights", "STEP", [0], [1] * 3000))
    case("gltf_shared_deltas", deltas)

    def empty_targets(gltf):
        gltf.animation("Run", (0, "translation", "STEP", [0], [(0, 0, 0)]))
        positions, indices = gltf.accessor([(0, 0, 0), (1, 0, 0), (0, 1, 0)]), gltf.accessor([0, 1, 2], 5121)
        primitive = {"attributes": {"POSITION": positions}, "indices": indices, "targets": [{}] * 300}
        gltf.json["meshes"] = [{"primitives": [primitive] * 60, "weights": [1] * 300}]
        gltf.json.update(scenes=[], nodes=[{"mesh": 0, "weights": [2] * 300}, {"mesh": 0}] * 300)
        del gltf.json["scene"]
    case("gltf_empty_targets", empty_targets)

    def weights_of_nodes(gltf):
        gltf.animation("Run", (0, "translation", "STEP", [0], [(0, 0, 0)]))
        gltf.json["meshes"][0]["primitives"][0]["targets"] = [{}] * 2000
        gltf.json.update(scenes=[], nodes=[{"mesh": 0}] * 2000)
        del gltf.json["scene"]
    case("gltf_weights_of_nodes", weights_of_nodes)

    def lines(gltf):
        first = gltf.json["meshes"][0]["primitives"][0]
        gltf.json["meshes"][0]["primitives"].append({"attributes": first["attributes"], "mode": 1})
    case("gltf_lines", lines)

    def corner(gltf):
        indices = gltf.json["accessors"][gltf.json["meshes"][0]["primitives"][0]["indices"]]
        start = gltf.json["bufferViews"][indices["bufferView"]]["byteOffset"]
        gltf.bytes = gltf.bytes[:start] + struct.pack("<I", 9001) + gltf.bytes[start + 4:]
    case("gltf_corner", corner)

    def not_finite(gltf):
        gltf.bytes = struct.pack("<f", float("nan")) + gltf.bytes[4:]
    case("gltf_nan", not_finite)

    def draco(gltf):
        view = gltf.view(b"DRACO\x02\x02\x01\x00\x00\x00" + b"\xff" * 40)
        gltf.json["meshes"][0]["primitives"][0]["extensions"] = {
            "KHR_draco_mesh_compression": {"bufferView": view, "attributes": {"POSITION": 0}}}
    case("gltf_draco_damaged", draco)

    def compressed(name, data):
        def edit(gltf):
            gltf.json["meshes"][0]["primitives"][0]["extensions"] = {
                "KHR_draco_mesh_compression": {"bufferView": gltf.view(data), "attributes": {"POSITION": 0}}}
        case(name, edit)
    compressed("gltf_draco_metadata", b"DRACO\x02\x02\x01\x01\x00\x80" + b"\x01" * 40)
    compressed("gltf_draco_fan", draco_fan(20000))

    compressed("gltf_draco_bool", draco_triangle(b"\0", 11, bytes([0, 0, 0, 2, 0, 0, 0, 255, 0])))

    def tables(gltf):
        of_a_million = bytes([1, 1, 18, 1, 2, 0, 64, 1, 0])
        extension = {"bufferView": gltf.view(draco_triangle(of_a_million)), "attributes": {"POSITION": 0}}
        gltf.json["accessors"][0]["count"] = 3
        gltf.json["meshes"][0]["primitives"] = [
            {"attributes": {"POSITION": 0}, "extensions": {"KHR_draco_mesh_compression": extension}}] * 400
    case("gltf_draco_tables", tables)

    def meshopt(name, view_length=1560, **more):
        """The positions, 130 rows of 12 bytes, as if compressed into bytes that are not."""
        def edit(gltf):
            offset = gltf.json["bufferViews"][gltf.view(b"\xa0" + b"\x55" * 399)]["byteOffset"]
            extension = {"buffer": 0, "byteOffset": offset, "byteLength": 400, "byteStride": 12, "count": 130,
                         "mode": "ATTRIBUTES", **more}
            gltf.json["bufferViews"].append({"buffer": 0, "byteLength": view_length,
                                             "extensions": {"EXT_meshopt_compression": extension}})
            gltf.json["accessors"][0]["bufferView"] = len(gltf.json["bufferViews"]) - 1
        case(name, edit)
    meshopt("gltf_meshopt_damaged")
    meshopt("gltf_meshopt_mode", mode="LINES")
    meshopt("gltf_meshopt_filter", mode="TRIANGLES", byteStride=4, count=390, filter="OCTAHEDRAL")
    meshopt("gltf_meshopt_stride", byteStride=6)
    meshopt("gltf_meshopt_count", count=131)
    meshopt("gltf_meshopt_huge", 4294967295 * 12, count=4294967295)
    meshopt("gltf_meshopt_outside", byteLength=1000000)

    def skinned(name, joint, weight, **accessor):
        def edit(gltf):
            count = len(good().vertices)
            attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"]
            attributes["JOINTS_0"] = gltf.accessor([(joint, 0, 0, 0)] * count, 5121, **accessor)
            attributes["WEIGHTS_0"] = gltf.accessor([(1, 0, 0, weight)] * count)
            gltf.json["nodes"][0]["skin"] = 0
            gltf.json["skins"] = [{"joints": [0]}]
        case(name, edit)
    skinned("gltf_joint", 7, 0)
    skinned("gltf_joint_normalized", 7, 0, normalized=True)
    skinned("gltf_joint_weight", 0, float("nan"))

    def image(gltf):
        gltf.json["images"] = [{"uri": "skin.png"}]
    case("gltf_missing_image", image)

    def private(folder):
        gltf = blob(good())
        gltf.json["images"] = [{"uri": "good.obj"}]
        (folder / "a.gltf").write_bytes(gltf.gltf())
    CASES["gltf_image_of_no_kind"] = private

    for name, uri in (("gltf_missing_buffer", "nowhere.bin"), ("gltf_outside_folder", "../../../../../../etc/passwd"),
                      ("gltf_absolute", "/etc/passwd"), ("gltf_url", "https://example.org/a.bin"),
                      ("gltf_escaped", "%2e%2e/%2e%2e/etc/passwd"), ("gltf_command", "$(touch made)`touch made`"),
                      ("gltf_base64_damaged", "data:application/octet-stream;base64,*!*")):
        case(name, file="a.gltf", write=lambda g, uri=uri: g.gltf(uri))

    def beside(folder, size):
        gltf = blob(good())
        (folder / "parts").mkdir()
        (folder / "parts/my mesh.bin").write_bytes(gltf.bytes[:size])
        (folder / "a.gltf").write_bytes(gltf.gltf("parts/my%20mesh.bin"))
    CASES["gltf_buffer_beside"] = lambda folder: beside(folder, None)

    def many_buffers(folder):
        gltf = blob(good())
        with open(folder / "large.bin", "wb") as file:
            file.truncate(8 << 20)
        gltf.json["buffers"] += [{"byteLength": 0, "uri": "here/" * (i % 16) + "large.bin"} for i in range(200)]
        (folder / "here").symlink_to(".")
        (folder / "a.gltf").write_bytes(gltf.gltf())
    CASES["gltf_many_buffers"] = many_buffers

    def many_images(folder):
        gltf = blob(good())
        view = gltf.view(b"\x89PNG\r\n\x1a\n" + bytes(4 << 20))
        gltf.json["bufferViews"] += [{**gltf.json["bufferViews"][view], "byteLength": 4 << 20} for _ in range(2)]
        gltf.json["images"] = [{"bufferView": view, "mimeType": "image/png"}] * 200 + [{"bufferView": view + 1}]
        gltf.json["images"] += [{"bufferView": view + 2}, {"bufferView": view + 1}]
        gltf.json["textures"] = [{"source": i} for i in range(203)]
        (folder / "a.glb").write_bytes(gltf.glb())
    CASES["gltf_many_images"] = many_images

    def many_attributes(folder):
        gltf = Gltf()
        large = gltf.mesh(*grid(150), [[(0, 0, 0.1)] * 22500], ["up"])
        small = gltf.mesh([(0, 0, 1), (1, 0, 1), (0, 1, 1)], [(0, 1, 2)], [[(0, 0, 0.1)] * 3])
        colour = gltf.accessor([(0.0, 0.0, 0.0, 1.0)] * 3)
        small["attributes"].update({f"COLOR_{i}": colour for i in range(400)})
        gltf.json["meshes"] = [{"primitives": [large, small]}]
        (folder / "a.glb").write_bytes(gltf.glb())
    CASES["gltf_many_attributes"] = many_attributes

    def inputs(folder):
        gltf = blob(good())
        gltf.json["images"] = [{"uri": "skin.png"}]
        (folder / "parts").mkdir()
        (folder / "parts/b.bin").write_bytes(gltf.bytes)
        (folder / "skin.png").write_bytes(b"picture")
        (folder / "a.gltf").write_bytes(gltf.gltf("parts/b.bin"))
    CASES["output_is_gltf_buffer"] = CASES["output_is_gltf_image"] = inputs
    CASES["gltf_short_buffer"] = lambda folder: beside(folder, -8)

    def link(folder):
        (folder / "inside").mkdir()
        gltf = blob(good())
        (folder / "outside.bin").write_bytes(gltf.bytes)
        (folder / "inside/link.bin").symlink_to("../outside.bin")
        (folder / "inside/a").symlink_to("..")  # another link beside it changes nothing
        (folder / "inside/a.gltf").write_bytes(gltf.gltf("link.bin"))
    CASES["gltf_link_outside"] = link
