"""The peer: the same frames over python-can's virtual bus, a bus and a Notifier for every node."""

import threading
import time

import can

from bus.can import Frame


class _Counter(can.Listener):
    """Counts what arrives and says when everything has."""

    def __init__(self, expected: int) -> None:
        self.count = 0
        self._expected = expected
        self.done = threading.Event()

    def on_message_received(self, msg: can.Message) -> None:
        self.count += 1
        if self.count >= self._expected:
            self.done.set()


def replay(
    traffic: list[tuple[int, Frame, str]], seconds: float = 1.0, timeout_s: float = 120.0
) -> dict[str, float]:
    """Send `seconds` of traffic as fast as it goes, each frame from its node; wait until all have all.

    No firmware, no plant, no bit times: the transport alone. Returns the real-time factor and what was lost.
    """
    names = sorted({sender for _, _, sender in traffic})
    sent = {name: sum(sender == name for _, _, sender in traffic) for name in names}
    buses = {
        name: can.Bus(interface="virtual", channel="schmidt-bench", preserve_timestamps=False)
        for name in names
    }
    counters = {name: _Counter(len(traffic) - sent[name]) for name in names}
    notifiers = [can.Notifier(buses[name], [counters[name]], timeout=0.1) for name in names]
    messages = [
        (sender, can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=False))
        for _, frame, sender in traffic
    ]
    start = time.perf_counter()
    for sender, message in messages:
        buses[sender].send(message)
    for counter in counters.values():
        counter.done.wait(max(0.0, timeout_s - (time.perf_counter() - start)))
    wall_s = time.perf_counter() - start
    for notifier in notifiers:
        notifier.stop(timeout=1)
    for bus in buses.values():
        bus.shutdown()
    expected = sum(len(traffic) - count for count in sent.values())
    lost = expected - sum(counter.count for counter in counters.values())
    return {
        "real_time_factor": seconds / wall_s,
        "frames": float(len(traffic)),
        "nodes": float(len(names)),
        "lost": float(lost),
    }
