"""The player as a tool and as a picture: keys and mouse, sliders, names, contrast, composition.

Usage: test_player_view.py CASE PLAYER (player_support.py).
"""
import re
import sys
import tempfile
from pathlib import Path

from player_support import (ROOT, hot, make_asset, make_named, make_truth, picture, read_picture, run, shapes, skip, thirds,
                            use_window, warm, write_path)

import numpy as np  # after player_support, which chooses its threads


def case_tool(folder):
    """Keys and mouse: the scene is moved and framed again, pictures are written and recorded, a weight is typed."""
    asset = make_asset(folder, poses=4)
    (folder / "tube_001.png").write_bytes(b"not mine")
    # The shape stands still; the line of the path changes in every frame, which use_window.py waits for.
    path = write_path(folder, [[1, 0, 1, 0], [1, 0, 1, 0]])
    use_window(folder, [asset, "--path", path], "key:F", "save:framed.png", "drag:2,450,200,480,230", "save:moved.png",
               "key:F", "shift-drag:1,450,200,480,230", "key:P", "key:V", "key:V", "save:shifted.png", "key:S",
               "ctrl-click:282,352", "type:0.75\n", "save:typed.png", size="640x800")
    framed, moved, shifted, typed = (read_picture(folder / f"{name}.png")
                                     for name in ("framed", "moved", "shifted", "typed"))
    scene = np.s_[300:500, 340:]
    for image in (moved, shifted):
        back = np.roll(image, (-30, -30), axis=(0, 1))
        still = np.abs(image - framed)[scene].mean()
        assert np.abs(back - framed)[scene][:, :-30].mean() < 8 < still, "not moved by (30, 30)"
    assert (folder / "tube_001.png").read_bytes() == b"not mine"
    assert warm(read_picture(folder / "tube_002.png")).mean() > 0.01, "P wrote no picture of the scene"
    frames = sorted(path.name for path in (folder / "tube_001").iterdir())
    assert frames and frames[0] == "frame_0000.png" and len(frames) == int(frames[-1][6:10]) + 1, frames
    assert np.abs(typed - shifted)[scene].mean() > 0.5, "a typed weight does not change the shape"


def case_drawer(folder):
    """Any mix has sliders, also those that no point of the polygon has; of two poses the panel is flat."""
    asset = make_asset(folder, poses=5)
    column = np.s_[200:372, 12:224]  # between facts and polygon, of a picture of 960 x 600
    one, other = (picture(asset, folder, "--hud", "--weights", weights, size="960x600")
                  for weights in ("1,0,1,0,0", "1,0,3,0,0"))
    rows = np.nonzero((np.abs(one - other)[column].max(axis=2) > 60).any(axis=1))[0]
    assert len(rows) and np.ptp(rows) > 25, f"two of five sliders move, not those in rows {rows}"
    flat = picture(make_asset(folder, poses=2), folder, "--hud", size="960x600")
    assert (flat[300:400, 12:224].max(axis=2) < 100).sum() == 0, "the panel of two poses is not flat"


def case_names(folder):
    """Long names lose their middle, not their end; letters of other scripts come from a font of the system."""
    def panel(*names):
        return picture(make_named(folder, *names), folder, "--hud", size="960x600")[372:588, 12:223]

    long = "unitSphereWithALongName3_def"
    boxes, japanese = panel("\ue000\ue001", long + "X", long + "X"), panel("笑顔", long + "X", long + "Y")
    other = panel("口開", "ж" * 13, "ж" * 13)
    top = np.s_[:40]  # the label of the first corner
    assert np.abs(boxes - japanese)[150:].max() > 60, "two long names read the same"
    assert min(other[150:, :6].max(axis=2).min(), other[150:, -6:].max(axis=2).min()) > 200, "a name leaves the panel"
    assert (other[150:].max(axis=2) < 110).sum() > 60, "no Cyrillic letters"
    if np.abs(japanese - boxes)[top].max() == 0:
        known = re.findall(r'"(/usr/[^"]+)"', (ROOT / "samples/player/panels/overlay.cpp").read_text())
        assert not any(Path(path).exists() for path in known), "boxes for Japanese letters in spite of a font"
        skip("no font with Japanese letters is installed, for example fonts-wqy-microhei")
    assert np.abs(japanese - other)[top].max() > 60, "all Japanese letters look the same"


def luminance(image):
    """As WCAG defines it."""
    share = image / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722)


def case_contrast(folder):
    """Captions over the scene: the darkest pixel of a text against the darkest one of what it stands on."""
    asset = make_asset(folder, poses=3)
    for more, view in ((("--both",), "30,12"), (("--both",), "30,60"), (("--linear",), "30,85")):
        shown = picture(asset, folder, "--heat", *more, f"--view={view}", size="900x450")
        bare = picture(asset, folder, *more, f"--view={view}", size="900x450")
        # A caption's plate is paler than anything of the scene: rows of pixels next to letters.
        plate = (shown.min(axis=2) > 247) & (luminance(shown) - luminance(bare) > 0.05)
        rows, columns = np.nonzero(plate[330:])
        assert len(rows) > 300, "captions have no plate"
        text = luminance(shown[330:][rows.min():rows.max() + 1, columns.min():columns.max() + 1])
        assert (luminance(shown[330:])[plate[330:]].min() + 0.05) / (text.min() + 0.05) > 4.5


def case_composition(folder):
    """Shape and shadow fill the picture and stay inside; blends side by side are in the middle, their names below them."""
    asset = make_asset(folder)
    for weights in ("1,0,0", "0,1,0", "1,1,1"):
        one = warm(picture(asset, folder, "--weights", weights, size="320x240"))
        rows, columns = np.nonzero(one)
        assert max(np.ptp(rows) / 240, np.ptp(columns) / 320) > 0.55, f"{weights}: the shape is small"
        both = picture(asset, folder, "--both", "--weights", weights, size="640x240")
        floor = np.abs(both - both[:, :1]).max(axis=2) > 60
        rows, columns = np.nonzero(floor)
        assert columns.min() > 8 and columns.max() < 632 and rows.max() < 236, f"{weights}: cut off at the edge"
        assert abs(columns.min() - (640 - columns.max())) < 40, f"{weights}: not in the middle"
    heat = picture(asset, folder, "--both", "--heat", size="900x450")
    feet = np.nonzero(hot(heat)[80:].any(axis=1))[0].max() + 80
    ink = np.nonzero((heat[feet + 3:].max(axis=2) < 135).any(axis=1))[0]
    assert len(ink) and ink.min() < 90, "no name below the shapes"
    # Nothing of a shape with no distance is white: that is a shape without colours.
    truth = make_truth(asset, folder)
    image = picture(asset, folder, "--truth", *truth, "--heat", "--weights", "1,0,0", size="900x450")
    _, elastic, unreduced = thirds(image)
    blue = [(part[80:-90, :, 2] - part[80:-90, :, 0] > 22).mean() for part in (elastic, unreduced)]
    assert blue[0] > 0.02 > blue[1], f"no distance and the reference look the same: {blue}"


def case_wire(folder):
    asset = make_asset(folder)
    plain, wire = (picture(asset, folder, *more) for more in ((), ("--wire",)))
    assert (np.abs(plain - wire).max(axis=2) > 20)[warm(plain)].mean() > 0.1, "--wire draws no edges"
    assert np.abs(plain - wire)[~warm(plain) & ~warm(wire)].mean() < 2, "--wire changes what is not the shape"


with tempfile.TemporaryDirectory(prefix="pliant_player_") as temporary:
    globals()["case_" + sys.argv[1]](Path(temporary))
