"""test_reference.py READER FOLDER: the reference reader opens every golden asset and lists its chunks; of the one with a
scene it reads parts, materials and image as they were written, and damage to them is refused. Control characters in names
are not printed."""
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

reader, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path[:0] = [str(reader.parent), str(folder.parent / "runtime"), str(folder.parent)]
import numpy as np  # noqa: E402
import tiny_scene  # noqa: E402
from asset_checksums import with_checksums  # noqa: E402
from pliant_reference import Asset  # noqa: E402


def read(path, code=0):
    result = subprocess.run([sys.executable, "-B", reader, path], capture_output=True, text=True, timeout=60)
    assert result.returncode == code, (path, result.returncode, result.stdout, result.stderr)
    return result.stdout + result.stderr


def check_scene(path):
    assert read(path).endswith("scene: 2 parts, 1 materials, 1 images\n"), read(path)
    asset = Asset(path.read_bytes())
    scene = asset.scene()
    first, second = scene.parts
    assert [first["vertex_count"], second["first_vertex"], second["vertex_count"]] == [40, 40, 41], scene.parts
    assert (first["material"], second["material"]) == (0, None) and len(first["faces"]) == 60 and second["faces"].min() >= 40
    assert (np.allclose(second["attributes"]["COLOR_0"][:, 0], np.arange(41) / 40)
            and first["attributes"]["TEXCOORD_0"].shape == (40, 2))
    assert scene.images == [("image/png", tiny_scene.striped_image())] and scene.materials[0]["alphaMode"] == "MASK"


def damaged(blob, old, new):
    """With another text of the same length in the chunk GLTF, whose checksum nobody compares here."""
    assert len(old) == len(new) and blob.count(old) > 0, old
    return blob.replace(old, new)


def with_a_bell(blob):
    """With \\a for the first letter of the first pose's name."""
    (count,) = struct.unpack_from("<I", blob, 24)
    (name,) = (struct.unpack_from("<Q", blob, entry + 8)[0] for entry in range(64, 64 + 32 * count, 32)
               if blob[entry:entry + 4] == b"NAME")
    return with_checksums(blob[:name] + b"\a" + blob[name + 1:])


golden = sorted(folder.glob("*.pliant"))
assert len(golden) >= 8, golden
for path in golden:
    tags = re.search(r"^chunks (.*)$", read(path), re.MULTILINE).group(1).split()
    assert (len(tags) == struct.unpack_from("<I", path.read_bytes(), 24)[0]
            and any(tag.startswith("CERT:") for tag in tags)), tags
check_scene(folder / "format_1_3_scene.pliant")
whole = (folder / "format_1_3_scene.pliant").read_bytes()
with tempfile.TemporaryDirectory(prefix="pliant_golden_") as temporary:
    bad = pathlib.Path(temporary) / "bad.pliant"
    for old, new in ((b'"material": 0', b'"material": 1'), (b'"vertex_count": 41', b'"vertex_count": 40'),
                     (b'"meshes"', b'"mashes"'),
                     (b'"first_vertex": 40', b'"first_vertex": 39'), (b'"count": 180', b'"count": 999'), (b"glTF", b"glTG"),
                     (b'"byteOffset": 0,', b'"byteOffset":-4,')):
        bad.write_bytes(damaged(whole, old, new))
        assert "GLTF" in read(bad, code=3)
    bad.write_bytes(with_a_bell(whole))
    said = read(bad)
    assert "\a" not in said and "(\\x07" in said, said
print(f"{len(golden)} assets")
