"""A wire in simulated time for programs that send and then wait in a thread of their own, such as `canopen`.

Such a program waits for what another thread puts into its queue. Here there is no other thread. Before `send`
returns, simulated time has gone on and whatever came has been handed over. So the answer is there when the
program looks for it.
"""

from collections.abc import Callable
from math import ceil

import can

from bus.can.wire import Wire
from bus.outside.pythoncan import SchmidtBus


class LockstepBus(SchmidtBus):
    """deliver: gets every frame that comes. after_s: simulated seconds that go by in every send, longer than
    any answer takes."""

    def __init__(self, wire: Wire, deliver: Callable[[can.Message], None], after_s: float = 0.005) -> None:
        super().__init__(wire)
        self.deliver = deliver
        self.after_s = after_s

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send, let time go by, hand over what came."""
        super().send(msg, timeout)
        self.run(self.after_s)

    def run(self, seconds: float) -> None:
        """Let simulated seconds go by and hand over what came."""
        queue = self.wire.queue
        queue.run_until(queue.now_ns + ceil(seconds * 1e9))
        while (message := self.recv(timeout=0)) is not None:
            self.deliver(message)
