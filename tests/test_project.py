"""What stands around the code: README and paper say what is so, versions agree, commands and links exist."""

import ast
import importlib.util
import json
import re
import runpy
import statistics
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.version import Version

import asperity
from asperity.cli import main
from asperity.kernels import options
from asperity.reference.law_accuracy import law_map
from asperity.scenes.result import METHOD

ROOT = Path(__file__).parents[1]
PERSON = "TO BE FILLED IN BY A PERSON"
READ = (".py", ".md", ".bib", ".rst", ".toml")
USED = ("readers", "uff", "parquet", "cluster", "app")  # extras of people, of which cupy needs a GPU
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


README, PAPER = text("README.md"), text("paper/paper.md").split("---", 2)[2]


def test_recipe_and_archive_say_what_the_project_says():
    recipe = yaml.safe_load(text("packaging/conda/recipe.yaml"))
    needed = [line.replace("matplotlib-base", "matplotlib") for line in recipe["requirements"]["run"][1:]]
    assert required(line.replace(" ", "") for line in needed) == required(PROJECT["dependencies"])
    assert recipe["context"]["version"] == asperity.__version__
    assert recipe["about"]["license"] == PROJECT["license"]
    assert json.loads(text(".zenodo.json"))["title"] == yaml.safe_load(text("CITATION.cff"))["title"]
    left = [
        name
        for name in ("SECURITY.md", "CODE_OF_CONDUCT.md", ".zenodo.json", "CITATION.cff", "paper/paper.md")
        if PERSON in text(name)
    ]
    assert all(name in text("CONTRIBUTING.md") for name in (*left, "packaging/README.md"))


def test_compiled_functions_of_the_image_are_where_only_the_administrator_writes():
    image = text("packaging/Containerfile")
    folders = dict(re.findall(r"(ASPERITY_\w+)=(\S+)", image))
    assert not folders["ASPERITY_KERNELS"].startswith(folders["ASPERITY_CACHE"])
    assert 'go-w "$ASPERITY_KERNELS"' in image


def workflow(name):
    return yaml.safe_load(text(f".github/workflows/{name}.yml"))


def commands(job):
    return [step["run"] for step in job["steps"] if "run" in step]


