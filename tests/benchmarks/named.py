"""Speed of the named networks, in turn: `python -m tests.benchmarks.named [SECONDS]` prints them alone.

Boards, bus and plant, tracking, without host and logs. CPU time, the networks interleaved: machines drift.
"""

import statistics
import sys
import time

from bus.protocol import Device, Opcode, pack_command
from bus.protocol.report import pack_report
from bus.protocol.scales import rate_q16
from plant.model import load
from plant.plant import Plant
from scenarios.lab.network import Network, build
from scenarios.lab.networks import NETWORKS, NetworkConfig

_SECOND_NS = 1_000_000_000
_START = {"ra": float(1 << 28), "dec": float(1 << 28)}
_SIDEREAL_ARCSEC_S = 15.041
ROUNDS = 7


def measure(seconds: int, rounds: int = ROUNDS) -> dict[str, dict[str, float]]:
    """By network: boards, times real time by CPU (median over rounds), the lab's factor over it, bus load.

    seconds: simulated ones per network and round.
    """
    networks = {name: _tracking(name) for name in NETWORKS}
    times: dict[str, list[float]] = {name: [] for name in networks}
    for _ in range(rounds):
        for name, network in networks.items():
            start = time.process_time()
            network.run_until(network.queue.now_ns + seconds * _SECOND_NS)
            times[name].append((time.process_time() - start) / seconds)
    return {
        name: {
            "boards": len(network.boards),
            "factor": 1 / statistics.median(times[name]),
            "of_lab": statistics.median(
                lab / own for lab, own in zip(times["lab"], times[name], strict=True)
            ),
            "bus_load": network.wire.load,
        }
        for name, network in networks.items()
    }


def _tracking(name: str) -> Network:
    """A network whose axes are on; RA follows the sky."""
    network = build(NetworkConfig(name=name), Plant(load(), 1, _START), 1)
    network.run_until(_SECOND_NS)
    commands = [
        pack_command(Device.AXIS_RA, Opcode.POWER, 1),
        pack_command(Device.AXIS_DEC, Opcode.POWER, 1),
        pack_command(Device.AXIS_RA, Opcode.SET_RATE, rate_q16(_SIDEREAL_ARCSEC_S)),
    ]
    if Device.GATEWAY.name in network.boards:
        network.hid.write(network.queue.now_ns, pack_report(commands))
    else:
        for command in commands:
            network.board(Device(command[0]).name).take_command(command)
    network.run_until(2 * _SECOND_NS)
    return network


def lines(found: dict[str, dict[str, float]]) -> list[tuple[str, str, str]]:
    """Rows of the bench's table: what, measured, asked for."""
    return [
        (
            f"network {name}, {each['boards']:.0f} boards, times real time by CPU",
            f"{each['factor']:.0f}, {each['of_lab']:.2f} of lab, bus load {each['bus_load']:.1%}",
            "",
        )
        for name, each in found.items()
    ]


if __name__ == "__main__":
    for what, value, _ in lines(measure(int(sys.argv[1]) if len(sys.argv) > 1 else 20)):
        print(f"{what}: {value}")
