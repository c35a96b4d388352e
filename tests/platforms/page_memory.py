"""page_memory.py [--frames N] [--leak N] [--build build/dev]: the memory of the page of samples/web does not grow while
it is used (page_memory.mjs), in headless Chromium; by default for an hour at 60 frames a second. Uses what `ctest
--preset dev -R platforms_page` has left in the build. Exit code 1 if it grows."""
import argparse
import pathlib
import sys

import page

HOUR = 216000


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=HOUR)
    parser.add_argument("--leak", type=int, default=0, help="numbers to lose in every frame")
    parser.add_argument("--build", type=pathlib.Path, default=page.ROOT / "build/dev")
    options = parser.parse_args()
    folder = options.build.resolve() / "tests/platforms"
    if not (folder / "page/embedded.glb").exists():
        parser.error(f"{folder} has no page: run ctest --preset dev -R platforms_page first")
    return page.drive("chromium", folder, "page_memory.mjs", folder / "bad.pliant", str(options.frames), str(options.leak),
                      timeout=None)


if __name__ == "__main__":
    sys.exit(main())
