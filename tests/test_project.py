"""What stands around the code: versions that agree, workflows that call the same commands, addresses."""

import importlib.util
import re
import tomllib
from pathlib import Path

import yaml

import asperity
from asperity.kernels import options
from asperity.scenes.result import METHOD

ROOT = Path(__file__).parents[1]
READ = (".py", ".md", ".bib", ".rst", ".toml")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


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
    assert "version" in PROJECT["dynamic"]


def test_the_gate_and_the_workflows_call_the_same_commands():
    jobs = workflow("checks")["jobs"]
    assert text(".ci/run").rstrip().endswith('.ci/checks "$@"')
    assert "${{ matrix.versions.command }}" in commands(jobs["checks"])
    oldest, newest = jobs["checks"]["strategy"]["matrix"]["versions"]
    assert newest["command"] == ".ci/checks --long"
    assert f"{oldest['command']} " in text(".ci/checks")
    assert any(command.startswith(".ci/checks --long --cov") for command in commands(jobs["coverage"]))
    assert ".ci/build" in commands(jobs["build"])
    assert workflow("release")["jobs"]["checks"]["uses"] == "./.github/workflows/checks.yml"
    (hook,) = yaml.safe_load(text(".pre-commit-config.yaml"))["repos"][0]["hooks"]
    assert hook["entry"] == ".ci/lint"
    assert ".ci/lint" in text(".ci/checks")
    assert ".ci/docs" in text(".ci/checks")


def test_the_oldest_versions_are_tested():
    oldest, newest = workflow("checks")["jobs"]["checks"]["strategy"]["matrix"]["versions"]
    (numba,) = [name for name in PROJECT["dependencies"] if name.startswith("numba")]
    assert oldest["numba"].replace("==", ">=").removesuffix(".*") == numba
    assert PROJECT["requires-python"] == f">={oldest['python']}"
    assert newest["numba"] == "numba"
    assert f"numba {numba.removeprefix('numba>=')} to" in " ".join(options.__doc__.split())


def test_every_link_of_a_page_leads_somewhere():
    for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("benchmarks/*.md")]:
        for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert "://" in target or (page.parent / target).exists(), f"{page.name}: {target}"


def test_files_that_contributors_are_sent_to_are_there():
    package = ROOT / "src" / "asperity"
    places = [ROOT, package, package / "laws", package / "surfaces", ROOT / ".github/workflows"]
    names = re.findall(r"`([\w./]+(?:\.py|\.md|\.yml|/)|\.ci/\w+)`", text("CONTRIBUTING.md"))
    assert len(names) > 20
    for name in names:
        assert any((place / name).exists() for place in places), name


def test_no_two_files_of_tests_have_one_name():
    """They are modules without packages: of two, one would be left out."""
    names = [path.name for path in Path(__file__).parent.rglob("test_*.py")]
    assert len(set(names)) == len(names)


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
