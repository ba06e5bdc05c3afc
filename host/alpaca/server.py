"""Alpaca over HTTP: requests to members, answers as Alpaca's JSON; management and the devices' list.

A picture goes as ImageBytes where the client takes it, else as JSON (Alpaca API Reference, version 9).
"""

import importlib.metadata
import itertools
import socket
import struct
from collections.abc import Callable, Sequence

import numpy as np
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from bus.protocol.nodes import DOME, WEATHER
from host.alpaca.camera import CameraDevice
from host.alpaca.device import Device
from host.alpaca.dome import DomeDevice
from host.alpaca.focuser import FocuserDevice
from host.alpaca.observing import ObservingConditionsDevice, SafetyMonitorDevice
from host.alpaca.requests import NOT_CONNECTED, AlpacaError, Malformed, Parameters
from host.alpaca.telescope import TelescopeDevice
from host.camera.camera import Camera
from host.camera.readout import Counts
from host.guard import Guard
from host.telescope import AsyncDesk, Telescope
from host.web import answer

_BODY_BYTES = 1 << 16


class Alpaca:
    """Telescope 0 and focuser 0; dome 0 and what the weather stations tell, where the network has them.

    Camera 0 is the telescope's, camera 1 the guider's; they need an emulated sky.
    """

    def __init__(self, telescope: Telescope, cameras: Sequence[Camera] = ()) -> None:
        desk = AsyncDesk(telescope)
        devices: list[Device] = [TelescopeDevice(desk), FocuserDevice(desk)]
        if telescope.house.expected(DOME):
            devices.append(DomeDevice(desk))
        if telescope.house.expected(WEATHER):
            devices += [ObservingConditionsDevice(desk), SafetyMonitorDevice(desk)]
        devices += [CameraDevice(desk, camera, number) for number, camera in enumerate(cameras)]
        self.devices = {(device.kind, device.number): device for device in devices}
        self.requests = 0
        self._numbers = itertools.count(1)
        app = Starlette(
            routes=[
                Route("/api/v1/{kind}/{number}/{member}", self._device, methods=["GET", "PUT"]),
                *(Route(f"/management/{path}", self._management) for path in _MANAGEMENT),
                Route("/setup", self._setup),
                Route("/setup/v1/{kind}/{number}/setup", self._setup),
            ]
        )
        self.app = Guard(app, token=None)

    async def serve(self, listener: socket.socket) -> None:
        """Answer on a listening socket until cancelled."""
        await answer(self.app, listener)

    async def _device(self, request: Request) -> Response:
        """One property or method."""
        self.requests += 1
        where, put = request.path_params, request.method == "PUT"
        device = self.devices.get((where["kind"], where["number"]))
        if device is None:
            return PlainTextResponse(f"no {where['kind'][:40]} {where['number'][:10]}", 400)
        member = device.members.get(where["member"])
        if member is None or (member.put if put else member.get) is None:
            return PlainTextResponse(f"no {request.method} of {where['member'][:40]}", 400)
        try:
            given = Parameters(await _body(request) if put else _query(request), exact=put)
            given.identifier("ClientID")
            transaction = given.identifier("ClientTransactionID")
        except Malformed as error:
            return PlainTextResponse(str(error), 400)
        value: object = None
        number, message = 0, ""
        try:
            if not (device.connected or member.always):
                raise AlpacaError(NOT_CONNECTED, f"{device.kind} is not connected")
            if member.put is not None and put:
                value = await member.put(device, given)
            elif member.get is not None:
                value = member.get(device, given)
        except Malformed as error:
            return PlainTextResponse(str(error), 400)
        except AlpacaError as error:
            number, message = error.number, str(error)
        if isinstance(value, np.ndarray):
            return picture(value, request.headers.get("accept", ""), transaction, next(self._numbers))
        return self._answer(transaction, value, number, message)

    def _answer(self, transaction: int, value: object, number: int = 0, message: str = "") -> Response:
        body = {} if value is None else {"Value": value}
        return JSONResponse(body | _ended(transaction, next(self._numbers), number, message))

    async def _management(self, request: Request) -> Response:
        value = _MANAGEMENT[request.url.path.removeprefix("/management/")](self)
        try:
            given = Parameters(_query(request), exact=False)
            return self._answer(given.identifier("ClientTransactionID"), value)
        except Malformed as error:
            return PlainTextResponse(str(error), 400)

    def described(self) -> dict[str, str]:
        """The server, as the management API describes it."""
        return {
            "ServerName": "schmidt", "Manufacturer": "schmidt",
            "ManufacturerVersion": importlib.metadata.version("schmidt"),
            "Location": "Nainital, 29°22′ N 79°27′ E",
        }  # fmt: skip

    def configured(self) -> list[dict[str, object]]:
        """The devices, as the management API lists them."""
        return [
            {
                "DeviceName": device.name, "DeviceType": type(device).__name__.removesuffix("Device"),
                "DeviceNumber": int(device.number), "UniqueID": device.unique_id,
            }
            for device in self.devices.values()
        ]  # fmt: skip

    async def _setup(self, _request: Request) -> Response:
        return Response("<!doctype html><title>schmidt</title><p>Nothing to set up.", media_type="text/html")


_MANAGEMENT: dict[str, Callable[[Alpaca], object]] = {
    "apiversions": lambda _: [1],
    "v1/description": Alpaca.described,
    "v1/configureddevices": Alpaca.configured,
}


def _query(request: Request) -> str:
    return _text(request.scope["query_string"])


async def _body(request: Request) -> str:
    body = b""
    async for chunk in request.stream():
        body += chunk
        if len(body) > _BODY_BYTES:
            raise Malformed(f"more than {_BODY_BYTES} bytes of parameters")
    return _text(body)


def _text(said: bytes) -> str:
    try:
        return said.decode()
    except UnicodeDecodeError:
        raise Malformed("parameters are no UTF-8") from None


def _ended(client: int, server: int, number: int = 0, message: str = "") -> dict[str, object]:
    return {
        "ClientTransactionID": client, "ServerTransactionID": server % (1 << 32), "ErrorNumber": number,
        "ErrorMessage": message,
    }  # fmt: skip


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
    return JSONResponse({"Type": _INT32, "Rank": 2, "Value": columns.tolist()} | _ended(client, server))
