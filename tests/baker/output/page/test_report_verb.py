"""test_report_verb.py TOOL ASSETS...: `pliant report` on small assets of 2 to 12 poses, surfaces and solids; on the report
of a real bake; on names and reports of strangers."""
import base64
import html
import json
import pathlib
import re
import sys
import tempfile

from support import (bake_shapes, bent_sheet, book, check, hostile_names, information, png_size, rename_poses, run, tube,
                     write_report)

PICTURES = re.compile(r'<img src="data:image/png;base64,([A-Za-z0-9+/=]+)" width="(\d+)" height="(\d+)"')
# What a page may name: itself (#...) and pictures inside it.
REFERENCES = re.compile(r'(?:src|href|action|data|srcset|poster)\s*=\s*["\']?([^"\'\s>]*)'
                        r'|url\(|@import|<(?:script|link|iframe|object|embed|base)\b')


def check_page(path, poses, size_limit=2 << 20, has_layers=False):
    text = path.read_text(encoding="utf-8")
    check(len(text) < size_limit, f"{path}: {len(text)} bytes")
    for match in REFERENCES.finditer(text):
        check((match[1] or "").startswith("data:image/png;base64,"), f"{path}: refers to {match[0][:80]!r}")
    pictures = PICTURES.findall(text)
    edges = min(8, poses * (poses - 1) // 2) if poses > 2 and not has_layers else 0
    shown = min(poses, 16 + has_layers)
    check(len(pictures) >= shown + 3 + 2 * edges, f"{path}: {len(pictures)} pictures of {poses} poses")
    for data, width, height in pictures:
        png = base64.b64decode(data, validate=True)
        check(png.startswith(b"\x89PNG") and png_size(png) == (int(width), int(height)),
              f"{path}: a picture is no PNG of its size")
    return text


def check_assets(tool, assets, folder):
    for asset in assets:
        page = folder / f"{asset.stem}.html"
        run(tool, "report", asset, "-o", page)
        info = information(tool, asset)
        text = check_page(page, len(info["poses"]), has_layers="layers" in info)
        first = page.read_bytes()
        run(tool, "report", asset, "-o", page, "-q")
        check(page.read_bytes() == first, f"{asset}: two pages of one asset differ")
        for chunk in info["chunks"]:
            check(f'>{chunk["tag"]}</span>' in text and f'{chunk["size"]:,}' in text,
                  f'{asset}: {chunk["tag"]} is not on the page')
        check(("A mixture of layers" in text) == ("layers" in info), f"{asset}: what is no worst mixture is called one")
        check(all(html.escape(name) in text for name in info["poses"]), f"{asset}: a pose is not named")


def check_views(tool, asset, folder):
    pages = []
    for options in ([], ["--view", "front"], ["--view", "side"], ["--up", "z"]):
        run(tool, "report", asset, "-o", folder / "view.html", *options)
        pages.append(check_page(folder / "view.html", 3))
    check(len(set(pages)) == len(pages), "two views give one page")
    check("side view, y upwards" in pages[2] and "three-quarter view, z upwards" in pages[3], "the view is not named")


def check_strangers(tool, asset, folder):
    count = len(information(tool, asset)["poses"])
    renamed = folder / "<b>&x.pliant"
    rename_poses(asset, renamed, hostile_names(count))
    run(tool, "report", renamed, "-o", folder / "names.html")
    text = check_page(folder / "names.html", count)
    check("<script" not in text and "&lt;script&gt;alert(1)" in text, "a pose name is not escaped")
    check("<h1>&lt;b&gt;&amp;x.pliant</h1>" in text, "a file name is not escaped")


def check_reports(tool, asset, folder):
    copy = folder / "sub" / "copy.pliant"
    copy.parent.mkdir()
    copy.write_bytes(asset.read_bytes())
    report, page = copy.with_suffix(".json"), folder / "report.html"
    write_report(tool, copy, report)
    run(tool, "report", report, "-o", page)
    text = check_page(page, 3)
    for part in ("12.5 s", "subspace", "98.0 %", "P2204", "turn &lt;one&gt;", "<circle class=\"", ">face 0</title>"):
        check(part in text, f"{part} is not on the page")
    page.unlink()
    for number, changes in ((5302, dict(asset=7)), (5302, dict(seconds={"x": "y"})), (5302, dict(warnings={})),
                            (5303, dict(asset=None)), (5304, dict(writer="another")), (2001, dict(asset="absent.pliant"))):
        write_report(tool, copy, report, **changes)
        said = run(tool, "report", report, "-o", page, code=3)
        check(f"error P{number}: " in said and "hint: " in said, f"{changes}: {said}")
    for content, number in ((b"", 5301), (b"{", 5301), (b"[" * 100000, 5301), (b"\xff{}", 5301)):
        report.write_bytes(content)
        check(f"error P{number}: " in run(tool, "report", report, "-o", page, code=3), f"{content[:10]}")
    check("P5102" in run(tool, "report", __file__, "-o", page, code=3), "a text is taken for an asset")
    check(not page.exists(), "a page of nothing was written")
    # Neither input may be lost.
    write_report(tool, copy, report)
    for output in (report, copy):
        before = output.read_bytes()
        run(tool, "report", report, "-o", output, code=1)
        check(output.read_bytes() == before, f"{output} was overwritten")


def check_bake(tool, folder):
    report = json.loads(bake_shapes(tool, folder, "tube", [tube(0.0), tube(1.2)], 2).read_text())
    check(report["asset"] == "out/tube.pliant", f"the report names {report['asset']}")
    turned = [warning for warning in report["warnings"] if warning["number"] == 2204]
    check(len(turned) == 1 and 3 in turned[0]["faces"] and len(turned[0]["faces"]) <= 64, f"warnings: {report['warnings']}")
    run(tool, "report", folder / "tube.json", "-o", folder / "tube.html")
    text = check_page(folder / "tube.html", 2)
    check(all(f">{stage}</span>" in text for stage in report["seconds"]), "a stage is not on the page")
    check("P2204" in text and 'class="curve"' in text and "Tolerance" in text,
          "warning, curve or verdict is not on the page")
    # What was found while baking has its place in the picture, too.
    page = folder / "book.html"
    source = bake_shapes(tool, folder, "book", [book(0.0), book(2.6)], 2, "--continuity", "off")
    folded = [warning for warning in json.loads(source.read_text())["warnings"] if warning["number"] == 4403]
    check(len(folded) == 1 and folded[0]["vertices"] and set(folded[0]["vertices"]) <= set(range(8, 12)), f"P4403: {folded}")
    run(tool, "report", source, "-o", page)
    check(f'>vertex {folded[0]["vertices"][0]}</title>' in check_page(page, 2), "a hinge that is folded over is not marked")
    source = bake_shapes(tool, folder, "rough", [book(0.0), book(2.6)], 2)
    roughest = json.loads(source.read_text())["energy"]["roughest_vertex"]
    check(8 <= roughest < 12, f"vertex {roughest} of the book is the roughest")
    run(tool, "report", source, "-o", page)
    text = check_page(page, 2)
    check(f">vertex {roughest}</title>" in text and "circle: the roughest vertex" in text,
          "the roughest vertex is not marked")


def check_layers(tool, folder):
    shapes = [bent_sheet(), bent_sheet(left=1.0), bent_sheet(right=1.0)]
    source = bake_shapes(tool, folder, "sheet", shapes, 4, "--blend", "layers", "--range", "sheet_2=-0.5:1")
    run(tool, "report", source, "-o", folder / "sheet.html")
    text = check_page(folder / "sheet.html", 3, has_layers=True)
    report = json.loads(source.read_text())
    for row in report["layers"]["errors"]:
        check(f'<td>{row["kind"]}</td><td class="number">{row["count"]}</td>' in text, f'{row} is not on the page')
    check('<td>sheet_2</td><td class="number">-0.5</td><td class="number">1</td>' in text, "a range is not on the page")
    check(len(PICTURES.findall(text)) == 6, f"{len(PICTURES.findall(text))} pictures")
    worst = report["measured"]["worst_weights"]
    names = [name for name, weight in zip(("sheet_1", "sheet_2"), worst) if abs(weight) >= 0.005]
    check(re.search("<h3>" + ", ".join(f"{name} −?[0-9.]+" for name in names) + "</h3>", text), f"{worst}: {names}")


def main():
    tool, assets = sys.argv[1], [pathlib.Path(path) for path in sys.argv[2:]]
    with tempfile.TemporaryDirectory(prefix="pliant-report-") as name:
        folder = pathlib.Path(name)
        check_assets(tool, assets, folder)
        check_views(tool, next(asset for asset in assets if asset.stem == "tube_compact"), folder)
        check_strangers(tool, next(asset for asset in assets if asset.stem == "twelve_poses"), folder)
        check_reports(tool, next(asset for asset in assets if asset.stem == "tube_compact"), folder)
        check_bake(tool, folder)
        check_layers(tool, folder)
    print(f"{len(assets)} assets")
    return 0


sys.exit(main())
