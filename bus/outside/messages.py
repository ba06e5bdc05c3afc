"""Frames here, `can.Message` there."""

import can

from bus.can.frame import MAX_DATA_BYTES, Frame, FrameError


def to_message(frame: Frame, t_ns: int, channel: str | None = None, is_rx: bool = True) -> can.Message:
    """`frame` as python-can has it; the time stamp is simulated seconds."""
    return can.Message(
        timestamp=t_ns * 1e-9,
        arbitration_id=frame.identifier,
        is_extended_id=frame.extended,
        is_remote_frame=frame.remote,
        dlc=len(frame.data),
        data=None if frame.remote else frame.data,
        channel=channel,
        is_rx=is_rx,
    )


def to_frame(message: can.Message) -> Frame:
    """`message` as CAN 2.0 carries it; raises FrameError for CAN FD and error frames."""
    if message.is_fd or message.is_error_frame:
        kind = "a CAN FD frame" if message.is_fd else "an error frame"
        raise FrameError(f"{kind} ({message.arbitration_id:#x}) cannot go onto a CAN 2.0 wire")
    if not isinstance(message.arbitration_id, int):
        raise FrameError(f"{message.arbitration_id!r} is no identifier")
    if message.is_remote_frame and not 0 <= message.dlc <= MAX_DATA_BYTES:
        raise FrameError(f"{message.dlc!r} is no length of a CAN 2.0 frame")
    data = bytes(message.dlc) if message.is_remote_frame else bytes(message.data)
    return Frame(message.arbitration_id, data, bool(message.is_extended_id), bool(message.is_remote_frame))
