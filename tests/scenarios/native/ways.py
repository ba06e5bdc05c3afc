"""`python -m tests.scenarios.native.ways`: digests of what must not depend on the way the source is run, as
JSON."""

import json
import tempfile
from pathlib import Path

from scenarios.lab.prepare import prepare
from scenarios.lab.session import Session
from scenarios.native import compiled

SCENARIOS = Path(__file__).parents[3] / "scenarios"
RUNS = {"observing-night": 60, "frame-loss": 30, "node-off": 25}
"""Scenarios and how much of them, s: the main one, and two in which things go wrong."""
CASES = 400


def session(name: str, seconds: int) -> str:
    """Trace digest of the first `seconds` of a scenario."""
    scenario, model = prepare(SCENARIOS / f"{name}.yaml")
    with tempfile.TemporaryDirectory() as folder:
        made = Session(scenario, model, Path(folder))
        made.advance(seconds * 1_000_000_000)
        made.recorder.close()
        return made.recorder.digest()


def fuzz(seed: int) -> str:
    """Digest of the traffic when anything at all comes in: frames with any bytes, HID reports with any bytes,
    bits that flip, boards that lose their supply."""
    from random import Random

    from bus.can import Flip, Frame
    from bus.can.candump import CandumpWriter
    from plant.model import load
    from plant.plant import Plant
    from scenarios.lab.network import build

    random = Random(seed)
    network = build(None, Plant(load(), seed), seed)
    log = CandumpWriter(None)
    network.wire.tap(log.take)
    stranger = network.wire.attach("stranger")
    boards = sorted(network.boards)

    def flips(_t_ns: int, _frame: Frame, _sender: str) -> Flip | None:
        if random.random() > 0.01:
            return None
        return Flip(random.randrange(120), random.choice([None, *boards]))

    for case in range(CASES):
        now = network.queue.now_ns
        identifier = random.choice([0x080, 0x100, 0x200, 0x300, 0x700, 0]) + random.randrange(0x80)
        data = random.randbytes(random.choice([8, 8, 8, random.randrange(9)]))
        if len(data) > 1 and random.random() < 0.7:
            data = bytes([identifier & 0x7F, random.randrange(0x20)]) + data[2:]
        stranger.send(Frame(identifier, data, False, random.random() < 0.05), now)
        if random.random() < 0.3:
            network.hid.write(now, random.randbytes(64))
        if case % 100 == 50:
            network.wire.disturb(flips)
        if case % 100 == 70:
            network.wire.disturb(None)
        if case % 80 == 40:
            board = network.boards[random.choice(boards)]
            board.power_off(now)
            board.power_on(now)
        network.run_until(now + random.randrange(30_000_000))
    counters = [network.wire.frames, network.wire.errors, network.overruns, network.dropped]
    return f"{log.hexdigest()} {counters}"


def main() -> None:
    """Print way and digests."""
    figures = {name: session(name, seconds) for name, seconds in RUNS.items()}
    figures |= {f"fuzz {seed}": fuzz(seed) for seed in (1, 2, 3)}
    print(json.dumps({"compiled": compiled(), "digests": figures}))


if __name__ == "__main__":
    main()
