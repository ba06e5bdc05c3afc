"""Only the compiled library; everything else is in pyproject.toml.

`pip install .` and `pip wheel .` compile where they can; where they cannot, one line says why and the wheel
is the pure one. `SCHMIDT_PURE=1` asks for the pure one. An editable installation runs plain until
`make compiled`.
"""

import os
import shutil
import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
os.environ.setdefault("SCHMIDT_PURE", "")
PURE = os.environ["SCHMIDT_PURE"] == "1"


class BuildWithLibrary(build_py):
    """Adds the compiled library to what is installed."""

    def run(self) -> None:
        """Copy the sources, then compile them."""
        super().run()
        if self.editable_mode:
            return
        target = Path(self.build_lib).resolve() / "scenarios" / "native" / "library"
        shutil.rmtree(target, ignore_errors=True)  # parts of a library that lay in the checkout
        if PURE:
            return
        from scenarios.native.build import BuildError, build

        try:
            build(target, root=HERE.resolve())
        except BuildError as error:
            self.announce(f"schmidt: not compiled, plain Python: {error}", level=3)


class Wheel(bdist_wheel):
    """A wheel of this platform when the library is in it, of any otherwise."""

    def get_tag(self) -> tuple[str, str, str]:
        """Python, ABI and platform."""
        library = Path(self.bdist_dir or "") / "scenarios" / "native" / "library"
        self.root_is_pure = not (library / "stamp.json").exists()
        return super().get_tag()


class WithLibrary(Distribution):
    """Lets the tag be decided once the library is there or not."""

    def has_ext_modules(self) -> bool:
        """Whether this may become a wheel of one platform."""
        return not PURE


setup(distclass=WithLibrary, cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": Wheel})
