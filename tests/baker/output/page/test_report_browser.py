"""test_report_browser.py TOOL ASSETS...: pages of `pliant report` in headless Chromium, on a wide screen and a telephone,
light and dark: nothing is asked of the network, nothing is complained of, nothing is wider than the screen, every picture is
there, it prints. Screenshots stay in the folder report_pages. Skips without Chromium."""
import pathlib
import sys

from browser import Browser
from support import bake_shapes, bent_sheet, check, hostile_names, information, rename_poses, run, tube

# Widths of what stands out on the right, of pictures that were not decoded, and the colour of the page.
MEASURE = """({ width: document.documentElement.scrollWidth,
  broken: [...document.images].filter(i => !i.naturalWidth).length,
  pictures: document.images.length, paper: getComputedStyle(document.body).backgroundColor,
  wide: [...document.querySelectorAll('main *')].filter(e => e.getBoundingClientRect().right > innerWidth + 1)
    .slice(0, 5).map(e => e.outerHTML.slice(0, 80)) })"""


def check_page(browser, page, folder):
    papers = set()
    for width, scheme in ((1200, "light"), (1200, "dark"), (400, "light")):
        asked, said = browser.open(page, width, scheme=scheme)
        where = f"{page.name} at {width}, {scheme}"
        check(not asked, f"{where}: asks for {asked}")
        check(not said, f"{where}: the console says {said}")
        found = browser.evaluate(MEASURE)
        check(found["width"] <= width and not found["wide"], f"{where}: {found['width']} wide, because of {found['wide']}")
        check(found["pictures"] > 0 and not found["broken"],
              f"{where}: {found['broken']} of {found['pictures']} pictures are broken")
        papers.add(found["paper"])
        browser.screenshot(folder / f"{page.stem}_{width}_{scheme}.png")
    check(len(papers) == 2, f"{page.name}: dark looks as light does")
    browser.print_pdf(folder / f"{page.stem}.pdf")
    check((folder / f"{page.stem}.pdf").read_bytes().startswith(b"%PDF"), f"{page.name} does not print")


def main():
    tool, assets = sys.argv[1], [pathlib.Path(path) for path in sys.argv[2:]]
    folder = pathlib.Path("report_pages")
    folder.mkdir(exist_ok=True)
    with Browser() as browser:
        sources = [asset for asset in assets if asset.stem == "beam_mooney"]
        for asset in assets:
            if asset.stem == "twelve_poses":
                sources.append(folder / "hostile.pliant")
                rename_poses(asset, sources[-1], hostile_names(len(information(tool, asset)["poses"])))
        # A curve, a triangle and bars of errors, seconds and warnings.
        for name, bends in (("two", (0.0, 1.2)), ("three", (0.0, 1.2, -1.0)), ("five", (0.0, 1.2, -1.0, 0.5, 2.0))):
            sources.append(bake_shapes(tool, folder, name, [tube(bend) for bend in bends], len(bends) + 1))
        shapes = [bent_sheet(), bent_sheet(left=1.0), bent_sheet(right=1.0)]
        sources.append(bake_shapes(tool, folder, "layers", shapes, 4, "--blend", "layers"))
        sources += [asset for asset in assets if asset.stem == "layers_many"]
        for source in sources:
            page = folder / f"{source.stem}.html"
            run(tool, "report", source, "-o", page, "-q")
            check_page(browser, page, folder)
    print(f"{len(sources)} pages, screenshots in {folder.resolve()}")
    return 0


sys.exit(main())
