#!/usr/bin/env python3
"""The documentation as a site of static files: build.py OUT [--page FOLDER] [--strict]

Copies every document of the tree to its own path, and the pages beside this file to the top, rewrites the links, and calls
mkdocs. What a document links to comes along: pictures and notebooks as they are, sources as pages that show them. --page
puts what samples/web/build.py made into OUT/page. OUT appears whole or not at all; one that this script made before is
replaced.
Needs mkdocs and Pygments: pip install mkdocs==1.6.1 pygments==2.21.0
Exit code: 0, 1 if something failed, 2 for a wrong argument.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path, PurePosixPath

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PACKAGES = ["mkdocs==1.6.1", "pygments==2.21.0"]
HINT = f"\nhint: pip install {' '.join(PACKAGES)}"
COPIED = {".gif", ".ipynb", ".jpg", ".png", ".svg", ".webp"}  # as they are
LANGUAGES = {".c": "c", ".cpp": "cpp", ".cs": "csharp", ".h": "c", ".hpp": "cpp", ".py": "python", ".sh": "bash",
             ".ts": "typescript"}
DOXYGEN_PAGE = "mainpage.md"
SKIPPED = {".git", "build", "__pycache__"}
# An inline link or picture outside of fenced code; its text may go over lines.
LINK = re.compile(r"(!?\[(?:[^\[\]]|\[[^\[\]]*\])*\]\()([^)\s]+)(\))")
OWN_PAGES = "samples/site/pages"
WEB_PAGE = PurePosixPath("samples/web/index.html")  # in OUT/page, if it is there
STAMP = ".made_by_samples_site"


class Failure(Exception):
    """What failed, with a remedy."""


def documents():
    """Paths of the tree's documents and of the site's own pages, relative to ROOT. Left out: templates for the
    forge, and the page for Doxygen."""
    found = []
    for folder, subfolders, names in os.walk(ROOT):
        subfolders[:] = sorted(name for name in subfolders if name not in SKIPPED)
        found += [Path(folder, name).relative_to(ROOT) for name in names if name.endswith(".md")]
    return [PurePosixPath(path) for path in sorted(found) if "TEMPLATE" not in path.name and path.name != DOXYGEN_PAGE]


def place_of(path):
    """Where a document lies in the site: at its path in the tree, but the site's own pages come first."""
    if path == PurePosixPath("README.md"):
        return PurePosixPath("overview.md")
    for folder, place in ((OWN_PAGES, ""), (".github", "project")):
        if path.is_relative_to(folder):
            return PurePosixPath(place, path.relative_to(folder))
    return path


class Site:
    """Collects the pages in a folder for mkdocs."""

    def __init__(self, docs, page):
        self.docs = docs
        self.has_page = bool(page)
        if page:
            shutil.copytree(page, docs / "page")
        self.pages = set(documents())
        self.linked = set()

    def write(self, place, text):
        path = self.docs / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def target(self, origin, link):
        """The link of a document at `origin` as it must be in the site."""
        if re.match(r"[a-z][a-z+.-]*:|#", link):
            return link
        name, hash_sign, anchor = link.partition("#")
        path = PurePosixPath(os.path.normpath(origin.parent / name))
        if not (ROOT / path).is_file() or path.parts[0] == "..":
            raise Failure(f"{origin}: the link {link} leads to no file\nhint: repair it in the document")
        if path == WEB_PAGE:
            there = PurePosixPath("page/index.html") if self.has_page else WEB_PAGE.with_name("README.md")
        elif path in self.pages:
            there = place_of(path)
        else:
            self.linked.add(path)
            there = path if path.suffix in COPIED else path.with_name(path.name + ".md")
        return os.path.relpath(there, place_of(origin).parent) + hash_sign + anchor

    def rewrite(self, origin, text):
        """Links of the text, but not those in fenced code."""
        parts = re.split(r"(^```.*?^```$)", text, flags=re.M | re.S)  # every second one is code
        parts[::2] = [LINK.sub(lambda m: m[1] + self.target(origin, m[2]) + m[3], part) for part in parts[::2]]
        return "".join(parts)

    def add_documents(self):
        for path in sorted(self.pages):
            self.write(place_of(path), self.rewrite(path, (ROOT / path).read_text(encoding="utf-8")))

    def add_linked(self):
        for path in sorted(self.linked):
            if path.suffix in COPIED:
                (self.docs / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / path, self.docs / path)
            else:
                text = (ROOT / path).read_text(encoding="utf-8").replace("\n```", "\n\u200b```")
                self.write(path.with_name(path.name + ".md"),
                           f"# {path}\n\n```{LANGUAGES.get(path.suffix, 'text')}\n{text.rstrip()}\n```\n")


def style():
    from pygments.formatters import HtmlFormatter
    return (HERE / "site.css").read_text(encoding="utf-8") + HtmlFormatter(style="default").get_style_defs(".codehilite")


def call_mkdocs(work, strict):
    done = subprocess.run([sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", "site", *["--strict"] * strict],
                          cwd=work, capture_output=True, text=True)
    sys.stderr.write(done.stderr)
    if done.returncode != 0:
        raise Failure(f"mkdocs failed, see above{HINT}")


def build(work, page, strict):
    """The finished site below `work`."""
    docs = work / "docs"
    docs.mkdir()
    site = Site(docs, page)
    site.add_documents()
    site.add_linked()
    (docs / "site.css").write_text(style(), encoding="utf-8")
    shutil.copy(HERE / "mkdocs.yml", work)
    call_mkdocs(work, strict)
    (work / "site" / STAMP).touch()
    return work / "site"


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--page", type=Path)
    parser.add_argument("--strict", action="store_true", help="warnings are errors")
    options = parser.parse_args(arguments)
    out = options.out.resolve()
    if out.exists() and not (out / STAMP).exists():
        raise Failure(f"{out} is there, and is no site of this script\nhint: name a new folder")
    if options.page and not (options.page / "index.html").is_file():
        raise Failure(f"{options.page} holds no page\nhint: python3 samples/web/build.py makes it")
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".site-", dir=out.parent) as name:
        finished = build(Path(name), options.page, options.strict)
        if out.exists():
            os.rename(out, Path(name, "before"))
        os.rename(finished, out)
    print(f"{out}/index.html")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (Failure, ModuleNotFoundError) as failure:
        print(f"build.py: error: {failure}{HINT * isinstance(failure, ModuleNotFoundError)}", file=sys.stderr)
        sys.exit(1)
