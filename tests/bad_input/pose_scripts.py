"""Cases of `pliant pose` for generate.py: solid.msh and a script, mostly a good one with one edit."""
import random

import solids

CASES = {}
HOLD, BEND = "box 0 0 0  1 1 0.1  hold\n", "box 0 0 0.9  1 1 1  turn 0.5 0.5 0.5  1 0 0  30\n"


def case(name, script=HOLD + BEND, **files):
    def generate(folder):
        solids.write_solid(folder / "solid.msh", solids.solid())
        for file, content in {"script.txt": script, **files}.items():
            (solids.write_solid if isinstance(content, solids.Solid) else solids.write)(folder / file, content)
    CASES[name] = generate


def first_line(name, line):
    case(name, line + "\n" + HOLD + BEND)


case("pose_empty", "# nothing\n\n")
first_line("pose_region", "cube 0 0 0 1 1 1 hold")
first_line("pose_motion", "box 0 0 0 1 1 0.5 lift 1")
first_line("pose_no_motion", "vertices 1 2 3")
first_line("pose_too_few_numbers", "box 0 0 0 1 1 hold")
first_line("pose_not_a_number", "box 0 0 0 1 1 x hold")
first_line("pose_nan", "box 0 0 0 1 1 0.5 move 0 nan 0")
first_line("pose_box", "box 0 0 1 1 1 0 hold")
first_line("pose_radius", "sphere 0 0 0 0 hold")
first_line("pose_vertex_number", "vertices 1 2 3.5 hold")
first_line("pose_no_vertex", "vertices hold")
first_line("pose_axis", "box 0 0 0 1 1 0.5 turn 0 0 0 0 0 0 90")
first_line("pose_many_turns", "box 0 0 0 1 1 0.5 turn 0 0 0 0 0 1 3601")
first_line("pose_held_and_moved", "box 0 0 0 1 1 0.5 hold move 1 0 0")
first_line("pose_vertex_range", f"vertices 1 2 {solids.VERTEX_COUNT} hold")
first_line("pose_region_empty", "sphere 3 3 3 0.1 hold")
case("pose_region_taken", HOLD + HOLD + BEND)
case("pose_too_few", "vertices 0 1 move 0.1 0 0\n")
case("pose_on_a_line", "vertices 0 9 18 move 0.1 0 0\n",
     **{"line.msh": solids.Solid([(0, 0, 0)] + solids.solid().vertices[1:], solids.solid().tets)})
case("pose_all", "box 0 0 0  1 1 1  move 0.1 0 0\n")
case("pose_all_held", HOLD + "box 0 0 0.9  1 1 1  hold\n")
case("pose_noise", random.Random(4).randbytes(1 << 20))
case("pose_overflow", HOLD + "box 0 0 0.9  1 1 1  move 0 0 1e308\n")
case("pose_far_pivot", HOLD + "box 0 0 0.9  1 1 1  turn 100 0.5 0.5  0 0 1  180\n")
for stuck in ("pose_stuck", "pose_stuck_stvk"):
    case(stuck, HOLD + "box 0 0 0.9  1 1 1  move 0 0 -2\n")
for good_script in ("pose_surface", "pose_rest_missing", "pose_script_missing", "pose_output_kind", "pose_ply_kind",
                    "pose_over_rest", "pose_folder_missing", "pose_no_script", "pose_poisson"):
    case(good_script)
