"""The baker and the player are built in layers. The order stands in the tables of their READMEs (baker/README.md,
samples/player/README.md): a file may include from its own room and from rooms above it in the table. Every folder with
sources is in the table, and every room of the table exists. Units (x.h with x.cpp) include each other in no circle.
The functions of the C runtime are called only in those rooms of the baker that open assets."""
import re
from pathlib import PurePosixPath

from rule_includes import INCLUDE, resolve
from tree import C_SUFFIXES, Plant

# The folder of a layered room, and the README with its table.
LAYERED = {"baker": "baker/README.md", "samples/player": "samples/player/README.md"}
HEADINGS = ("## Rooms", "## How it is built")
ROW = re.compile(r"^\| `([\w/]+)/` \|")

ROOMS_WITH_RUNTIME = ("baker/output/", "baker/cli/", "baker/python/")
RUNTIME_CALL = re.compile(r"\bpliant_(?!format_)[a-z0-9_]+\s*\(")  # the format's helpers are for everybody

UNITS_IN = ("baker", "samples")  # of the runtime the calls are looked at (cycles.py)


def table_of(tree, readme):
    """The rooms of the first table below the heading, in its order."""
    rows = []
    in_section = False
    for _, line in tree.lines(readme):
        if line.startswith("## "):
            in_section = line.strip() in HEADINGS
        match = in_section and ROW.match(line)
        if match:
            rows.append(match.group(1))
    return rows


def room_of(path, base, rooms):
    """The room of the table in which a file lies: the longest one that matches, or None."""
    inside = PurePosixPath(path).relative_to(base).as_posix()
    fitting = [room for room in rooms if inside.startswith(room + "/")]
    return max(fitting, key=len, default=None)


def includes_of(tree, path):
    """(line number, name, file in the tree) of every include of ours."""
    for number, line in tree.lines(path):
        match = INCLUDE.match(line)
        target = match and resolve(tree, path, match.group(2))
        if target:
            yield number, match.group(2), target


def judge_room(tree, base, readme):
    rooms = table_of(tree, readme)
    faults = [f"{readme}:1: `{room}/` is in the table and not in {base}/"
              for room in rooms if not tree.files(f"{base}/{room}")]
    if not rooms:
        return [f"{readme}:1: no table of rooms below {' or '.join(HEADINGS)}"]
    for path in tree.files(base, C_SUFFIXES):
        room = room_of(path, base, rooms)
        if room is None:
            faults.append(f"{path}:1: its folder is not in the table of {readme}")
            continue
        for number, name, target in includes_of(tree, path):
            inner = target.startswith(base + "/") and room_of(target, base, rooms)
            if inner and rooms.index(inner) > rooms.index(room):
                faults.append(f"{path}:{number}: {name}: {room}/ stands above {inner}/ in the table of {readme}")
    return faults


def unit_of(path):
    return path.rsplit(".", 1)[0]


def unit_graph(tree):
    """Unit -> {unit it includes: place of the include}."""
    graph = {}
    for base in UNITS_IN:
        for path in tree.files(base, C_SUFFIXES):
            uses = graph.setdefault(unit_of(path), {})
            for number, _, target in includes_of(tree, path):
                if unit_of(target) != unit_of(path):
                    uses.setdefault(unit_of(target), f"{path}:{number}")
    return graph


def circles(graph):
    """A line for every include that closes a circle of units."""
    faults = []
    state = {}

    def visit(unit, way):
        state[unit] = "open"
        for target, place in sorted(graph.get(unit, {}).items()):
            if state.get(target) == "open":
                circle = way[way.index(target):] + [target]
                places = [graph[one][next_one] for one, next_one in zip(circle, circle[1:])]
                faults.append(f"{place}: circle of units: {' -> '.join(circle)} ({', '.join(places)})")
            elif target not in state:
                visit(target, way + [target])
        state[unit] = "done"

    for unit in sorted(graph):
        if unit not in state:
            visit(unit, [unit])
    return faults


def calls_of_runtime(tree):
    faults = []
    for path in tree.files("baker", C_SUFFIXES):
        if path.startswith(ROOMS_WITH_RUNTIME):
            continue
        for number, line in tree.lines(path):
            match = RUNTIME_CALL.search(line.split("//")[0])
            if match:
                faults.append(f"{path}:{number}: {match.group(0)}...): the C runtime is called only in "
                              f"{', '.join(room[len('baker/'):] for room in ROOMS_WITH_RUNTIME)}")
    return faults


def check(tree):
    faults = [fault for base, readme in LAYERED.items() for fault in judge_room(tree, base, readme)]
    return faults + circles(unit_graph(tree)) + calls_of_runtime(tree)


PLANTS = [
    Plant("baker/base/mesh/planted.cpp", '#include "elastic/energy/energy.h"\n', "base/mesh/ stands above elastic/energy/"),
    Plant("baker/base/weights/planted.cpp", '#include "../mesh/surface.h"\n', "base/weights/ stands above base/mesh/"),
    Plant("baker/bake/planted.h", '#include "cli/verbs.h"\n', "bake/ stands above cli/"),
    Plant("baker/planted/planted.cpp", "int planted;\n", "its folder is not in the table"),
    Plant("baker/README.md", "\n## Rooms\n\n| `planted/` | nothing |\n", "`planted/` is in the table"),
    Plant("samples/player/draw/planted.cpp", '#include "run/options.h"\n', "draw/ stands above run/"),
    Plant("samples/creature/field.h", '#include "creature.h"\n', "circle of units"),
    Plant("baker/base/mesh/surface.h", '#include "base/mesh/align.h"\n', "circle of units"),
    Plant("baker/bake/planted.cpp", "auto planted = pliant_solver_desc_default();\n", "the C runtime is called only in"),
]
