"""test_site.py ENVIRONMENT: samples/site/build.py makes the site, mkdocs warns of nothing, every link, anchor and picture
leads to something that is there. Every page can be reached from the first one, and none fetches anything from the network.
Planted faults are found. Exit code 77, and the reason, without mkdocs."""
import subprocess
import sys
import tempfile
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

ROOT = Path(__file__).resolve().parents[3]
LOADED = {("img", "src"), ("script", "src"), ("link", "href"), ("source", "src"), ("iframe", "src")}


class Page(HTMLParser):
    """The links and anchors of an HTML file."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loads, self.anchors = set(), set(), {""}
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag, name) == ("a", "name"):
                self.anchors.add(value)
            elif (tag, name) == ("a", "href"):
                self.links.add(value)
            elif (tag, name) in LOADED and not (tag == "link" and dict(attributes).get("rel") == "canonical"):
                self.loads.add(value)


class Site:
    def __init__(self, folder):
        self.folder = folder
        self.pages = {path: Page(path) for path in folder.rglob("*.html")}

    def target(self, origin, link):
        """The file and anchor of a link inside the site; None of one to outside."""
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            return None
        path = unquote(parts.path)
        if path.startswith("/"):  # the error page's, which may be shown anywhere
            found = self.folder / path[1:]
        else:
            found = (origin.parent / path).resolve() if path else origin
        return (found / "index.html" if found.is_dir() else found), unquote(parts.fragment)

    def faults(self):
        for origin, page in self.pages.items():
            name = origin.relative_to(self.folder)
            for link in page.links | page.loads:
                target = self.target(origin, link)
                if target is None:
                    if link in page.loads and not link.startswith("data:"):
                        yield f"{name}: fetches {link}"
                elif not target[0].is_file():
                    yield f"{name}: {link} leads to no file"
                elif target[0] in self.pages and target[1] not in self.pages[target[0]].anchors:
                    yield f"{name}: {link} leads to no heading"
        reached = self.reached(self.folder / "index.html")
        for origin in sorted(self.pages):
            if origin not in reached and origin.name not in ("404.html", "search.html"):
                yield f"{origin.relative_to(self.folder)}: no way leads here"

    def reached(self, start):
        found, waiting = {start}, [start]
        while waiting:
            origin = waiting.pop()
            for link in self.pages[origin].links:
                target = self.target(origin, link)
                if target and target[0] in self.pages and target[0] not in found:
                    found.add(target[0])
                    waiting.append(target[0])
        return found


def check_planted(folder):
    links = '<a href="#here">good</a><a href="no.html">no file</a><a href="#no">no heading</a>'
    loads = '<img src="no.png"><script src="https://localhost/no.js"></script>'
    (folder / "index.html").write_text(f'<h1 id="here">x</h1>{links}{loads}')
    (folder / "lost.html").write_text("x")
    found = sorted(Site(folder).faults())
    expected = ["#no leads to no heading", "fetches https", "no.html leads to no file", "no.png leads to no file",
                "lost.html: no way"]
    assert len(found) == 5 and all(any(text in fault for fault in found) for text in expected), found


def check_refused(python, folder):
    """A folder that is something else stays."""
    other = folder / "other"
    other.mkdir()
    (other / "mine.txt").write_text("x")
    done = subprocess.run([python, "-B", ROOT / "samples/site/build.py", other], capture_output=True, text=True)
    assert done.returncode == 1 and "no site of this script" in done.stderr, done
    assert [path.name for path in other.iterdir()] == ["mine.txt"]


def main(environment):
    if not (environment / "is_complete").exists():
        print("skipped: mkdocs could not be fetched")
        return 77
    with tempfile.TemporaryDirectory(prefix="pliant-site-") as name:
        folder, python = Path(name).resolve(), environment / "bin/python"
        (folder / "planted").mkdir()
        check_planted(folder / "planted")
        check_refused(python, folder)
        done = subprocess.run([python, "-B", ROOT / "samples/site/build.py", "--strict", folder / "site"], text=True,
                              capture_output=True)
        assert done.returncode == 0, done.stdout + done.stderr
        site = Site(folder / "site")
        faults = sorted(set(site.faults()))
        print("\n".join(faults))
        print(f"{len(site.pages)} pages, {sum(len(page.links) for page in site.pages.values())} links, {len(faults)} faults")
        assert sorted(path.name for path in folder.iterdir()) == ["other", "planted", "site"]
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
