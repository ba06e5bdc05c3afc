"""Everything boards put on the wire can be decoded with the DBC alone, and names its sender."""

from bus.can import Frame
from bus.conformance import Settings, run
from bus.outside.pythoncan import SchmidtBus
from bus.protocol import Device
from bus.protocol.database import database
from scenarios.lab.wiring import network


def test_L1_cantools_decodes_every_frame_and_byte_0_is_the_sender() -> None:
    served = network()
    said: list[tuple[str, Frame]] = []
    served.wire.tap(lambda _t, frame, sender: said.append((sender, frame)))
    with SchmidtBus(served.wire) as bus:
        run(bus, settings=Settings(motion=True, listen_s=1.0))
    boards = [(sender, frame) for sender, frame in said if sender in Device.__members__]
    assert len(boards) > 1000
    assert {sender for sender, _ in boards} == set(Device.__members__)
    for sender, frame in boards:
        message = database().get_message_by_frame_id(frame.identifier)
        values = message.decode(frame.data)
        assert message.name.startswith(sender)
        assert str(values["Device"]) == sender
        assert frame.data[0] == Device[sender]
