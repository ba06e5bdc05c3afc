"""A picture over HTTP: ImageBytes where the client takes it, else JSON (Alpaca API Reference, version 9)."""

import struct

import numpy as np
from starlette.responses import JSONResponse, Response

from host.camera.readout import Counts

MEDIA_TYPE = "application/imagebytes"
_INT32, _UINT16 = 2, 8
"""ImageArrayElementTypes: what the client holds in the end, and what is sent."""
_HEADER = struct.Struct("<iiIIiiiiiii")


def picture(counts: Counts, accepted: str, client: int, server: int) -> Response:
    """counts: rows from the top; on the wire x is the first index. client, server: transaction numbers."""
    columns = counts.T
    if MEDIA_TYPE in accepted.lower():
        width, height = columns.shape
        head = _HEADER.pack(
            1, 0, client, server % (1 << 32), _HEADER.size, _INT32, _UINT16, 2, width, height, 0
        )
        pixels = np.ascontiguousarray(columns, dtype="<u2").tobytes()
        return Response(head + pixels, media_type=MEDIA_TYPE)
    body = {
        "Type": _INT32, "Rank": 2, "Value": columns.tolist(), "ClientTransactionID": client,
        "ServerTransactionID": server % (1 << 32), "ErrorNumber": 0, "ErrorMessage": "",
    }  # fmt: skip
    return JSONResponse(body)
