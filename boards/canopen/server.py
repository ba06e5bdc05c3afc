"""A board's SDO server: the package's, held to CiA 301 where a client does not keep to it."""
# mypy: allow-untyped-calls

from typing import Any, Final

import canopen
from canopen.sdo.constants import NO_MORE_DATA, REQUEST_SEGMENT_DOWNLOAD, REQUEST_SEGMENT_UPLOAD
from canopen.sdo.exceptions import SdoAbortedError
from canopen.sdo.server import SdoServer

LENGTH: Final = 8
"""Bytes of every SDO message (CiA 301, 7.2.4.3)."""
_WIDEST: Final = 8
"""Bytes of the widest object of the dictionary, UNSIGNED64."""
_SPECIFIER: Final = 0x05040001
_TOO_LONG: Final = 0x06070012
"""Abort codes: command specifier not valid; length of the parameter too high (CiA 301, table 22)."""
_COMMANDS: Final = 0xE0


class Server(SdoServer):
    """One transfer at a time; a segment that belongs to none is aborted with 0x05040001."""

    def __init__(self, node: canopen.LocalNode, number: int) -> None:
        super().__init__(0x600 + number, 0x580 + number, node)
        self._index = self._subindex = 0
        self._expected: int | None = None

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

    def block_download(self, data: bytes) -> None:
        """Aborted: there is none. A block upload becomes one in segments, as CiA 301 lets it."""
        self._expected = None
        super().block_download(data)

    def request_aborted(self, data: bytes) -> None:
        """The client has given up."""
        self._expected = None
        super().request_aborted(data)

    def abort(self, abort_code: int = 0x08000000) -> None:
        """End the transfer and say why."""
        self._expected = None
        super().abort(abort_code)
