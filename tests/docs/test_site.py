"""What the site and the hosted checks rest on, without building anything: `make docs` does that."""

import re
import tomllib
from pathlib import Path, PurePosixPath

import pytest
import yaml

from docs.generate.tex import tex
from tests.coverage import room, table

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
SECTIONS = ["index.md", "Guides", "Concepts", "Reference", "Results", "Sources", "Decisions"]
TARGETS = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
CI = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
HOSTED = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8"))
COMMANDS = [step["run"] for job in HOSTED["jobs"].values() for step in job["steps"] if "run" in step]


def navigation() -> list[str | dict[str, list[str]]]:
    found: list[str | dict[str, list[str]]] = yaml.safe_load((DOCS / ".nav.yml").read_text(encoding="utf-8"))[
        "nav"
    ]
    return found


def entries() -> set[str]:
    return {
        name
        for entry in navigation()
        for name in ([entry] if isinstance(entry, str) else next(iter(entry.values())))
    }


def test_the_sections_stand_in_their_order() -> None:
    assert [entry if isinstance(entry, str) else next(iter(entry)) for entry in navigation()] == SECTIONS


def test_every_page_has_its_place() -> None:
    """A page beside .nav.yml by its line, a page in a folder by the folder's."""
    listed = entries()
    lost = [
        name
        for name in (path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md"))
        if name not in listed and f"{name.partition('/')[0]}/*" not in listed
    ]
    assert not lost, f"docs/.nav.yml has no line for {', '.join(lost)}"


def test_hosted_jobs_run_what_ci_runs() -> None:
    hosted = {target for command in COMMANDS for target in re.findall(r"make ((?:[a-z]+ ?)+)", command)}
    named = {target for targets in hosted for target in targets.split()}
    ours = set(re.findall(r"^make ([a-z]+)", CI, re.MULTILINE))
    assert {"test", "run", "both", "docs", "guest"} <= ours <= named <= TARGETS


def test_the_hosted_matrix_begins_at_the_oldest_python_that_is_promised() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    versions = HOSTED["jobs"]["test"]["strategy"]["matrix"]["python"]
    assert project["requires-python"] == f">={versions[0]}"
    assert versions == ["3.11", "3.12", "3.13", "3.14"]


def test_every_dependency_of_a_run_or_a_test_has_its_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    tools = ("bench", "cluster", "compiled", "wheels")  # installed for one command each
    every = [each for name, group in extras.items() if name not in tools for each in group]
    wanted = [*project["dependencies"], *(each for each in every if not each.startswith("schmidt["))]
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    fixed = {line.partition("==")[0].lower().replace("_", "-") for line in lines if "==" in line}
    names = {re.split(r"[\[<>=]", each)[0].lower().replace("_", "-") for each in wanted}
    assert names - fixed <= {"setuptools"}  # pip freeze leaves it out
    assert all(re.fullmatch(r"#.*|[\w.-]+==[\w.+!-]+", line) for line in lines), (
        "a place of a package is in it"
    )


def test_coverage_names_the_lowest_room_first() -> None:
    assert room(PurePosixPath("bus/can/node.py")) == "bus/can"
    assert room(PurePosixPath("calibration/names/a/b.py")) == "calibration/names"
    lines = table({"good": (10, 1), "bad": (10, 9)}, most=1).splitlines()
    assert lines[0].split()[0] == "10.0%" and lines[0].endswith("bad")
    assert lines[1].split()[0] == "50.0%"


@pytest.mark.parametrize("name", ["concepts/plant", "concepts/calibration", "reference/effects"])
def test_a_page_of_models_has_formulas(name: str) -> None:
    text = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    formulas = re.findall(r"\$\$\n(.*?)\n\$\$", text, re.DOTALL)
    assert formulas
    assert all(each.count("{") == each.count("}") for each in formulas)


@pytest.mark.parametrize(
    ("equation", "shown"),
    [
        ("T = A sin(order angle + phase)", r"T = A\, \sin ( \text{order angle} + \varphi )"),
        ("Ts -> a Ts, w0^2", r"T_s \to a\, T_s ,\; \omega_0^2"),
        ("column modulo 2^bits", r"\text{column modulo}\, 2^{\text{bits}}"),
        ("a packet is lost with probability p", r"\text{a packet is lost with probability}\, p"),
    ],
)
def test_an_equation_becomes_tex(equation: str, shown: str) -> None:
    assert tex(equation) == shown


def test_version_and_day_are_the_same_wherever_they_stand() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    newest = re.search(
        r"^## (\S+) - (\S+)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert newest and newest.groups() == (cited["version"], str(cited["date-released"]))
    assert cited["version"] == project["version"]
    assert [paper["doi"] for paper in cited["references"]] == ["10.1117/1.OE.52.8.081607"]
