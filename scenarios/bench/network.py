"""The main scenario set up for measuring; cost per node; memory."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from plant.model import load
from plant.plant import Plant
from scenarios import run as runner
from scenarios.network import Network, build
from scenarios.networks import NetworkConfig
from scenarios.session import Session, start_steps

SCENARIO = Path(__file__).parents[1] / "observing-night.yaml"
_SETTLED_S = 40
"""By then the telescope tracks its first star."""
_SECOND_NS = 1_000_000_000
_STEP_NS = 10_000_000
MOST_NODES = 64


def session(folder: Path) -> Session:
    """The main scenario with all logs, run until it tracks."""
    scenario, model = runner.prepare(SCENARIO)
    made = Session(scenario, model, folder)
    made.advance(_SETTLED_S * _SECOND_NS)
    return made


def factor(advance: Callable[[int], None], start_ns: int, seconds: int, parts: int = 5) -> dict[str, float]:
    """Simulated over wall and over CPU time: the median of several parts, and the best."""
    walls, cpus = [], []
    for part in range(parts):
        wall, cpu = time.perf_counter(), time.process_time()
        advance(start_ns + (part + 1) * seconds * _SECOND_NS // parts)
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    simulated = seconds / parts
    middle = parts // 2
    return {
        "real_time_factor": simulated / sorted(walls)[middle],
        "cpu_time_factor": simulated / sorted(cpus)[middle],
        "best_real_time_factor": simulated / min(walls),
    }


def nodes(sizes: tuple[int, ...], seconds: int) -> list[dict[str, float]]:
    """Cost per node: boards, bus and plant without the host, for networks of several sizes.

    A bus has 64 nodes at most; more nodes are on two or four buses, each a network of its own, taken forward
    together in steps of 10 ms.
    """
    scenario, _ = runner.prepare(SCENARIO)
    rows = []
    for size in sizes:
        buses = -(-size // MOST_NODES)
        networks = [
            build(NetworkConfig(size=size // buses), Plant(load(), 1, start_steps(scenario)), 1 + bus)
            for bus in range(buses)
        ]

        def together(until_ns: int, networks: list[Network] = networks) -> None:
            while networks[0].queue.now_ns < until_ns:
                t_ns = min(until_ns, networks[0].queue.now_ns + _STEP_NS)
                for network in networks:
                    network.run_until(t_ns)

        together(_SECOND_NS)
        made = factor(together, _SECOND_NS, seconds)
        per_node = 1e3 / made["cpu_time_factor"] / size
        load_now = networks[0].wire.load
        rows.append(
            {"nodes": size, "buses": buses, "ms_per_node_and_s": per_node, **made, "bus_load": load_now}
        )
    return rows


def memory(seconds: int) -> dict[str, float]:
    """Growth of the resident set, MiB per simulated hour, and what a ten-hour night would reach."""
    with tempfile.TemporaryDirectory() as folder:
        made = session(Path(folder))
        made.advance(
            made.network.queue.now_ns + seconds // 2 * _SECOND_NS
        )  # fill buffers and row groups first
        before, start_ns = resident_mib(), made.network.queue.now_ns
        while made.network.queue.now_ns < start_ns + seconds * _SECOND_NS:
            made.advance(made.network.queue.now_ns + _SECOND_NS)
            made.recorder.flush()
        after = resident_mib()
        made.recorder.close()
    per_hour = (after - before) * 3600 / seconds
    return {"resident_MiB": after, "MiB_per_hour": per_hour, "ten_hours_MiB": after + 10 * max(0.0, per_hour)}


def resident_mib() -> float:
    """Resident set of this process, MiB (its peak where the system has no /proc)."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
