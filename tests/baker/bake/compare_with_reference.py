"""The third opinion: blends by the C runtime (tube_*.txt, bar_*.txt, layers_*.txt and many.txt, written by test_bake,
test_bake_solid, test_bake_layers and test_bake_many) against the numpy reference, to 1e-5 relative."""
import glob
import os
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "formats", "reference"))
from pliant_reference import Asset  # noqa: E402

TOLERANCE = 1e-5

assets = sorted(path for name in ("tube_*", "bar_*", "layers_*", "many") for path in glob.glob(name + ".pliant"))
if len(assets) < 14:
    sys.exit("expected the six assets of test_bake, four of test_bake_solid, three of test_bake_layers and one of "
             "test_bake_many, found %d: run them first" % len(assets))
failed = 0
for path in assets:
    with open(path, "rb") as file:
        asset = Asset(file.read())
    for line in open(path[: -len(".pliant")] + ".txt"):
        numbers = numpy.array(line.split(), dtype=float)
        weights, runtime = numpy.split(numbers, [asset.pose_count - (asset.layers is not None)])
        runtime = runtime.reshape(-1, 3)
        z, _ = asset.minimise(weights)
        reference = asset.reconstruct(asset.coordinates(z))
        error = numpy.linalg.norm(runtime - reference) / numpy.linalg.norm(reference)
        print("%-28s weights %s: relative difference %.1e" % (path, weights, error))
        failed += not error < TOLERANCE
sys.exit("%d blends differ by more than %g" % (failed, TOLERANCE) if failed else 0)
