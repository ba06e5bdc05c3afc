"""The file: description, library and the plant file it was made of, in one archive."""

import hashlib
import platform
import zipfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from plant.fmu.description import NAME, description
from plant.fmu.library import FmuError, build
from plant.fmu.tables import header
from plant.fmu.variables import Exported, exported
from plant.model import dumps
from plant.parts import PlantModel

_MACHINES = {"x86_64": "x86_64", "aarch64": "aarch64"}


def write(model: PlantModel, axis: str, seed: int, path: Path, fmi: int = 3) -> Exported:
    """Write one axis (`ra` or `dec`) as a file for FMI 2.0 or 3.0; the same bytes for the same model.

    seed: of noise and of what is by chance, as a run has it. Raises FmuError where this machine cannot, or
    `path` is a folder or a device.
    """
    if path.exists() and not path.is_file():
        raise FmuError(f"{path}: is no regular file, which an archive needs")
    made = exported(model, axis, seed)
    plain = header(made, "")
    token = "{" + hashlib.sha256(f"{fmi}\n{plain}".encode()).hexdigest()[:32] + "}"
    try:
        release = version("schmidt")
    except PackageNotFoundError:
        release = "0"
    parts = {
        "modelDescription.xml": description(made, fmi, token, release),
        _place(fmi): build(header(made, token), fmi),
        "resources/plant.yaml": dumps(model).encode(),
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in parts.items():
            file.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)
    return made


def _place(fmi: int) -> str:
    """Where in the archive this machine's library lies."""
    machine = _MACHINES.get(platform.machine())
    if platform.system() != "Linux" or machine is None:
        raise FmuError(f"an FMU is made on Linux only, not on {platform.system()} {platform.machine()}")
    return f"binaries/{f'{machine}-linux' if fmi == 3 else 'linux64'}/{NAME}.so"
