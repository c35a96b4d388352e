"""What the runtime library needs and holds: symbols.py LIBRARY --compiler CC [--function NAME] [--sanitized]

It may call a few functions of the C library that touch nothing but their arguments: no allocation, files, threads, clocks.
It holds no writable memory, and every name it exports starts with pliant_. Shown to fail on planted objects first.
"""
import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MEMORY = {"memcpy", "memmove", "memset", "memcmp", "strlen", "strcmp", "strncmp"}
MATHEMATICS = {name + suffix for suffix in ("", "f") for name in (
    "sqrt", "fabs", "floor", "ceil", "rint", "round", "fmin", "fmax", "ldexp", "frexp", "exp", "log", "log1p", "expm1",
    "pow", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "cbrt")}
# Put in by the compiler: position-independent code, stack protector, what its own library knows of the processor.
COMPILER = {"_GLOBAL_OFFSET_TABLE_", "__stack_chk_fail", "__stack_chk_guard", "__cpu_model", "__cpu_indicator_init"}
ALLOWED = MEMORY | MATHEMATICS | COMPILER

# objdump -t: address, seven flag columns, section, size, name.
SYMBOL = re.compile(r"^[0-9a-f]+ (.{7}) (\S+)\s+[0-9a-f]+ (?:\.hidden )?(\S+)$")
# Constant tables with pointers in them are relocated and then write-protected.
WRITABLE = re.compile(r"^(?:\.data(?!\.rel\.ro)|\.bss|\.tdata|\.tbss|\*COM\*)")

PLANTED = {
    "malloc": "#include <stdlib.h>\nvoid* pliant_planted(void) { return malloc(8); }\n",
    "fopen": '#include <stdio.h>\nvoid* pliant_planted(void) { return fopen("a", "r"); }\n',
    "pthread_create": "#include <pthread.h>\nint pliant_planted(pthread_t* t, void* (*f)(void*))\n"
                      "{ return pthread_create(t, 0, f, 0); }\n",
    "counter": "static int counter;\nint pliant_planted(void) { return ++counter; }\n",
    "table": "static int table[2] = { 1, 2 };\nint pliant_planted(int i) { return table[i & 1]++; }\n",
    "global_name": "int global_name(void) { return 1; }\n",
}


def symbols(library):
    """(flags, section, name) of every symbol of every member."""
    listing = subprocess.run(["objdump", "-t", library], check=True, capture_output=True, text=True).stdout
    return [match.groups() for match in map(SYMBOL.match, listing.splitlines()) if match]


def violations(library, function):
    found = symbols(library)
    defined = {name for _, section, name in found if section != "*UND*"}
    report = []
    if function not in defined:
        report.append(f"{function} is not defined: is this the right library?")
    for flags, section, name in found:
        if section == "*UND*":
            if name not in defined and name not in ALLOWED:
                report.append(f"calls {name}")
        elif WRITABLE.match(section) and "d" not in flags:
            report.append(f"holds writable {name} in {section}")
        elif flags[0] in "gu!" and not name.startswith("pliant_"):
            report.append(f"exports {name}")
    return sorted(set(report))


def planted_is_reported(library, compiler, function, name, source):
    with tempfile.TemporaryDirectory(prefix="pliant_symbols_") as folder:
        copy = Path(folder, "library.a")
        shutil.copy(library, copy)
        Path(folder, "planted.c").write_text(source)
        subprocess.run([compiler, "-O1", "-c", "planted.c", "-o", "planted.o"], cwd=folder, check=True)
        subprocess.run(["ar", "q", "library.a", "planted.o"], cwd=folder, check=True)
        return any(name in line.split() for line in violations(copy, function))


def main():
    parser = argparse.ArgumentParser(description="checks the symbols of the runtime library")
    parser.add_argument("library")
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--function", default="pliant_solve", help="one that the library defines")
    parser.add_argument("--sanitized", action="store_true")
    options = parser.parse_args()
    if options.sanitized:
        print("skipped: a library built with sanitizers calls into them")
        return 77
    good = True
    for name, source in PLANTED.items():
        seen = planted_is_reported(options.library, options.compiler, options.function, name, source)
        print(f"planted {name}: {'reported' if seen else 'NOT REPORTED'}")
        good = good and seen
    report = violations(options.library, options.function)
    for line in report:
        print(f"{options.library}: {line}")
    print(f"{len(report)} violations")
    return 0 if good and not report else 1


if __name__ == "__main__":
    sys.exit(main())
