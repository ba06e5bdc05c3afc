"""Everything a run leaves behind while it runs: can.log, the logs of the host, traces. All of it streams."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO, cast

import numpy as np
import numpy.typing as npt

from bus.can.candump import CandumpWriter
from bus.protocol import Device
from bus.time import generator
from host.logs import distort
from host.logs.axis import AxisLog, Distortion
from host.logs.files import BlockFile, LogError, ZstdFile, check_space
from host.logs.journal import AsciiLogs
from host.logs.traces import Trace
from host.procedures.manual import AXES
from host.serial_link import SerialLink
from plant.grid import TRUTH_COLUMNS
from plant.plant import Plant
from scenarios.language.model import Scenario

HOST_COLUMNS = ("t_s", "ra_steps", "dec_steps", "ra_error_arcsec", "dec_error_arcsec", "focus_half_steps")
FOCUS_COLUMNS = ("t_s", "true_half_steps", "encoder_counts")
_HOST_UNITS = {"t_s": "s", "ra_error_arcsec": "arcsec", "dec_error_arcsec": "arcsec"}


class Recorder:
    """Owns every file of the output folder that grows during a run.

    The digest is SHA-256 over can.log, the axis logs and the truth samples, in this order. Nothing in it
    depends on the wall clock, the speed factor or the folder.
    """

    def __init__(
        self, folder: Path, scenario: Scenario, plant: Plant, headers: dict[str, dict[str, str]]
    ) -> None:
        self.folder = folder
        check_space(folder)
        self.ascii = AsciiLogs(folder, scenario.clock.iso)
        self.axis = {
            name: AxisLog(
                folder / f"axis-{name}.csv", headers[name], _distortions(plant, name, scenario.seed)
            )
            for name in AXES
        }
        packed = scenario.can_log == "zstd"
        (folder / ("can.log" if packed else "can.log.zst")).unlink(missing_ok=True)  # an earlier run's
        self._can_file = ZstdFile(folder / "can.log.zst") if packed else BlockFile(folder / "can.log")
        self.can = CandumpWriter(cast(BinaryIO, self._can_file))
        columns = ("t_s", *(str(name) for name in TRUTH_COLUMNS[1:]))
        self.truth = {name: Trace(folder / f"truth-{name}.parquet", columns, {"t_s": "s"}) for name in AXES}
        self.host = Trace(folder / "host.parquet", HOST_COLUMNS, _HOST_UNITS)
        self.focus = Trace(folder / "focus.parquet", FOCUS_COLUMNS, {"t_s": "s"})
        self._truth_digest = {name: hashlib.sha256() for name in AXES}
        self._plant = plant
        plant.record(self.take_truth, round(scenario.trace_period_s * 1e9))

    def link(self, device: Device) -> SerialLink:
        """The host's end of a board's RS232 line; what an axis board says becomes its log."""
        axis = next((name for name, board in AXES.items() if board == device), None)
        return SerialLink(device, self.ascii, self.axis[axis].packet if axis else lambda _t, _packet: None)

    def adopt(self, plant: Plant) -> None:
        """The truth comes from another plant from now on; it has this recorder's sink already."""
        self._plant = plant

    def take_truth(self, axis: str, rows: npt.NDArray[np.float64]) -> None:
        """Rows of an axis' truth."""
        self._truth_digest[axis].update(np.ascontiguousarray(rows).tobytes())
        self.truth[axis].append(rows)

    def flush(self) -> None:
        """Bring the text logs to disk and see whether there is room for what comes."""
        check_space(self.folder)
        self.can.flush()
        self.ascii.flush()
        for log in self.axis.values():
            log.file.flush()

    def close(self) -> list[str]:
        """Close everything, whatever fails; returns what could not be written."""
        self._plant.record(None)
        failures: list[str] = []
        closers: list[Callable[[], None]] = [self.can.close, self._can_file.close]
        closers += [file.close for file in self.ascii.files()]
        closers += [log.file.close for log in self.axis.values()]
        closers += [trace.close for trace in (*self.truth.values(), self.host, self.focus)]
        for close in closers:
            try:
                close()
            except LogError as error:
                failures.append(str(error))
        return failures

    def digest(self) -> str:
        """The trace digest; call it after `close`."""
        parts = [self.can.hexdigest(), *(self.axis[name].file.hexdigest() for name in AXES)]
        parts += [self._truth_digest[name].hexdigest() for name in AXES]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _distortions(plant: Plant, axis: str, seed: int) -> Distortion | None:
    found: list[Distortion] = []
    for index, (name, given) in enumerate(plant.log_effects(axis)):
        make: Callable[..., Distortion] = getattr(distort, name)
        found.append(make(generator(seed, f"log.{axis}.{name}.{index}"), **given))
    return distort.chain(found)
