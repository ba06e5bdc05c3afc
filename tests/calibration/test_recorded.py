"""The same drive as CSV, MCAP and MF4: calibrate finds the same part in all of them."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from calibration.command import calibrate
from calibration.errors import CalibrationInputError
from calibration.inputs.recordings import read_mcap
from tests.calibration.test_rotary import RIG, night

BEGIN_NS = 1_770_732_000_000_000_000
"""2026-02-10T14:00:00Z."""


def write_csv(path: Path, columns: dict[str, np.ndarray]) -> None:
    rows = np.column_stack([*columns.values()])
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.12g")


def write_mf4(path: Path, columns: dict[str, np.ndarray]) -> None:
    from asammdf import MDF, Signal

    with MDF() as made:
        made.append([Signal(values, columns["time"], name=name) for name, values in columns.items()][1:])
        made.save(path)


def write_mcap(path: Path, columns: dict[str, np.ndarray]) -> None:
    from mcap.writer import Writer

    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema: dict[str, Any] = {"type": "object", "properties": {"x": {"type": "number"}}}
        number = writer.register_schema("/drive", "jsonschema", json.dumps(schema).encode())
        channel = writer.register_channel("/drive", "json", number)
        for t, *values in zip(*columns.values(), strict=True):
            body = dict(zip(list(columns)[1:], map(float, values), strict=True))
            at_ns = BEGIN_NS + round(t * 1e9)
            writer.add_message(channel, at_ns, json.dumps(body).encode(), at_ns)
        writer.finish()


@pytest.mark.slow
def test_calibrate_finds_the_same_in_every_format(tmp_path: Path) -> None:
    found = {}
    for write, prefix in ((write_csv, ""), (write_mf4, ""), (write_mcap, "/drive.")):
        kind = write.__name__.removeprefix("write_")
        folder = tmp_path / kind
        folder.mkdir()
        rig = RIG.replace("column: t,", "column: time,")
        for name in ("x", "u"):
            rig = rig.replace(f"column: {name},", f"column: {prefix}{name},")
        (folder / "rig.yaml").write_text(rig)
        files = [folder / f"run{k}.{kind}" for k in range(3)]
        for k, file in enumerate(files):
            t, x, u = night(k)
            away = (x / 0.9 - 0.3 + 0.5) % 1.0 - 0.5
            pulse = 0.8 * np.exp(-0.5 * (away / 0.02) ** 2)  # N m, at one place of the pinion
            write(file, {"time": t, "x": x, "u": u - pulse})
        out = folder / "out"
        assert calibrate(files, folder / "rig.yaml", [], out, plots=False) == 0
        (found[kind],) = json.loads((out / "report.json").read_text())["effects"]
    assert found["csv"]["name"] == "damaged_tooth"
    for kind in ("mf4", "mcap"):
        assert found[kind]["name"] == "damaged_tooth"
        for name, parameter in found["csv"]["parameters"].items():
            assert found[kind]["parameters"][name]["value"] == pytest.approx(parameter["value"], rel=1e-6)


@pytest.mark.parametrize(("write", "kind"), [(write_mf4, "mf4"), (write_mcap, "mcap"), (savemat, "mat")])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.6])
def test_a_recording_cut_short_is_one_line_without_a_librarys_words(
    write: Callable[[Path, Any], None], kind: str, share: float, tmp_path: Path
) -> None:
    file = tmp_path / f"log.{kind}"
    t = 0.01 * np.arange(1000.0)
    write(file, {"time": t, "x": t, "u": t})
    file.write_bytes(file.read_bytes()[: round(share * file.stat().st_size)])
    rig = RIG.replace("column: t,", "column: time,")
    (tmp_path / "rig.yaml").write_text(rig)
    with pytest.raises(CalibrationInputError) as caught:
        calibrate([file], tmp_path / "rig.yaml", [], tmp_path / "out", plots=False)
    said = str(caught.value)
    assert said.startswith(str(file)) and "\n" not in said
    assert re.search(r"; (export|record|save) it", said) or said.endswith("is empty"), said


def test_an_mcap_whose_chunk_is_damaged_is_one_line(tmp_path: Path) -> None:
    file = tmp_path / "log.mcap"
    t = 0.01 * np.arange(300.0)
    write_mcap(file, {"time": t, "x": t, "u": t})
    data = bytearray(file.read_bytes())
    at = data.index(b"zstd") + 20
    data[at : at + 40] = bytes(40)
    file.write_bytes(data)
    with pytest.raises(CalibrationInputError, match="is no MCAP file that can be read"):
        read_mcap(file, ["time", "/drive.x"])
