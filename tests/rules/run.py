"""Checks one house rule: run.py RULE ROOT [--planted]

RULE names a module rule_RULE.py beside this file with
    check(tree) -> list of violations, one line each, "path:line: what is wrong"
    PLANTS      -> list of tree.Plant, deliberate violations that check() must report

Without --planted the tree must have no violation. With it, every plant is put into a temporary copy, one at a time, and must
be reported: a checker that cannot fail is worth nothing. Exit code: 0 good, 1 not, 77 cannot be checked here.
"""
import argparse
import importlib
import sys
from pathlib import Path

from tree import Tree, planted, temporary_copy


def check_tree(rule, root):
    violations = rule.check(Tree(root))
    for line in violations:
        print(line)
    print(f"{len(violations)} violations")
    return not violations


def is_reported(rule, root, plant):
    return any(plant.path in line and plant.expected in line for line in rule.check(Tree(root)))


def check_plants(rule, root):
    all_seen = True
    with temporary_copy(root) as copy:
        for plant in rule.PLANTS:
            if is_reported(rule, copy, plant):
                print(f"{plant.path}: '{plant.expected}' is reported before it is planted")
                all_seen = False
                continue
            with planted(copy, plant):
                seen = is_reported(rule, copy, plant)
            print(f"{plant.path}: '{plant.expected}' {'reported' if seen else 'NOT REPORTED'}")
            all_seen = all_seen and seen
    return all_seen and bool(rule.PLANTS)


def main():
    parser = argparse.ArgumentParser(description="checks one house rule")
    parser.add_argument("rule")
    parser.add_argument("root", type=Path)
    parser.add_argument("--planted", action="store_true", help="check that deliberate violations are reported")
    options = parser.parse_args()
    rule = importlib.import_module(f"rule_{options.rule}")
    missing = getattr(rule, "missing_tool", lambda: None)()
    if missing:
        print(f"skipped: {missing}")
        return 77
    good = (check_plants if options.planted else check_tree)(rule, options.root)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
