"""The compiler's process: `python -m scenarios.native.compile TARGET FILE...`, in the folder of the sources.

Kept apart from `build.py` because mypyc ends the process when it refuses a file.
"""

import os
import sys
from pathlib import Path

GROUP = "schmidt"
"""The one shared library is `schmidt__mypyc`; each module is a small file beside it."""
TRANSLATED = "schmidt: translated"
"""Printed when the C sources are there."""
_INSIDE = ("-fvisibility=hidden", "-fno-semantic-interposition", "-fno-plt")
"""For gcc and clang: calls inside the library go straight there, not through the linker's table."""
_BOUND = ("-Wl,-z,now",)


def main(target: Path, files: list[str]) -> None:
    """Compile `files` into `target`."""
    from mypyc.build import mypycify
    from setuptools import setup

    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    options = [f"--python-version={version}", "--ignore-missing-imports", f"--cache-dir={target / 'cache'}"]
    extensions = mypycify(
        [*options, *files], opt_level="2", debug_level="0", target_dir=str(target / "c"), group_name=GROUP
    )
    print(TRANSLATED, flush=True)
    if sys.platform == "linux":
        for extension in extensions:
            extension.extra_compile_args = [*extension.extra_compile_args, *_INSIDE]
            extension.extra_link_args = [*(extension.extra_link_args or ()), *_BOUND]
    setup(
        name="schmidt-compiled",
        ext_modules=extensions,
        packages=[],
        py_modules=[],
        script_args=[
            "--quiet",
            "build_ext",
            f"--parallel={os.cpu_count() or 1}",
            f"--build-lib={target / 'library'}",
            f"--build-temp={target / 'o'}",
        ],
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), sys.argv[2:])
