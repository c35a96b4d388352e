"""Every source of the runtime and the baker is compiled without floating-point contraction and without fast-math, or the
same asset would give other bits elsewhere: compile_flags.py COMPILE_COMMANDS ROOT

Reads the build's own compile_commands.json. Shown to fail on planted commands first.
"""
import json
import shlex
import sys
from pathlib import Path

ROOMS = ("runtime", "baker")
NEEDED = "-ffp-contract=off"
FORBIDDEN = {"-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-fassociative-math", "-freciprocal-math",
             "-fno-signed-zeros", "-ffinite-math-only", "-ffp-contract=fast", "-ffp-contract=on"}


def fault(arguments):
    """What is wrong with one command, or None. The last of several -ffp-contract counts."""
    contraction = [argument for argument in arguments if argument.startswith("-ffp-contract=")]
    if contraction[-1:] != [NEEDED]:
        return f"without {NEEDED}"
    found = FORBIDDEN.intersection(arguments)
    return f"with {', '.join(sorted(found))}" if found else None


def violations(commands, root):
    checked = 0
    report = []
    for entry in commands:
        path = Path(entry["directory"], entry["file"]).resolve()
        if not path.is_relative_to(root) or path.relative_to(root).parts[0] not in ROOMS:
            continue
        checked += 1
        wrong = fault(shlex.split(entry["command"]))
        if wrong:
            report.append(f"{path.relative_to(root)} is compiled {wrong}")
    if checked == 0:
        report.append("no source of the runtime or the baker is compiled here")
    return report


def planted_are_reported(root):
    plants = ("cc -O2 -c a.c", f"cc {NEEDED} -ffast-math -c a.c", f"cc {NEEDED} -ffp-contract=fast -c a.c")
    file = str(root / "runtime/planted.c")
    return all(violations([{"directory": "/", "file": file, "command": plant}], root) for plant in plants)


def main(commands_path, root):
    if not commands_path.exists():
        print("skipped: this build writes no compile_commands.json (the presets ask for it)")
        return 77
    if not planted_are_reported(root):
        print("a planted command is not reported")
        return 1
    report = violations(json.loads(commands_path.read_text()), root)
    print("\n".join([*report, f"{len(report)} violations"]))
    return 1 if report else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]).resolve()))
