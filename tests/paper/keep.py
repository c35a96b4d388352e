"""Keeps the results of a study in the tree: keep.py STUDY [-o RESULTS]

Copies the tables (CSV) and pictures (PNG, in 96 colours, at most 1,400 pixels wide) of the folder STUDY that run.sh wrote to
RESULTS (default: the folder results beside this file), and writes README.md there: date, commit, machine, all tables, each
with its picture. What was there is replaced: results of parts that this study leaves out are gone. Refuses more than 2 MB,
and a folder that holds anything else.
"""
import argparse
import datetime
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
TITLE = "# Results of the study"
LIMIT, WIDTH, COLOURS = 2_000_000, 1400, 96
PICTURES_ALONE = ("*_sheet.png", "*_bases.png", "rivals/*.png")


def machine():
    model = re.search(r"Model name:\s*(.*)", subprocess.run(["lscpu"], capture_output=True, text=True, check=False).stdout)
    return f"{os.cpu_count()} cores of {model.group(1) if model else 'an unknown processor'}"


def commit():
    git = lambda *words: subprocess.run(["git", "-C", HERE, *words], capture_output=True, text=True, check=True).stdout
    return git("rev-parse", "--short=10", "HEAD").strip() + (" with changes" if git("status", "--porcelain", "-uno") else "")


def keep_picture(source, target):
    picture = Image.open(source).convert("RGB")
    if picture.width > WIDTH:
        picture = picture.resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.LANCZOS)
    picture.quantize(COLOURS).save(target, optimize=True)


def keep_tables(study, folder):
    """The Markdown of all tables, those of the paper first; their CSV files and plots go to `folder`."""
    tables = sorted((path for path in study.glob("*.md") if path.stem != "study"),
                    key=lambda path: (not path.stem.startswith("table"), path.stem))
    text = []
    for path in tables:
        text.append(path.read_text())
        if path.with_suffix(".csv").exists():
            shutil.copy(path.with_suffix(".csv"), folder)
        plot = path.with_suffix(".png")
        if plot.exists():
            keep_picture(plot, folder / plot.name)
            text.append(f"![{path.stem}]({plot.name})\n")
    return text


def keep_pictures(study, folder):
    text = []
    for pattern in PICTURES_ALONE:
        for path in sorted(study.glob(pattern)):
            name = f"rivals_{path.name}" if path.parent.name == "rivals" else path.name
            keep_picture(path, folder / name)
            text.append(f"![{Path(name).stem}]({name})\n")
    return text


def is_ours(results):
    """Whether the folder may be replaced: it is not there, or holds such results and nothing else."""
    if not os.path.lexists(results):
        return True
    files = list(results.iterdir()) if results.is_dir() and not results.is_symlink() else []
    are_kept = all(path.is_file() and (path.name == "README.md" or path.suffix in (".csv", ".png")) for path in files)
    readme = results / "README.md"
    return are_kept and readme in files and readme.read_text("utf-8").startswith(TITLE + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=Path, metavar="STUDY")
    parser.add_argument("-o", "--output", type=Path, default=HERE / "results", metavar="RESULTS")
    options = parser.parse_args()
    if not is_ours(options.output):
        sys.exit(f"keep.py: {options.output} does not hold results of the study: name a new folder")
    options.output = options.output.resolve()  # a relative name may lead through the folder that is moved
    with tempfile.TemporaryDirectory(prefix="pliant-keep-", dir=options.output.parent) as name:
        folder, before = Path(name, "results"), Path(name, "before")
        folder.mkdir()
        log = (options.study / "log.txt").read_text().strip().splitlines()
        run = f"`bash tests/paper/run.sh`, {datetime.date.today()}, commit {commit()},\n{machine()}."
        head = [f"{TITLE}\n\n{run}\n", "```", *log, "```\n"]
        body = keep_tables(options.study, folder) + ["## Pictures\n", *keep_pictures(options.study, folder)]
        (folder / "README.md").write_text("\n".join(head + body))
        size = sum(path.stat().st_size for path in folder.iterdir())
        if size > LIMIT:
            sys.exit(f"keep.py: {size} bytes are more than {LIMIT}: nothing was changed")
        if options.output.exists():
            os.rename(options.output, before)
        os.rename(folder, options.output)
    print(f"kept {size / 1e6:.2f} MB in {options.output}")


if __name__ == "__main__":
    main()
