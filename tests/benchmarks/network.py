"""The main scenario set up for measuring; cost per node."""

import dataclasses
import statistics
import time
from pathlib import Path

from plant.model import load
from plant.plant import Plant
from scenarios.lab.network import Network, build
from scenarios.lab.networks import NetworkConfig
from scenarios.lab.prepare import prepare
from scenarios.lab.session import Session
from scenarios.lab.wiring import start_steps

SCENARIO = Path(__file__).parents[2] / "scenarios" / "observing-night.yaml"
_SETTLED_S = 40
"""By then the telescope tracks its first star."""
_SECOND_NS = 1_000_000_000
_STEP_NS = 10_000_000
MOST_NODES = 64


def session(folder: Path, in_c: bool = False) -> Session:
    """The main scenario with all logs, run until it tracks. in_c: both axis boards run axis.c."""
    scenario, model = prepare(SCENARIO)
    if in_c:
        nodes = {name: {"firmware": "axis.c"} for name in ("AXIS_RA", "AXIS_DEC")}
        scenario = dataclasses.replace(scenario, network={**scenario.network, "nodes": nodes})
    made = Session(scenario, model, folder)
    made.advance(_SETTLED_S * _SECOND_NS)
    return made


def nodes(sizes: tuple[int, ...], seconds: int, rounds: int) -> list[dict[str, float]]:
    """Cost per node: boards, bus and plant without the host, for networks of several sizes, in turn.

    CPU ms per node and simulated second (median over rounds), and its ratio to that of the first size in the
    same round. A bus has 64 nodes at most; more nodes are on two or four buses, each a network of its own,
    taken forward together in steps of 10 ms.
    """
    groups = {size: _networks(size) for size in sizes}
    for networks in groups.values():
        _together(networks, 1)
    times: dict[int, list[float]] = {size: [] for size in sizes}
    for _ in range(rounds):
        for size, networks in groups.items():
            cpu = time.process_time()
            _together(networks, seconds)
            times[size].append(1e3 * (time.process_time() - cpu) / seconds / size)
    first = times[sizes[0]]
    rows = []
    for size, networks in groups.items():
        ratio = spread([own / base for own, base in zip(times[size], first, strict=True)])
        rows.append(
            {
                "nodes": size,
                "buses": len(networks),
                "ms_per_node_and_s": statistics.median(times[size]),
                "of_first": ratio["median"],
                "of_first_noise": ratio["noise"],
                "bus_load": networks[0].wire.load,
            }
        )
    return rows


def _networks(size: int) -> list[Network]:
    scenario, _ = prepare(SCENARIO)
    buses = -(-size // MOST_NODES)
    return [
        build(NetworkConfig(size=size // buses), Plant(load(), 1, start_steps(scenario)), 1 + bus)
        for bus in range(buses)
    ]


def _together(networks: list[Network], seconds: int) -> None:
    t_ns = networks[0].queue.now_ns
    until_ns = t_ns + seconds * _SECOND_NS
    while t_ns < until_ns:
        t_ns = min(until_ns, t_ns + _STEP_NS)
        for network in networks:
            network.run_until(t_ns)


def spread(values: list[float]) -> dict[str, float]:
    """Median, half the range between the quartiles, and the least."""
    if len(values) < 2:
        return {"median": values[0], "noise": float("nan"), "least": values[0]}
    low, middle, high = statistics.quantiles(values, n=4)
    return {"median": middle, "noise": 0.5 * (high - low), "least": min(values)}
