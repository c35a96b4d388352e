"""page_cost.py CHARACTER.pliant [--browser chromium|firefox-esr] [--build build/dev]: what one character and 20 of them cost
on the page of samples/web, in a headless browser. Uses what `ctest --preset dev -R platforms_page` has left in the build."""
import argparse
import pathlib
import shutil
import subprocess
import sys

import page


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("asset", type=pathlib.Path)
    parser.add_argument("--browser", choices=page.BROWSERS, default="chromium")
    parser.add_argument("--build", type=pathlib.Path, default=page.ROOT / "build/dev")
    options = parser.parse_args()
    folder = options.build / "tests/platforms"
    if not (folder / "page").exists():
        parser.error(f"{folder} has no page: run ctest --preset dev -R platforms_page first")
    shutil.copy(options.asset, folder / "page/character.pliant")
    return page.drive(options.browser, folder, "page_cost.mjs")


if __name__ == "__main__":
    sys.exit(main())
