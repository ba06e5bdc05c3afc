"""P13: the wind of the mast presses on the axes through the slit of the dome."""

from math import cos, radians
from pathlib import Path

import pytest

from bus.can import Frame
from bus.protocol import pack_command
from bus.protocol.nodes import DOME, arguments_of
from plant.kernels import layout as at
from scenarios.lab.network import Network
from scenarios.lab.prepare import prepare
from scenarios.lab.snapshot.freeze import restore, take
from scenarios.lab.wiring import wire
from scenarios.native import compiled

SECOND_NS = 1_000_000_000
MEAN = 4
SCENARIO = """\
name: in the wind
start_utc: 2026-02-10T14:00:00Z
network:
  name: {name}
  wind_from: 30 deg
{nodes}
steps:
  - wait: {{for: 1 s}}
"""
NODES = "  nodes:\n    WEATHER_MAST: {inputs: {wind: [{at: 0 s, value: 8}, {at: 150 s, value: 4}]}}"


def built(folder: Path, name: str = "final", nodes: str = NODES) -> Network:
    file = folder / "wind.yaml"
    file.write_text(SCENARIO.format(name=name, nodes=nodes))
    return wire(*prepare(file))


def ask(network: Network, opcode: int, *arguments: int) -> None:
    device = DOME.device("DOME")
    port = network.wire.attach(f"pc {network.queue.now_ns}")
    frame = Frame(0x080 + device, pack_command(device, opcode, *arguments))
    port.send(frame, network.queue.now_ns)


def go_on(network: Network, seconds: float) -> None:
    network.run_until(network.queue.now_ns + round(seconds * SECOND_NS))
    network.plant.advance(network.queue.now_ns)


def numbers(network: Network) -> list[list[float]]:
    """Of both axes: three lags of the gusts, seed, mean, N m, deviation, correlation time, s."""
    assert network.blowing is not None
    starts = (place - at.ROW_KIND + at.ROW_MEMORY for place in network.blowing.places)
    return [[network.plant.view[start + k] for k in range(7)] for start in starts]


@pytest.mark.slow
def test_P13_the_dome_lets_in_what_its_slit_shows_of_the_wind(tmp_path: Path) -> None:
    network = built(tmp_path)
    goto, shutter, _ = arguments_of(DOME)
    assert network.blowing is not None
    go_on(network, 3.0)
    assert [each[MEAN : MEAN + 2] for each in numbers(network)] == [[0.0, 0.0]] * 2  # the shutter is closed
    ask(network, shutter, 1)
    go_on(network, 33.0)
    assert network.blowing.speed(network.queue.now_ns) == pytest.approx(8 * cos(radians(30)))
    ra, dec = numbers(network)
    # by hand: 0.5 * 1.0 kg/m3 * (6.93 m/s)^2 * 1.0 * 1.2 m2 * 0.33 m, gusts of 40 % of it, 1 m / 6.93 m/s
    assert ra[MEAN:] == dec[MEAN:] == pytest.approx([9.504, 3.802, 0.1443], rel=1e-3)
    assert ra[:MEAN] != dec[:MEAN] and ra[0] != 0.0  # gusts of their own
    ask(network, goto, 21000)  # 210 deg: the lee, reached in 75 s
    go_on(network, 90.0)
    assert network.blowing.speed(network.queue.now_ns) == pytest.approx(0.8)
    ask(network, goto, 3000)
    go_on(network, 100.0)
    assert network.blowing.speed(network.queue.now_ns) == pytest.approx(4.0, rel=1e-3)  # the wind has dropped
    assert numbers(network)[0][MEAN] == pytest.approx(0.5 * 1.0 * 16.0 * 1.2 * 0.33, rel=2e-3)


def test_P13_a_broken_sensor_stops_no_wind(tmp_path: Path) -> None:
    network = built(tmp_path)
    assert network.blowing is not None
    network.blowing.dome = None  # in the open
    network.board("WEATHER_MAST").pins["wind"] = lambda _t_ns: 0.0
    assert network.blowing.speed(SECOND_NS) == 8.0


def test_P13_who_has_no_mast_has_no_wind(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^network: wind_from: there is no board WEATHER_MAST"):
        built(tmp_path, "lab", "")


@pytest.mark.skipif(compiled(), reason="snapshots need the plain source")
def test_P13_a_snapshot_keeps_the_wind(tmp_path: Path) -> None:
    network = built(tmp_path)
    _, shutter, _ = arguments_of(DOME)
    go_on(network, 1.0)
    ask(network, shutter, 1)
    go_on(network, 34.0)
    again = restore(take(network))
    for each in (network, again):
        go_on(each, 5.0)
    assert numbers(again) == numbers(network) and numbers(network)[0][MEAN] > 5.0
    assert (again.plant.world == network.plant.world).all()