def module_at(path):
    """A module that belongs to no package."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_version_is_the_same_everywhere():
    assert f"\nversion: {asperity.__version__}\n" in text("CITATION.cff")
    assert f"\n## {asperity.__version__} " in text("CHANGELOG.md")
    releases = re.findall(r"^## (\S+)", text("CHANGELOG.md"), re.M)
    assert releases == [asperity.__version__]
    assert "version" in PROJECT["dynamic"]


def test_the_gate_and_the_workflows_call_the_same_commands():
    jobs = workflow("checks")["jobs"]
    assert text(".ci/run").rstrip().endswith('.ci/checks "$@"')
    assert "${{ matrix.versions.command }}" in commands(jobs["checks"])
    oldest, whole = jobs["checks"]["strategy"]["matrix"]["versions"]
    assert whole["command"] == ".ci/checks --long"
    assert f"{oldest['command']} " in text(".ci/checks")
    assert any(command.startswith(".ci/checks --long --cov") for command in commands(jobs["coverage"]))
    assert ".ci/build" in commands(jobs["build"])
    assert workflow("release")["jobs"]["checks"]["uses"] == "./.github/workflows/checks.yml"
    (hook,) = yaml.safe_load(text(".pre-commit-config.yaml"))["repos"][0]["hooks"]
    assert hook["entry"] == ".ci/lint"
    assert ".ci/lint" in text(".ci/checks")
    assert ".ci/docs" in text(".ci/checks")


def test_actions_are_named_by_their_hash_and_workflows_are_read_by_a_checker():
    used = [step["uses"] for name in ("checks", "release") for job in workflow(name)["jobs"].values()
            for step in job.get("steps", []) if "uses" in step]  # fmt: skip
    assert len(used) > 8
    assert all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", each) for each in used)
    assert "workflow_dispatch" in workflow("checks")[True]  # YAML's "on"
    assert "\nzizmor " in text(".ci/lint")


def required(lines):
    """Version by the name of each package, of requirements that state one."""
    stated = [re.split(r">=|==", re.sub(r"\[.*?\]", "", line)) for line in lines if "=" in line]
    return {name: Version(version) for name, version in stated}


def test_the_lowest_versions_declared_are_tested():
    """In a list of their own, as pip takes the newest."""
    extras = PROJECT["optional-dependencies"]
    needed = [*PROJECT["dependencies"], *(line for name in USED for line in extras[name])]
    lines = [line for line in text(".ci/floors.txt").splitlines() if not line.startswith("#")]
    floors = [line for line in lines if "==" in line]
    assert [line for line in lines if line not in floors] == ["pyparsing<3.3"]  # what a floor needs itself
    assert required(floors) == required(needed)
    matrix = workflow("checks")["jobs"]["checks"]["strategy"]["matrix"]
    oldest, *others = [*matrix["versions"], *(leg["versions"] for leg in matrix["include"])]
    assert oldest["releases"] == "-c .ci/floors.txt"
    assert not any(each["releases"] for each in others)
    tested = sorted(each["python"] for each in (oldest, *others) if "may_fail" not in each)
    assert [f"Programming Language :: Python :: {each}" for each in tested] == [
        each for each in PROJECT["classifiers"] if ":: 3." in each
    ]
    (install,) = [each for each in commands(workflow("checks")["jobs"]["checks"]) if "pip install" in each]
    assert install.endswith(" ${{ matrix.versions.releases }}")
    assert PROJECT["requires-python"] == f">={oldest['python']}"
    assert f"numba {required(needed)['numba']} to" in " ".join(options.__doc__.split())


TOP = {
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "CODE_OF_CONDUCT.md",
    "CONFORMANCE.md",
    "CONTRIBUTING.md",
    "LICENSE",
    "README.md",
    "SECURITY.md",
}
SOURCES = {"pyproject.toml", "hatch_build.py"}


def test_the_tree_holds_no_file_that_something_left_there():
    """Examples and tests run in folders of their own."""
    files = {path.name for path in ROOT.iterdir() if path.is_file() and not path.name.startswith(".")}
    assert files - TOP == SOURCES
    assert {path.suffix for path in (ROOT / "examples").iterdir() if path.is_file()} == {
        ".py",
        ".csv",
        ".rst",
    }
    pages = [*(ROOT / "examples").glob("*.py"), *(ROOT / "docs").rglob("*.md")]
    read = " ".join(path.read_text(encoding="utf-8") for path in pages)
    assert all(path.name in read for path in (ROOT / "examples").glob("*.csv"))


def test_every_link_and_picture_of_a_page_leads_somewhere():
    """Generated pages apart, which stand there once the documentation is built."""
    pages = [page for page in (ROOT / "docs").rglob("*.md") if not {"generated", "_build"} & set(page.parts)]
    assert len({page.parent for page in pages}) > 8
    for page in [*ROOT.glob("*.md"), *pages, *ROOT.glob("benchmarks/*.md")]:
        contents = page.read_text(encoding="utf-8")
        links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", contents)
        links += re.findall(r"^```\{(?:image|literalinclude)\} (\S+)", contents, re.MULTILINE)
        for target in links + re.findall(r'src(?:set)?="([^"]+)"', contents):
            assert "://" in target or (page.parent / target).exists(), f"{page.name}: {target}"
        for name in re.findall(r"\{doc\}`(?:[^`<]*<)?([^`>]+)>?`", contents):
            place = ROOT / "docs" / name[1:] if name.startswith("/") else page.parent / name
            assert "generated/" in name or place.with_name(f"{place.name}.md").exists(), (
                f"{page.name}: {name}"
            )


def test_what_holds_a_page_to_its_word_is_not_in_the_eyes_of_its_readers():
    """Checks stand in cells that are left out, but within loops and in pages for those who extend it."""
    checked = 0
    for page in (ROOT / "docs").rglob("*.md"):
        for cell in re.findall(
            r"^```\{code-cell\}.*?\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S
        ):
            checked += "assert " in cell
            shown = ":tags: [remove-cell]" not in cell and page.parent.name != "extend"
            assert not (shown and re.search(r"^assert ", cell, re.MULTILINE)), page.name
    assert checked > 30


def test_every_page_is_named_once_in_the_tables_of_contents():
    docs = ROOT / "docs"
    pages = [page for page in docs.rglob("*.md") if not {"generated", "_build"} & set(page.parts)]
    listed = []
    for page in pages:
        for table in re.findall(r"^```\{toctree\}\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S):
            names = re.findall(r"^(?!:)(?:.*<)?([\w/.]+)>?$", table, re.MULTILINE)
            listed += [(page.parent / f"{name}.md").resolve() for name in names if "generated/" not in name]
    assert sorted(listed) == sorted(page for page in pages if page != docs / "index.md")


def test_every_benchmark_is_named_by_the_question_that_it_answers():
    index, folder = text("benchmarks/README.md").split("\n## ")[0], ROOT / "benchmarks"
    assert len(re.findall(r"^\*\*.*\?\*\*$", index, re.MULTILINE)) >= 6
    left = {"README.md"} | set(re.findall(r"!\[.*?\]\(([\w.]+)\)", text("benchmarks/README.md")))
    files = {path.name for path in folder.iterdir() if path.is_file()} - left
    assert [name for name in sorted(files) if f"`{name}`" not in index] == []
    assert [name for name in re.findall(r"`(\w+\.py)`", index) if not (folder / name).exists()] == []


def test_files_that_contributors_are_sent_to_are_there():
    package = ROOT / "src" / "asperity"
    places = [ROOT, package, package / "laws", package / "surfaces", ROOT / ".github/workflows"]
    names = re.findall(r"`([\w./]+(?:\.py|\.md|\.yml|/)|\.ci/\w+)`", text("CONTRIBUTING.md"))
    assert len(names) > 20
    for name in names:
        assert any((place / name).exists() for place in places), name


def test_what_pages_and_examples_import_is_in_the_reference():
    pages = module_at(ROOT / "docs" / "extensions" / "written_pages.py")
    listed = {line.strip().rpartition(".")[2] for line in pages.api().splitlines()}
    wanted = {"self_affine", "areal_statistics", "homogeneity", "psd_1d", "decay_rate", "RailSection"}
    assert wanted <= listed
    assert {name.rpartition(".")[2] for name in pages.imported()} - {"laws"} <= listed


def test_the_thesis_is_cited_without_a_title_and_its_papers_by_theirs():
    papers = (
        "A nonlinear state-dependent model for vibrations excited by roughness in rolling contacts",
        "Estimation of nonlinearities in the wheel-rail rolling noise generation process",
    )
    assert METHOD[0] == "O. Lundberg, licentiate thesis, KTH Stockholm (2014)."
    told = [" ".join(METHOD), text("CITATION.cff"), text("paper/paper.bib")]
    assert all(paper in words for paper in papers for words in told)
    folders = ("src", "docs", "paper", "examples", "benchmarks")
    files = [file for name in folders for file in (ROOT / name).rglob("*.*") if file.suffix in READ]
    chapter = "state-dependent nonlinear " + "contact modelling"  # the title of its second chapter
    assert not [file for file in files if chapter in file.read_text(encoding="utf-8").lower()]
    assert chapter not in text("CITATION.cff").lower()


def test_what_the_page_on_the_thesis_names_is_there():
    """Every function and test by its file, and every command with its sub-command."""
    page, roots = text("docs/evidence/against_the_thesis.md"), (ROOT / "src" / "asperity", ROOT / "tests")
    named = re.findall(r"`([\w/]+\.py)::([\w.]+)`", page)
    assert len(named) > 30
    for path, name in named:
        (file,) = (root / path for root in roots if (root / path).exists())
        inside = ast.parse(file.read_text(encoding="utf-8")).body
        for part in name.split("."):
            (found,) = (node for node in inside if getattr(node, "name", None) == part)
            inside = found.body
    for number in ("1.1", "1.2", *(f"2.{n}" for n in range(1, 8))):
        assert f"\n| ({number}) |" in page
    for path, command in set(re.findall(r"`python (\w+/\w+\.py)(?: (\w+))?`", page)):
        assert (ROOT / path).exists()
        assert f"def {command}(" in text(path) or not command


def test_the_readme_is_one_screen_with_its_two_commands():
    """A second screen belongs into the documentation."""
    assert README.count("\n") <= 40
    assert len(README.split()) <= 400
    (block,) = re.findall(r"```sh\n(.*?)```", README, re.DOTALL)
    demo, tests = block.splitlines()
    assert demo.endswith("&& asperity demo")
    assert tests.endswith("pytest -q -n 2 --dist loadfile")
    assert "pytest -q -n 2 --dist loadfile" in text("CONTRIBUTING.md")
    doors = re.findall(r"\]\(docs/(\w+)/index\.md\) \| `asperity", README)
    assert doors == ["railway", "bearings", "beams", "surfaces"]


def test_commands_that_pages_lead_to_exist_with_their_options():
    """On the page of questions, and on the doors that lead to it."""
    pages = [
        "start/which_command",
        "index",
        *(f"{door}/index" for door in ("railway", "bearings", "surfaces")),
    ]
    told = " ".join([README, *(text(f"docs/{page}.md") for page in pages)])
    said = re.findall(r"asperity ([a-z]+)([^`\n]*)", told)
    assert len({name for name, _ in said if name in main.commands}) > 10
    for name, words in said:
        if name in main.commands:
            allowed = {each for parameter in main.commands[name].params for each in parameter.opts}
            assert set(re.findall(r"--[a-z-]+", words)) <= allowed, name
    for question in ("What do my pads do?", "Is my bearing broken?", "How stiff is this rough contact?"):
        assert f"| {question} | `asperity " in told
        assert f"**{question}**" in told


def test_the_first_lines_in_python_run(tmp_path, monkeypatch, capsys):
    """Over a tenth of their way."""
    (snippet,) = re.findall(r"```python\n(.*?)```", text("docs/start/index.md"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    shorter = snippet.replace("BallOnBeam(", 'BallOnBeam(duration="50 ms", ')
    (tmp_path / "first.py").write_text(shorter, encoding="utf-8")
    runpy.run_path("first.py")
    told = capsys.readouterr().out
    assert "the contact force varies by " in told
    assert (tmp_path / "force.png").stat().st_size > 10_000
    page = (tmp_path / "page/report.html").read_text(encoding="utf-8")
    assert told.strip().partition(";")[0] in page


@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_an_example_is_short_and_asserts_what_it_says(example):
    """It runs where the gallery is built."""
    contents = example.read_text(encoding="utf-8")
    tree = ast.parse(contents)
    after = tree.body[0].end_lineno if ast.get_docstring(tree) else 0
    stripped = (line.strip() for line in contents.splitlines()[after:])
    assert sum(bool(line) and not line.startswith("#") for line in stripped) <= 60
    assert sum(isinstance(node, ast.Assert) for node in tree.body) >= 2


def test_the_paper_has_the_sections_and_the_length_that_its_journal_asks_for():
    """Journal of Open Source Software, from 2026 on; what only a person can say is marked."""
    sections = ["Summary", "Statement of need", "State of the field", "Software design"]
    sections += ["Research impact statement", "AI usage disclosure", "Acknowledgements", "References"]
    assert re.findall(r"^# (.*)$", PAPER, re.MULTILINE) == sections
    assert 750 <= len(PAPER.split()) <= 1750
    entries = text("paper/paper.bib").split("\n@")[1:]
    seen = [re.search(r"^  doi = \{(10\.\d+/\S+)\},$", each, re.MULTILINE) for each in entries]
    unseen = {each.split("{")[1].split(",")[0] for each, doi in zip(entries, seen, strict=True) if not doi}
    marked = {"Remington1987", "Thompson2009", "Vollebregt2014", "Lundberg2014B"}
    assert unseen == marked | {"Lundberg2014", "Lundberg2014A", "CNOSSOS"}
    assert all(each in text("paper/paper.bib").split("@")[0] for each in marked)


def test_the_paper_cites_its_list_and_its_script_draws_its_figures():
    assert set(re.findall(r"^@\w+\{(\w+),", text("paper/paper.bib"), re.M)) == set(
        re.findall(r"@(\w+)", PAPER)
    )
    script = text("paper/figures.py")
    for name in re.findall(r"\]\((\w+\.png)\)", PAPER):
        assert (ROOT / "paper" / name).stat().st_size > 10_000
        assert f'"{name}"' in script


def median(law, points):
    return statistics.median(p.details["laws"][law] for p in points if law in p.details["laws"])


def test_numbers_of_the_paper_are_those_of_the_map():
    points = law_map().points
    kept = [p for p in points if p.loss < 0.01]
    smooth = [p for p in kept if p.place.within <= 0.1]
    stated = " ".join(PAPER.split())
    assert f"computed at {len(points)} points" in stated
    assert f"`areal` is off by {median('areal', smooth):.1f} dB in the median" in stated
    assert f"with its filter by {median('linear-filtered', smooth):.1f} dB" in stated
    assert f"without by {median('linear', smooth):.1f} dB" in stated
    assert median("table", kept) < 0.1
    (share,) = re.findall(r"\| all \|.*?(\d+) % \|", text("docs/evidence/law_accuracy.md"))
    assert f"held in {share} % of cases" in stated
