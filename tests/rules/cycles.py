"""No cycle of calls between the files of a library: cycles.py LIBRARY --compiler CC

A file of a static library needs another file when it uses a symbol that the other file defines, a function or a table (nm).
The test first plants files that need each other and expects them to be reported. Exit code 77: the library is not static.
"""
import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# Two files that need each other, and three in a ring, where the last one needs a table and not a function.
PLANTED = {
    ("a", "b"): {"a": "int pliant_b(void);\nint pliant_a(void) { return pliant_b(); }\n",
                 "b": "int pliant_a(void);\nint pliant_b(void) { return pliant_a(); }\n"},
    ("a", "b", "c"): {"a": "int pliant_b(void);\nextern const int pliant_a[1];\nconst int pliant_a[1] = { 1 };\n"
                           "int pliant_use(void) { return pliant_b(); }\n",
                      "b": "int pliant_c(void);\nint pliant_b(void) { return pliant_c(); }\n",
                      "c": "extern const int pliant_a[1];\nint pliant_c(void) { return pliant_a[0]; }\n"},
}


def needs(library):
    """Of every member of the library, the members whose symbols it uses."""
    listing = subprocess.run(["nm", "--format=posix", library], check=True, capture_output=True, text=True).stdout
    used, owner, member = {}, {}, None
    for line in listing.splitlines():
        if line.endswith("]:"):  # library.a[member.o]:
            member = line[line.rindex("[") + 1:-2]
            used[member] = set()
            continue
        name, kind = line.split()[:2]
        if kind in "Uw":
            used[member].add(name)
        elif kind.isupper():  # a lower-case letter: of this file alone
            owner[name] = member
    return {member: {owner[name] for name in names if name in owner} - {member} for member, names in used.items()}


def cycles(graph):
    """Groups of members each of which leads to all others."""
    def reachable(start):
        found, waiting = set(), [start]
        while waiting:
            for member in graph[waiting.pop()] - found:
                found.add(member)
                waiting.append(member)
        return found

    reach = {member: reachable(member) for member in graph}
    return sorted({tuple(sorted(other for other in reach[member] if member in reach[other]))
                   for member in graph if member in reach[member]})


def planted_is_reported(library, compiler, names, sources):
    with tempfile.TemporaryDirectory(prefix="pliant_cycles_") as folder:
        copy = Path(folder, "library.a")
        shutil.copy(library, copy)
        for name, source in sources.items():
            Path(folder, f"planted_{name}.c").write_text(source)
        subprocess.run([compiler, "-O1", "-c", *(f"planted_{name}.c" for name in sources)], cwd=folder, check=True)
        objects = [f"planted_{name}.o" for name in names]
        subprocess.run(["ar", "q", "library.a", *objects], cwd=folder, check=True)
        return tuple(objects) in cycles(needs(copy))


def main():
    parser = argparse.ArgumentParser(description="checks that no files of a static library need each other")
    parser.add_argument("library")
    parser.add_argument("--compiler", required=True)
    options = parser.parse_args()
    if not options.library.endswith(".a"):
        print("skipped: the files of a shared library cannot be told apart")
        return 77
    good = True
    for names, sources in PLANTED.items():
        seen = planted_is_reported(options.library, options.compiler, names, sources)
        print(f"planted cycle of {len(names)}: {'reported' if seen else 'NOT REPORTED'}")
        good = good and seen
    graph = needs(options.library)
    if not any(graph.values()):
        print("no file needs another one: is this the right library?")
        good = False
    report = cycles(graph)
    for members in report:
        print(f"{options.library}: these files need each other: {', '.join(members)}")
    print(f"{len(graph)} files, {len(report)} cycles")
    return 0 if good and not report else 1


if __name__ == "__main__":
    sys.exit(main())
