"""The build: what pyproject.toml says, the rooms below one package, and the compiled library in the wheel.

In the checkout the rooms are top-level folders, which is how they import each other; in a wheel they are
`schmidt.bus` and so on. A user may have a `plant.py` or a `bus/` of their own, which an installed `schmidt`
must neither take nor give way to. `SCHMIDT_PURE=1 pip install .` leaves the library out; so does a machine
without a compiler, in one line.
"""

import ast
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
os.environ.setdefault("SCHMIDT_PURE", "")
PURE = os.environ["SCHMIDT_PURE"] == "1"
EDITABLE = not {"editable_wheel", "develop"}.isdisjoint(sys.argv)
LIBRARY = Path("schmidt") / "scenarios" / "native" / "library"
OURS = ("bus", "boards", "plant", "host", "scenarios", "calibration")
"""The rooms."""


class RelocationError(ValueError):
    """An import that has no relocated form."""


def relocate(folder: Path) -> Path:
    """Move the rooms below `folder/schmidt`, which begins as `schmidt.py`, rewrite imports; returns it."""
    package = folder / "schmidt"
    shutil.rmtree(package, ignore_errors=True)
    package.mkdir()
    front = folder / "schmidt.py"
    text = rewritten(front.read_text(encoding="utf-8"), front.name)
    (package / "__init__.py").write_text(text, encoding="utf-8")
    front.unlink()
    for room in OURS:
        (folder / room).rename(package / room)
        for file in sorted((package / room).rglob("*.py")):
            source = file.read_text(encoding="utf-8")
            file.write_text(rewritten(source, str(file.relative_to(folder))), encoding="utf-8")
    return package


def rewritten(source: str, name: str = "<source>") -> str:
    """`source` with `from plant.model import …` as `from schmidt.plant.model import …`, and `import plant` as
    `import schmidt.plant as plant`. Raises RelocationError for `import plant.model`, which binds `plant`."""
    lines = source.splitlines(keepends=True)
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module and not node.level and _ours(node.module):
            _insert(lines, node, "from ")
        elif isinstance(node, ast.Import) and any(_ours(alias.name) for alias in node.names):
            alias = node.names[0]
            if len(node.names) > 1 or ("." in alias.name and not alias.asname):
                raise RelocationError(f"{name}:{node.lineno}: write `from … import …` here")
            _insert(lines, node, "import ", "" if alias.asname else f" as {alias.name}")
    return "".join(lines)


def _ours(module: str) -> bool:
    return module.partition(".")[0] in OURS


def _insert(lines: list[str], node: ast.ImportFrom | ast.Import, word: str, behind: str = "") -> None:
    """Put the package's name behind `word` of the statement at `node`, and `behind` at its end."""
    line = lines[node.lineno - 1]
    at = len(line.encode()[: node.col_offset].decode()) + len(word)
    if behind:
        end = len(line.encode()[: node.end_col_offset].decode())
        line = line[:end] + behind + line[end:]
    lines[node.lineno - 1] = f"{line[:at]}schmidt.{line[at:]}"


def entry_point(target: str) -> str:
    """`scenarios.cli:main` where the wheel has it."""
    return f"schmidt.{target}" if _ours(target) else target


class BuildWithLibrary(build_py):
    """Relocates what is installed and adds the compiled library."""

    def run(self) -> None:
        """Copy the sources, put them below one package, then compile them."""
        super().run()
        if self.editable_mode:
            return
        folder = Path(self.build_lib).resolve()
        shutil.rmtree(folder / "scenarios" / "native" / "library", ignore_errors=True)  # the checkout's own
        relocate(folder)
        if PURE:
            return
        path = os.pathsep.join([str(folder), *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = {**os.environ, "PYTHONPATH": path}
        subprocess.run(
            [sys.executable, "-m", "schmidt.scenarios.native"], cwd=folder, env=environment, check=False
        )


class Wheel(bdist_wheel):
    """A wheel of this platform when the library is in it, of any otherwise."""

    def get_tag(self) -> tuple[str, str, str]:
        """Python, ABI and platform."""
        self.root_is_pure = not (Path(self.bdist_dir or "") / LIBRARY / "stamp.json").exists()
        return super().get_tag()


class WithLibrary(Distribution):
    """Lets the tag be decided once the library is there or not, and names entry points where they will be."""

    def has_ext_modules(self) -> bool:
        """Whether this may become a wheel of one platform."""
        return not PURE

    def iter_distribution_names(self) -> Iterator[str]:
        """What an installer is told of as top-level names."""
        return super().iter_distribution_names() if EDITABLE else iter(["schmidt"])

    def parse_config_files(self, *arguments: object, **options: object) -> None:
        """As ever; in a wheel the rooms are below `schmidt`, and the kit is a plug-in of pytest.

        A checkout has no plug-in: whoever has a `bus/` of his own on the path could not start pytest.
        """
        super().parse_config_files(*arguments, **options)
        if EDITABLE or not self.entry_points:
            return
        points = {group: list(lines) for group, lines in self.entry_points.items()}
        points["pytest11"] = ["schmidt = bus.kit", "schmidt-lab = scenarios.lab.fixture"]
        for group, lines in points.items():
            parts = [line.partition("=") for line in lines]
            points[group] = [f"{name.strip()} = {entry_point(at.strip())}" for name, _, at in parts]
        self.entry_points = points


if __name__ == "__main__":
    # Python takes a folder `schmidt.egg-info` beside the sources for what is installed: a wheel's entry
    # points are none of the checkout's.
    metadata = HERE / "build" / "metadata"
    options = {} if EDITABLE else {"egg_info": {"egg_base": str(metadata)}}
    if options:
        metadata.mkdir(parents=True, exist_ok=True)
    commands = {"build_py": BuildWithLibrary, "bdist_wheel": Wheel}
    setup(options=options, distclass=WithLibrary, cmdclass=commands)
