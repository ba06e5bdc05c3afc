"""The build: what pyproject.toml says, the rooms below one package, and the compiled library in the wheel.

In the checkout the rooms are top-level folders; in a wheel they are `schmidt.bus` and so on
(`scenarios/native/relocate.py`). `SCHMIDT_PURE=1 pip install .` leaves the library out; so does a machine
without a compiler, in one line.
"""

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


class BuildWithLibrary(build_py):
    """Relocates what is installed and adds the compiled library."""

    def run(self) -> None:
        """Copy the sources, put them below one package, then compile them."""
        super().run()
        if self.editable_mode:
            return
        from scenarios.native.relocate import relocate

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
        from scenarios.native.relocate import entry_point

        points = {group: list(lines) for group, lines in self.entry_points.items()}
        points["pytest11"] = ["schmidt = bus.kit", "schmidt-lab = scenarios.lab.fixture"]
        for group, lines in points.items():
            parts = [line.partition("=") for line in lines]
            points[group] = [f"{name.strip()} = {entry_point(at.strip())}" for name, _, at in parts]
        self.entry_points = points


# Python takes a folder `schmidt.egg-info` beside the sources for what is installed: a wheel's entry points
# are none of the checkout's.
METADATA = HERE / "build" / "metadata"
OPTIONS = {} if EDITABLE else {"egg_info": {"egg_base": str(METADATA)}}
if OPTIONS:
    METADATA.mkdir(parents=True, exist_ok=True)
setup(options=OPTIONS, distclass=WithLibrary, cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": Wheel})
