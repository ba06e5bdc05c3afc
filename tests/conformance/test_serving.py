"""`schmidt serve` in this process, on python-can's own virtual bus."""

from pathlib import Path

import can
import pytest

from bus import protocol as p
from bus.outside.external import SpecError
from scenarios.doors.options import ServeOptions
from scenarios.doors.serving import serve

CAN = {"can": ("virtual:test-serve",)}


def test_serve_joins_the_bus_and_ends_by_itself(capsys: pytest.CaptureFixture[str]) -> None:
    ping = can.Message(
        arbitration_id=p.COMMAND_BASE + p.Device.DISPLAY,
        data=p.pack_command(p.Device.DISPLAY, p.Opcode.PING),
        is_extended_id=False,
    )
    with can.Bus(interface="virtual", channel="test-serve") as outside:
        outside.send(ping)  # nobody is there yet
        assert serve(ServeOptions(asked=CAN, speed=2.0, duration=0.5)) == 0
        heard = []
        while (message := outside.recv(timeout=0)) is not None:
            heard.append(message)
    identifiers = {message.arbitration_id for message in heard}
    assert p.MEASUREMENT_BASE + p.Device.POSITION_RA in identifiers
    assert all(message.data[0] == message.arbitration_id & 0x7F for message in heard)
    assert len(heard) > 100
    said = capsys.readouterr().out
    assert "serving 11 boards at 2 times real time" in " ".join(said.split())


@pytest.mark.parametrize("spec", ["virtual", "nonsense:x"])
def test_a_bus_that_cannot_be_opened_is_refused_before_anything_is_built(spec: str) -> None:
    with pytest.raises(SpecError, match=spec):
        serve(ServeOptions(asked={"can": (spec,)}))


def test_a_scenario_that_does_not_exist_is_one_line() -> None:
    with pytest.raises(ValueError, match=r"nowhere\.yaml") as error:
        serve(ServeOptions(asked=CAN, scenario=Path("nowhere.yaml")))
    assert "\n" not in str(error.value)
