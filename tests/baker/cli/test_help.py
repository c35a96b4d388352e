"""What the tool tells of itself: test_help.py PLIANT. Help, manual page, completions, -q, -v and --json. Shells that are
not installed are left out and named."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bad_input"))
import generate  # noqa: E402
from layered_tube import tube, write_obj  # noqa: E402

TOOL = sys.argv[1]


def run(*arguments, code=0, cwd=None):
    result = subprocess.run([TOOL, *arguments], capture_output=True, text=True, check=False, cwd=cwd)
    assert result.returncode == code, (arguments, result.returncode, result.stderr)
    return result


def check_help():
    """Returns the long options of every verb, as its help lists them."""
    first = run("help").stdout
    verbs = re.findall(r"^  ([a-z-]+) ", first[first.index("Subcommands:"):], re.M)
    assert len(verbs) == 12 and {"bake", "bake-all", "help"} <= set(verbs), verbs
    options = {}
    for verb in verbs:
        text = run("help", verb).stdout
        assert text == run(verb, "--help").stdout, f"help {verb} is not {verb} --help"
        body = text[:text.index("\nExample")]
        wide = [line for line in body.splitlines() if re.match(r"  -| {26}", line) and len(line) > 100]
        assert not wide, (verb, wide)
        options[verb] = re.findall(r"^  (?:-\w, )?--([a-z-]+)", body, re.M)
        assert {"quiet", "verbose"} <= set(options[verb]) or verb == "help", verb
    groups = re.findall(r"^(\w[^:\n]*):$", run("help", "bake").stdout, re.M)
    assert groups == ["Positionals", "Options", "Input", "Material", "Quality", "Build systems", "Run",
                      "Method, for experiments", "Example"], groups
    assert run(code=2).stderr == first and run(code=2).stdout == "", "without a verb the tool explains itself"
    return options


def check_manual(options):
    page = run("help", "--man").stdout
    plain = page.replace("\\-", "-")
    for verb, names in options.items():
        assert f".SS pliant {verb}\n" in plain, verb
        for name in names:
            assert f"--{name}" in plain, name
    if shutil.which("groff"):
        drawn = subprocess.run(["groff", "-man", "-Tutf8", "-ww"], input=page, capture_output=True, text=True, check=True)
        assert not drawn.stderr and "--tolerance-max" in re.sub(".\b", "", drawn.stdout), drawn.stderr


def shell(name, script):
    if not shutil.which(name):
        print(f"{name} is not installed: its completion is not tried")
        return None
    done = subprocess.run([name, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and not done.stderr, (name, done.stderr)
    return done.stdout.split()


def check_completions(folder):
    for name in ("bash", "zsh", "fish"):
        (folder / name).write_text(run("help", "--completion", name).stdout, encoding="utf-8")

    def bash(*words):
        script = (f"source {folder}/bash; COMP_WORDS=(pliant {' '.join(words)}); COMP_CWORD={len(words)}; _pliant; "
                  "echo \"${COMPREPLY[@]}\"")
        return shell("bash", script)

    assert bash("b") == ["bake", "blend", "bake-all"], bash("b")
    assert bash("bake", "--tol") == ["--tolerance", "--tolerance-max"]
    assert bash("bake", "--blend", "l") == ["layers"]
    assert bash("help", "ex") == ["export"]
    assert bash("info", "a") == [], "files are left to bash, which quotes their names"
    shell("zsh", f"zsh -n {folder}/zsh")
    fish = shell("fish", f"source {folder}/fish; complete -C 'pliant bake --blend l'; complete -C 'pliant expo'")
    assert fish is None or (fish[0] == "layers" and "export" in fish), fish


def check_names(folder):
    """Poses of one name get that of their folder, or a number."""
    files = []
    for i, name in enumerate(("walk", "run", "run")):
        (folder / name).mkdir(exist_ok=True)
        write_obj(folder / name / "pose.obj", tube(0, 0.4 * i))
        files.append(f"{name}/pose.obj")
    told = json.loads(run("check", *files, "--json", cwd=folder).stdout)
    assert [pose["name"] for pose in told["poses"]] == ["walk/pose", "run/pose", "run/pose (2)"], told["poses"]


def check_gltf(folder):
    """Animations are listed for a bare file, and with -v."""
    generate.generate("gltf_animation_unknown", folder)
    chosen = ("check", "a.glb#rest", "a.glb#target=bent")
    assert "animation Run" in run("check", "a.glb", cwd=folder).stdout
    assert "animation" not in run(*chosen, cwd=folder).stdout and "animation Run" in run(*chosen, "-v", cwd=folder).stdout


def check_parts(folder):
    """Bake and info say how far parts drift."""
    generate.generate("two_components", folder)
    baked = run("bake", "parts.obj", "parts_bent.obj", "-o", "parts.pliant", "--preview", cwd=folder).stdout
    found = re.search(r"^  parts drift by at most \d+\.\d\d % of the diagonal$", baked, re.M)
    assert found and found[0] in run("info", "parts.pliant", cwd=folder).stdout, baked


def check_talk(folder):
    for name, angles in (("rest", (0, 0)), ("bent", (0, 1.2))):
        write_obj(folder / f"{name}.obj", tube(*angles))
    bake = ("bake", "rest.obj", "bent.obj", "-o", "tube.pliant", "--preview")
    told = run(*bake, "--json", "--report", "tube.json", cwd=folder)
    report = json.loads(told.stdout)
    assert report == json.loads((folder / "tube.json").read_text(encoding="utf-8")), "--json is not the report"
    stages = re.findall(r"^pliant bake: (.+) (\d+) %$", told.stderr, re.M)
    shares = [int(share) for _, share in stages]
    assert len(stages) > 3 and shares == sorted(shares), told.stderr
    assert re.search(r"^pliant bake: .+ \d+ % after \d+\.\d s$", run(*bake, "--verbose", cwd=folder).stderr, re.M)
    quiet = run(*bake, "--quiet", cwd=folder)
    assert quiet.stdout == quiet.stderr == "", quiet
    export = json.loads(run("export", "tube.pliant", "-o", "tube.glb", "--json", cwd=folder).stdout)
    assert export["file_size"] == (folder / "tube.glb").stat().st_size, export
    assert export["morph_targets"]["count"] == report["subspace"]["dimension"], export
    short, whole = run("info", "tube.pliant", cwd=folder).stdout, run("info", "-v", "tube.pliant", cwd=folder).stdout
    assert re.match(r"tube\.pliant: (keeps|misses) its tolerance: blends at \d+ weights are off by ", short), short
    assert whole.startswith(short) and "  CERT " in whole and "  CERT " not in short, whole
    again = run("info", "tube.pliant", "tube.pliant", cwd=folder).stdout
    assert again == 2 * short, again
    assert run(*bake, cwd=folder).stdout.splitlines()[0] == short.splitlines()[0], "bake and info have one verdict"
    blend = ("blend", "tube.pliant", "--weights", "1,1", "-o", "tube.ply")
    assert re.fullmatch(r"tube\.ply: \d+ vertices\n", run(*blend, cwd=folder).stdout)
    assert re.search(r"vertices, \d+ iterations, \d+ evaluations$", run(*blend, "-v", cwd=folder).stdout.strip())
    embedded = run("export", "tube.pliant", "--embed", "-o", "embedded.glb", "-q", cwd=folder)
    assert not embedded.stderr and "valid" in run("validate", "embedded.glb", cwd=folder).stdout
    command = run("check", "rest.obj", "bent.obj", "--weld", "0", cwd=folder).stdout.splitlines()[-1]
    assert command == "to bake: pliant bake rest.obj bent.obj --weld 0 -o rest.pliant", command
    command = run("check", "rest.obj", "bent.obj", "--no-align=false", cwd=folder).stdout.splitlines()[-1]
    assert command == "to bake: pliant bake rest.obj bent.obj -o rest.pliant", command
    (folder / "-d.obj").write_bytes((folder / "bent.obj").read_bytes())
    command = run("check", "--", "-d.obj", "rest.obj", cwd=folder).stdout.splitlines()[-1]
    assert command == "to bake: pliant bake ./-d.obj rest.obj -o ./-d.pliant", command
    odd = "it's\x1b[2J\\x.obj"
    (folder / odd).write_bytes((folder / "bent.obj").read_bytes())
    command = run("check", "rest.obj", odd, cwd=folder).stdout.splitlines()[-1].removeprefix("to bake: ")
    assert "\x1b" not in command, command
    words = subprocess.run(["bash", "-c", f"printf '%s\n' {command}"], capture_output=True, text=True, check=True).stdout
    assert words.splitlines()[3] == odd, words


with tempfile.TemporaryDirectory(prefix="pliant_help_") as temporary:
    work = pathlib.Path(temporary)
    check_manual(check_help())
    check_completions(work)
    check_names(work)
    check_gltf(work)
    check_parts(work)
    check_talk(work)
print("passed")
