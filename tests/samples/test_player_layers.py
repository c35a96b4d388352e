"""Assets of layers in the player: sliders, weights by name, the walk through the layers, equality with the tool's blends.

Usage: test_player_layers.py CASE PLAYER [PLIANT] (player_support.py). Assets come from tests/runtime/tiny_asset.py, but for
the case `tool`, which bakes one.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices: threads of their own only wait for each other
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from layered_tube import tube, write_obj  # noqa: E402
from player_support import make_asset, picture, read_picture, refused, run, shapes, use_window, write_path  # noqa: E402

PANEL = np.s_[240:590, 12:224]  # of a picture of 960 x 600: everything below the facts, on the left
FACTS = np.s_[12:240, 12:224]


def make_layers(folder, layers=3):
    """Ranges and initial weights, again and again: -1 to 1 and 0, 0 to 1.5 and 0.25, -0.5 to 2 and -0.25."""
    return make_asset(folder, "--layers", poses=layers + 1)


def orange(image):
    """The ink of warnings: weights outside their range."""
    return (image[..., 0] > image[..., 2] + 90) & (image[..., 0] > 150)


def dark(image):
    return (image.max(axis=2) < 90).sum()


def case_sliders(folder):
    asset = make_layers(folder)
    shown = {name: picture(asset, folder, "--hud", *arguments, size="960x600")
             for name, arguments in (("initial", ()), ("same", ("--weights=0,0.25,-0.25",)),
                                     ("moved", ("--set", "pose 2=1.5")), ("outside", ("--set", "pose 2=2.25")))}
    assert dark(shown["initial"][PANEL]) > 60, f"{dark(shown['initial'][PANEL])} dark pixels of names and handles"
    assert np.abs(shown["same"][PANEL] - shown["initial"][PANEL]).max() == 0, "the initial weights are not the asset's"
    moved = np.abs(shown["moved"][PANEL] - shown["initial"][PANEL]).max(axis=2) > 40
    rows = np.nonzero(moved.any(axis=1))[0]
    assert 30 < moved.sum() and rows.max() - rows.min() < 50, f"{moved.sum()} pixels in rows {rows}: not one slider moved"
    scene = np.s_[:, 240:]
    assert np.abs(shown["moved"][scene] - shown["initial"][scene]).mean() > 0.5, "a weight does not change the shape"
    for part in (PANEL, FACTS):
        inside, outside = (orange(shown[name][part]).sum() for name in ("moved", "outside"))
        assert outside > inside + 15, f"a weight outside its range: {inside} and {outside} pixels of warning"


def case_many(folder):
    """A search field, a list that scrolls, and nothing beyond the panel."""
    image = picture(make_layers(folder, 14), folder, "--hud", size="960x400")
    panel = image[175:385, 15:197]
    assert dark(panel) > 100, f"{dark(panel)} dark pixels of names and handles"
    beyond = image[175:395, 204:214]  # between the panel's edge and the tube
    assert beyond.min() > 150, "something sticks out of the panel"
    scroll_bar = (np.ptp(panel[60:, -16:], axis=2) < 12) & (panel[60:, -16:].max(axis=2) < 215)
    assert scroll_bar.sum() > 200, f"{scroll_bar.sum()} pixels of a scroll bar"


def case_weights(folder):
    asset = make_layers(folder)
    out = folder / "x.png"
    line = refused(asset, "--screenshot", out, "--weights", "1,1", code=2, number=5902)
    assert "2 weights for 3 layers" in line, line
    for wrong in ("--weights=1,x,0", "--weights=nan,1,1", "--weights=1e39,0,0", "--set=pose 1", "--set=pose 1=x",
                  "--set=pose 1=1,2", "--set=pose 1=1e39", "--set=rest=1", "--set=pose 9=1"):
        refused(asset, "--screenshot", out, wrong, code=2, number=5902)
    _, err = run(asset, "--screenshot", out, "--set=pose 9=1", expected=2)
    assert "hint: the layers of " in err and "pose 1, pose 2, pose 3" in err, err
    refused(asset, "--crowd", "3", "--set=pose 1=1", code=2, number=5942)
    bad = write_path(folder, [[1, 0, -3], [1, 0]], "bad.csv")
    line = refused(asset, "--sequence", folder / "f_%d.png", "--path", bad, code=3, number=5913)
    assert "bad.csv:3: 2 weights for 3 layers" in line, line
    bad = write_path(folder, [[1, 0, 1e39]], "large.csv")
    refused(asset, "--sequence", folder / "f_%d.png", "--path", bad, code=3, number=5913)
    assert not out.exists()
    average = make_asset(folder)
    refused(average, "--screenshot", out, "--set=pose 1=1", code=2, number=5902)
    # What averages refuse is allowed: negative weights, sums of zero, anything outside the ranges.
    asset = make_layers(folder)
    for good in ("--weights=0,0,0", "--weights=-1,1,-3"):
        run(asset, "--screenshot", out, "--size", "64x64", good)


def case_linear(folder):
    """One layer at 1 is its pose in both kinds of blend. Of two the linear blend is another shape: that is what --heat
    shows."""
    asset = make_layers(folder)
    two = shapes(picture(asset, folder, "--heat", "--weights=1,1.5,1", size="450x450"))

    def hot(image):
        return (image[..., 0] - image[..., 1] > 60) & (image.mean(axis=2) < 190)

    for weights in ("1,0,0", "0,1,0", "0,0,1"):
        one = shapes(picture(asset, folder, "--heat", f"--weights={weights}", size="450x450"))
        assert not hot(one).any(), f"{hot(one).sum()} warm pixels where both blends are the layer's pose"
    assert hot(two).mean() > 0.005, "no difference between linear and elastic"
    both = picture(asset, folder, "--both", "--weights=1,1.5,1", size="600x300")
    assert np.abs(both[:, :300] - both[:, 300:]).mean() > 1


def case_modes(folder):
    """Sheet, sequence, crowd, measurement: the walk stays inside the ranges, and given paths need not."""
    asset = make_layers(folder)
    run(asset, "--sheet", folder / "sheet.png", "--size", "120x100")
    sheet = np.asarray(Image.open(folder / "sheet.png").convert("RGB")).astype(float)
    assert sheet.shape[0] > 200 and (sheet[..., 0] - sheet[..., 2] > 25).mean() > 0.01, sheet.shape
    run(asset, "--sequence", folder / "w_%d.png", "--count", "9", "--size", "64x64")
    frames = [np.asarray(Image.open(folder / f"w_{i}.png").convert("RGB")).astype(float) for i in range(9)]
    assert len({frame.tobytes() for frame in frames}) > 4, "the walk stands still"
    one = picture(asset, folder, "--crowd", "1", "--view=0,10", size="300x200")
    assert np.abs(one - picture(asset, folder, "--crowd", "6", "--view=0,10", size="300x200")).mean() > 1
    crowd = json.loads(run(asset, "--crowd", "5", "--frames", "20", "--json")[0])
    assert crowd["layers"] == 3 and crowd["poses"] == 4 and crowd["evaluations"]["median"] >= 5, crowd
    walk = json.loads(run(asset, "--frames", "200", "--json")[0])
    assert walk["layers"] == 3 and walk["largest_outside"] == 0, walk
    path = write_path(folder, [[0, 0, 0], [0, 1.8, 0]])
    given = json.loads(run(asset, "--frames", "20", "--json", "--path", path)[0])
    assert abs(given["largest_outside"] - 0.2) < 1e-4, given
    text, _ = run(asset, "--frames", "4", "--path", path)
    assert "3 layers" in text and "outside" in text, text


def case_key(folder):
    """0 gives all layers their initial weights."""
    asset = make_layers(folder)
    use_window(folder, [asset, "--weights=0.8,2,1"], "save:before.png", "key:0", "save:after.png", size="640x620")
    before, after = (read_picture(folder / f"{name}.png")[360:600, 20:330] for name in ("before", "after"))
    assert orange(before).sum() > 30, "the weight outside its range has no warning"
    assert not orange(after).any(), f"{orange(after).sum()} pixels of warning after the key"


# ------------------------------------------------------------------------------------------------------- a baked asset --

def case_tool(folder):
    """The player's elastic blend is that of `pliant blend`, at every row of a path, also outside the ranges."""
    names = ("rest", "twisted", "bent")
    for name, angles in zip(names, ((0, 0), (1, 0), (0, 1.2))):
        write_obj(folder / f"{name}.obj", tube(*angles))

    def tool(*arguments):
        subprocess.run([sys.argv[3], *map(str, arguments)], cwd=folder, check=True, stdout=subprocess.DEVNULL)

    asset = folder / "tube.pliant"
    tool("bake", *(f"{name}.obj" for name in names), "--blend", "layers", "--range", "bent=-0.5:1", "-o", asset, "-q")
    rows = [[0, 0], [1, 1], [0.5, -0.5], [-0.4, 1.4]]
    path = write_path(folder, rows)
    tool("blend", asset, "--path", path, "-o", "truth_%d.ply")

    def hot(image):
        return (image[..., 0] - image[..., 1] > 60) & (image.mean(axis=2) < 190)

    linear_is_hot = 0
    for row in rows:
        image = picture(asset, folder, "--truth", path, folder / "truth_%d.ply", "--heat", "--view=90,10",
                        f"--weights={row[0]},{row[1]}", size="900x450")
        linear, elastic, _ = np.array_split(shapes(image), 3, axis=1)
        assert not hot(elastic).any(), f"{row}: the elastic blend is not that of the tool"
        linear_is_hot += hot(linear).any()
    assert linear_is_hot >= 1, "the heat shows nothing at all"
    picture(asset, folder, "--truth", path, folder / "truth_%d.ply", "--set", "bent=1", "--hud", size="960x600")


with tempfile.TemporaryDirectory(prefix="pliant_player_") as temporary:
    globals()["case_" + sys.argv[1]](Path(temporary))
