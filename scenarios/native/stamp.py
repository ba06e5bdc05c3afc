"""What a library was made of, so that it is never taken for something else.

The stamp lists every selected file and every file of ours these import names from, with their hashes. Such
a name may be a constant that is compiled in. The stamp also names the interpreter the library was built for.
"""

import ast
import hashlib
import json
import sysconfig
from pathlib import Path

from scenarios.native.modules import PACKAGE, ROOMS, ROOT, selected

LIBRARY = Path(__file__).with_name("library")
STAMP = "stamp.json"
CHOICE = "scenarios/native/modules.py"


def suffix() -> str:
    """Ending of a compiled module for this interpreter, such as `.cpython-311-x86_64-linux-gnu.so`."""
    return str(sysconfig.get_config_var("EXT_SUFFIX"))


def digest(path: Path) -> str:
    """SHA-256 of a file; empty when it is not there."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


def sources(root: Path = ROOT) -> list[str]:
    """The selected files, what they import and the list that selects them, relative to `root`."""
    chosen = selected(root)
    found = {*chosen, CHOICE}
    for path in chosen:
        found |= _imported(root, path)
    return sorted(found)


def make(root: Path = ROOT) -> dict[str, object]:
    """The stamp of a library made of the files under `root`; its `modules` (name to file) come with it."""
    return {"suffix": suffix(), "sources": {path: digest(root / path) for path in sources(root)}}


def read(library: Path = LIBRARY) -> dict[str, object] | None:
    """The stamp of a library, None when there is none."""
    try:
        found: dict[str, object] = json.loads((library / STAMP).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found


def difference(stamp: dict[str, object], root: Path = ROOT) -> str | None:
    """Why a library does not fit the files under `root`; None when it does."""
    if stamp.get("suffix") != suffix():
        return f"was built for another Python ({stamp.get('suffix')})"
    hashes = stamp.get("sources")
    if not isinstance(hashes, dict):
        return "has a stamp of another version"
    for path, before in hashes.items():
        if digest(root / path) != before:
            return f"was built before {path} changed"
    added = set(selected(root)) - set(hashes)
    return f"was built before {min(added)} came" if added else None


def _imported(root: Path, path: str) -> set[str]:
    """Files of ours that a module imports from, relative to `root`."""
    found = set()
    for node in ast.walk(ast.parse((root / path).read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        for name in (each.removeprefix(PACKAGE) for each in names):
            if name.split(".")[0] in ROOMS:
                place = name.replace(".", "/")
                found |= {each for each in (f"{place}.py", f"{place}/__init__.py") if (root / each).is_file()}
    return found
