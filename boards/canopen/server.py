"""A board's SDO server: the package's, held to CiA 301 where a client does not keep to it."""
# mypy: allow-untyped-calls

from binascii import crc_hqx
from typing import Any, Final

import canopen
from canopen.sdo.constants import (
    BLOCK_SIZE_SPECIFIED,
    BLOCK_TRANSFER_RESPONSE,
    CRC_SUPPORTED,
    END_BLOCK_TRANSFER,
    INITIATE_BLOCK_TRANSFER,
    NO_MORE_BLOCKS,
    NO_MORE_DATA,
    REQUEST_SEGMENT_DOWNLOAD,
    REQUEST_SEGMENT_UPLOAD,
    RESPONSE_BLOCK_UPLOAD,
    SDO_STRUCT,
    START_BLOCK_UPLOAD,
)
from canopen.sdo.exceptions import SdoAbortedError
from canopen.sdo.server import SdoServer

LENGTH: Final = 8
"""Bytes of every SDO message (CiA 301, 7.2.4.3)."""
_WIDEST: Final = 8
"""Bytes of the widest object of the dictionary, UNSIGNED64."""
_SPECIFIER: Final = 0x05040001
_TOO_LONG: Final = 0x06070012
"""Abort codes: command specifier not valid; length of the parameter too high (CiA 301, table 22)."""
_BLOCK_SIZE: Final = 0x05040002
"""Abort code: invalid block size."""
_SEGMENTS: Final = 127
_COMMANDS: Final = 0xE0


class Server(SdoServer):
    """One transfer at a time; a segment that belongs to none is aborted with 0x05040001."""

    def __init__(self, node: canopen.LocalNode, number: int) -> None:
        super().__init__(0x600 + number, 0x580 + number, node)
        self._index = self._subindex = 0
        self._expected: int | None = None
        self._block: bytes | None = None
        """What a block upload sends; `_sent` of it is acknowledged, `_segments` go in a block."""
        self._sent, self._segments = 0, _SEGMENTS

    def on_request(self, can_id: int, data: bytes, timestamp: float) -> None:
        """A request; one that is not eight bytes long is ignored."""
        if len(data) != LENGTH:
            return
        specifier = data[0] & _COMMANDS
        if specifier in (REQUEST_SEGMENT_UPLOAD, REQUEST_SEGMENT_DOWNLOAD) and specifier != self._expected:
            self.abort(_SPECIFIER)
            return
        super().on_request(can_id, data, timestamp)

    def init_upload(self, request: bytes) -> None:
        """Answer with the object, or begin to send it in segments."""
        self._expected = self._buffer = None
        super().init_upload(request)
        self._expected = None if self._buffer is None else REQUEST_SEGMENT_UPLOAD

    def segmented_upload(self, command: int) -> None:
        """The next seven bytes."""
        super().segmented_upload(command)
        if not self._buffer:
            self._expected = None

    def init_download(self, request: bytes) -> None:
        """Take the object, or begin to take it in segments."""
        self._expected = self._buffer = None
        super().init_download(request)
        self._expected = None if self._buffer is None else REQUEST_SEGMENT_DOWNLOAD

    def segmented_download(self, command: int, request: bytes) -> None:
        """Up to seven bytes more; raises SdoAbortedError beyond the widest object."""
        buffer: Any = self._buffer
        if len(buffer) + 7 - (command >> 1 & 7) > _WIDEST:
            raise SdoAbortedError(_TOO_LONG)
        super().segmented_download(command, request)
        if command & NO_MORE_DATA:
            self._expected = None

    def block_upload(self, data: bytes) -> None:
        """Begin, send a block, repeat what was lost, end (CiA 301, 7.2.4.3.12 to 15)."""
        step = data[0] & 3
        if step == INITIATE_BLOCK_TRANSFER:
            self._expected = self._buffer = None
            _, self._index, self._subindex = SDO_STRUCT.unpack_from(data)
            self._block = bytes(self._node.get_data(self._index, self._subindex, check_readable=True))
            self._sent = 0
            self._resize(data[4])
            head = RESPONSE_BLOCK_UPLOAD | CRC_SUPPORTED | BLOCK_SIZE_SPECIFIED
            size = len(self._block).to_bytes(4, "little")
            self.send_response(SDO_STRUCT.pack(head, self._index, self._subindex) + size)
        elif self._block is None:
            raise SdoAbortedError(_SPECIFIER)
        elif step == START_BLOCK_UPLOAD:
            self._send_block()
        elif step == BLOCK_TRANSFER_RESPONSE:
            self._sent += 7 * min(data[1], self._segments)
            self._resize(data[2])
            if self._sent < len(self._block):
                self._send_block()
            else:
                unused = -len(self._block) % 7
                end = RESPONSE_BLOCK_UPLOAD | unused << 2 | END_BLOCK_TRANSFER
                self.send_response(bytes((end,)) + crc_hqx(self._block, 0).to_bytes(2, "little") + bytes(5))
        else:
            self._block = None

    def _resize(self, segments: int) -> None:
        if not 0 < segments <= _SEGMENTS:
            raise SdoAbortedError(_BLOCK_SIZE)
        self._segments = segments

    def _send_block(self) -> None:
        block: Any = self._block
        for number in range(1, self._segments + 1):
            start = self._sent + 7 * (number - 1)
            last = start + 7 >= len(block)
            head = number | (NO_MORE_BLOCKS if last else 0)
            self.send_response(bytes((head,)) + block[start : start + 7].ljust(7, b"\0"))
            if last:
                break

    def block_download(self, data: bytes) -> None:
        """Aborted: there is none."""
        self._expected = None
        super().block_download(data)

    def request_aborted(self, data: bytes) -> None:
        """The client has given up."""
        self._expected = self._block = None
        super().request_aborted(data)

    def abort(self, abort_code: int = 0x08000000) -> None:
        """End the transfer and say why."""
        self._expected = self._block = None
        super().abort(abort_code)
