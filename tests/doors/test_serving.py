"""What `schmidt serve` says at its end: of doors that were used how much, of the others that nobody came."""

import json
import threading
from contextlib import suppress
from pathlib import Path

import pytest

from scenarios.doors.options import ServeOptions
from scenarios.doors.serving import serve
from scenarios.doors.stepped import tell
from tests.ports import free_ports


def ended(capsys: pytest.CaptureFixture[str], options: ServeOptions) -> list[str]:
    assert serve(options) == 0
    said = capsys.readouterr().out.splitlines()
    return said[next(index for index, line in enumerate(said) if "s simulated" in line) :]


def test_of_doors_nobody_used_no_figures_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    port, ports = free_ports(1), tmp_path / "ports"
    asked = {"control": (str(port),), "serial": (f"pty:{ports}",)}
    summary, nobody, ticks, motors = ended(capsys, ServeOptions(asked=asked, duration=0.3, realtime=False))
    assert summary.endswith("no input") and "times" not in summary
    assert nobody == f"  nobody came to --serial pty:{ports}, --control {port}"
    assert "ticks within 1 ms" in ticks and motors == "the motors were off"


def test_a_client_that_left_is_counted_and_stepped_time_has_no_pace(
    capsys: pytest.CaptureFixture[str],
) -> None:
    port = free_ports(1)
    status: list[dict[str, float]] = []

    def ask() -> None:
        while not status:
            with suppress(ValueError):  # nobody listens yet
                status.append(json.loads(tell("status", f"127.0.0.1:{port}")))
        tell("stop", f"127.0.0.1:{port}")

    client = threading.Thread(target=ask, daemon=True)
    client.start()
    options = ServeOptions(asked={"control": (str(port),)}, clock="steps", duration=60, realtime=False)
    said = ended(capsys, options)
    client.join()
    assert status[0]["simulated_s"] == 0.0
    assert said == [
        "0.0 s simulated, bus load 0.0%, no input",
        f"  --control {port}: 2 clients",
        "left where they stood",
    ]
