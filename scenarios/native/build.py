"""Builds the compiled library; what cannot be compiled stays plain and is said in one line each."""

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable
from pathlib import Path

from scenarios.native import stamp
from scenarios.native.compile import TRANSLATED
from scenarios.native.modules import PACKAGE, ROOT, selected
from scenarios.progress import Stage

_PREFIX = PACKAGE.replace(".", "/")
_REFUSED = re.compile(rf"^{_PREFIX}(\w+/[\w/]+\.py):\d+: (?:error|[A-Z]\w+Error): (.*)")
_ROUNDS = 5
"""A round costs some twenty seconds; when five have not been enough, something else is wrong."""
_PROBED = ("can", "cantools", "numba", "yaml")
"""What the short run needs beside the sources."""
Say = Callable[[str], None]


class BuildError(ValueError):
    """The library cannot be built here; the message says why."""


def build(
    library: Path = stamp.LIBRARY, say: Say = print, root: Path = ROOT, stage: Stage = lambda _name: None
) -> bool:
    """Build the library unless it fits already; returns whether there was anything to do. stage: is told
    what begins.

    Raises BuildError, and leaves a library that was there before alone.
    """
    found = stamp.read(library)
    if found is not None and stamp.difference(found, root) is None:
        return False
    for need, hint in (("mypyc", "pip install mypy"), ("setuptools", "pip install setuptools")):
        if importlib.util.find_spec(need) is None:
            raise BuildError(f"{need} is not installed ({hint})")
    if not compiler():
        raise BuildError("there is no C compiler")
    with tempfile.TemporaryDirectory(prefix="schmidt-native-") as folder:
        before = stamp.make(root)  # a file that changes while it is compiled makes the library stale
        made = _compile(Path(folder), say, root, stage)
        files = sorted(path.relative_to(made).as_posix() for path in made.rglob(f"*{stamp.suffix()}"))
        modules = {file.removesuffix(stamp.suffix()).replace("/", "."): file for file in files}
        text = json.dumps(before | {"modules": modules}, indent=1)
        (made / stamp.STAMP).write_text(text + "\n", encoding="utf-8")
        stage("holding it against Python")
        _check(made, root)
        fresh = library.with_name(library.name + ".new")
        shutil.rmtree(fresh, ignore_errors=True)
        shutil.copytree(made, fresh)
        shutil.rmtree(library, ignore_errors=True)
        fresh.rename(library)
    return True


def compiler() -> bool:
    """Whether there is a C compiler."""
    command = os.environ.get("CC") or str(sysconfig.get_config_var("CC") or "cc")
    return shutil.which(command.split()[0]) is not None


def _compile(folder: Path, say: Say, root: Path, stage: Stage) -> Path:
    """Compile what can be; returns the folder that holds it."""
    files = selected(root)
    refused: dict[str, str] = {}
    for _ in range(_ROUNDS):
        for file, why in sorted(refused.items()):
            say(f"{file} stays plain: {why}")
        files = [file for file in files if file not in refused]
        command = [
            "-m",
            f"{PACKAGE}scenarios.native.compile",
            str(folder),
            *(_PREFIX + file for file in files),
        ]
        stage("translating to C")
        with _started(command, root, pure="1", stderr=subprocess.STDOUT) as process:
            assert process.stdout is not None
            output = ""
            for line in process.stdout:
                if line.strip() == TRANSLATED:
                    stage("compiling")
                else:
                    output += line
        if not process.returncode:
            return folder / "library"
        found = [match for match in map(_REFUSED.match, output.splitlines()) if match]
        refused = {match[1]: match[2] for match in reversed(found)}  # the first line on a file says why
        refused = {file: why for file, why in refused.items() if file in files}
        if not refused:
            tail = " ".join(output.split()[-40:])
            raise BuildError(f"the compiler failed: {tail}")
    raise BuildError(f"mypyc refused files {_ROUNDS} times over")


def _started(
    arguments: list[str], root: Path, pure: str, stderr: int = subprocess.PIPE
) -> subprocess.Popen[str]:
    """Another Python on the sources under `root`; an isolated build's own packages stay on its path."""
    above = root.parent if PACKAGE else root
    path = os.pathsep.join([str(above), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, "SCHMIDT_PURE": pure, "PYTHONPATH": path}
    command = [sys.executable, *arguments]
    return subprocess.Popen(
        command, cwd=above, env=environment, stdout=subprocess.PIPE, stderr=stderr, text=True
    )


def _check(made: Path, root: Path) -> None:
    """Hold a short run on the library against one without it, if that can be: same digest or no library."""
    if any(importlib.util.find_spec(need) is None for need in _PROBED):
        return  # an isolated build has nothing but the compilers
    found = []
    for pure, library in (("1", ()), ("", (str(made),))):
        with _started(["-m", f"{PACKAGE}scenarios.run.probe", *library], root, pure) as process:
            found.append(process.communicate())
    (plain, _), (native, errors) = found
    if process.returncode:
        raise BuildError(f"it cannot be used: {(errors.strip().splitlines() or ['?'])[-1]}")
    if plain != native:
        raise BuildError("its digest is not that of plain Python; please report it")
