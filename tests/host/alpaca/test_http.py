"""The HTTP side of Alpaca: names, malformed values, transaction ids, numbers of errors, every member."""

import inspect
import json
from http.client import HTTPConnection
from time import perf_counter

import alpaca.camera
import alpaca.focuser
import alpaca.telescope
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.host.alpaca.conftest import AlpacaLive

Answer = tuple[int, dict[str, object]]


def ask(
    live: AlpacaLive, method: str, path: str, parameters: str = "", headers: dict[str, str] | None = None
) -> Answer:
    connection = HTTPConnection("127.0.0.1", live.port, timeout=10)
    try:
        if method == "PUT":
            form = {"Content-Type": "application/x-www-form-urlencoded", **(headers or {})}
            connection.request("PUT", path, parameters.encode("utf-8"), form)
        else:
            connection.request(method, f"{path}?{parameters}" if parameters else path, headers=headers or {})
        answer = connection.getresponse()
        body = answer.read()
        return answer.status, json.loads(body) if body.startswith(b"{") else {}
    finally:
        connection.close()


def get(live: AlpacaLive, member: str, parameters: str = "", device: str = "telescope") -> Answer:
    return ask(live, "GET", f"/api/v1/{device}/0/{member}", parameters)


def put(live: AlpacaLive, member: str, parameters: str = "", device: str = "telescope") -> Answer:
    return ask(live, "PUT", f"/api/v1/{device}/0/{member}", parameters)


@pytest.fixture(autouse=True)
def connected(live: AlpacaLive) -> None:
    for device in ("telescope", "focuser", "camera"):
        assert put(live, "connect", device=device)[0] == 200


def test_transaction_ids_come_back_and_count_up(live: AlpacaLive) -> None:
    first = get(live, "name", "ClientID=3&ClientTransactionID=4294967295")[1]
    second = get(live, "name", "clientid=3&CLIENTTRANSACTIONID=7")[1]
    assert first["ClientTransactionID"] == 4294967295 and second["ClientTransactionID"] == 7
    assert isinstance(first["ServerTransactionID"], int) and isinstance(second["ServerTransactionID"], int)
    assert second["ServerTransactionID"] > first["ServerTransactionID"]
    assert put(live, "abortslew", "clienttransactionid=9")[1]["ClientTransactionID"] == 0  # PUT: exact names


@pytest.mark.parametrize(
    ("member", "parameters"),
    [
        ("connected", ""), ("connected", "Connected=maybe"), ("connected", "connected=True"),
        ("tracking", "Tracking=1"), ("targetrightascension", "TargetRightAscension=abc"),
        ("targetrightascension", "targetrightascension=5"), ("targetdeclination", "TargetDeclination=nan"),
        ("targetdeclination", "TargetDeclination=inf"), ("targetdeclination", "TargetDeclination="),
        ("moveaxis", "Axis=0"), ("moveaxis", "Axis=x&Rate=1"), ("moveaxis", "Axis=1.5&Rate=1"),
        ("slewtocoordinatesasync", "RightAscension=5"), ("pulseguide", "Direction=0"),
        ("trackingrate", "TrackingRate=sidereal"), ("action", "Action=x"), ("commandbool", "Command=x"),
        ("abortslew", "ClientTransactionID=-1"), ("abortslew", "ClientID=x"), ("nosuchmember", ""),
        ("rightascension", ""), ("abortslew", "ClientID=99999999999"),
        ("targetdeclination", "TargetDeclination=１"), ("tracking", "Tracking=True&Tracking=False"),
    ],
)  # fmt: skip
def test_malformed_puts_are_400(live: AlpacaLive, member: str, parameters: str) -> None:
    assert put(live, member, parameters)[0] == 400


@pytest.mark.parametrize("parameters", ["", "Axis=", "Axis=x", "ClientTransactionID=-1&Axis=0"])
def test_malformed_gets_are_400(live: AlpacaLive, parameters: str) -> None:
    assert get(live, "axisrates", parameters)[0] == 400


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Host": "localhost:11111"}, 200),
        ({"Host": "192.0.2.1:11111"}, 200),
        ({"Host": "rebound.invalid:11111"}, 403),
        ({"Origin": "http://page.invalid"}, 403),
    ],
)
def test_a_foreign_host_or_page_is_refused(live: AlpacaLive, headers: dict[str, str], status: int) -> None:
    """A name of anybody's may point at this machine: its page could send PUTs."""
    for method in ("GET", "PUT"):
        assert ask(live, method, "/api/v1/telescope/0/connected", "Connected=True", headers)[0] == status


def test_unknown_places_are_refused(live: AlpacaLive) -> None:
    for path in ("/api/v1/telescope/1/name", "/api/v1/camera/9/name", "/api/v1/telescope/x/name"):
        assert ask(live, "GET", path)[0] == 400
    assert ask(live, "GET", "/api/v2/telescope/0/name")[0] == 404
    assert ask(live, "DELETE", "/api/v1/telescope/0/name")[0] == 405
    assert put(live, "action", "Action=" + "x" * 100_000)[0] == 400


@pytest.mark.parametrize(
    ("member", "parameters", "number"),
    [
        ("targetrightascension", "TargetRightAscension=24", 0x401),
        ("targetdeclination", "TargetDeclination=-90.1", 0x401),
        ("slewtocoordinatesasync", "RightAscension=25&Declination=0", 0x401),
        ("slewtoaltazasync", "Azimuth=361&Altitude=50", 0x401), ("moveaxis", "Axis=2&Rate=1", 0x401),
        ("moveaxis", "Axis=0&Rate=2.1", 0x401), ("pulseguide", "Direction=4&Duration=10", 0x401),
        ("pulseguide", "Direction=0&Duration=-1", 0x401), ("trackingrate", "TrackingRate=4", 0x401),
        ("guideratedeclination", "GuideRateDeclination=1", 0x401), ("findhome", "", 0x400),
        ("synctoaltaz", "Azimuth=1&Altitude=50", 0x400), ("sideofpier", "SideOfPier=0", 0x400),
        ("siteelevation", "SiteElevation=1", 0x400), ("utcdate", "UTCDate=2026-01-01T00:00:00Z", 0x400),
        ("doesrefraction", "DoesRefraction=False", 0x400), ("action", "Action=x&Parameters=", 0x40C),
        ("commandblind", "Command=x&Raw=True", 0x400),
    ],
)  # fmt: skip
def test_refusals_by_their_numbers(live: AlpacaLive, member: str, parameters: str, number: int) -> None:
    status, body = put(live, member, parameters)
    assert (status, body["ErrorNumber"]) == (200, number)
    assert body["ErrorMessage"]


def test_not_connected_is_0x407_and_names_are_told_all_the_same(live: AlpacaLive) -> None:
    put(live, "disconnect")
    assert get(live, "connected")[1]["Value"] is False and get(live, "connecting")[1]["Value"] is False
    assert get(live, "interfaceversion")[1]["Value"] == 4
    assert get(live, "rightascension")[1]["ErrorNumber"] == 0x407
    assert put(live, "park")[1]["ErrorNumber"] == 0x407
    put(live, "connected", "Connected=True")  # as V3 clients do
    assert get(live, "rightascension")[1]["ErrorNumber"] == 0


@pytest.mark.parametrize(
    ("device", "client"),
    [
        ("telescope", alpaca.telescope.Telescope),
        ("focuser", alpaca.focuser.Focuser),
        ("camera", alpaca.camera.Camera),
    ],
)
def test_every_member_of_alpycas_client_is_answered(live: AlpacaLive, device: str, client: type) -> None:
    """The list of members is alpyca's, not ours."""
    for name, member in inspect.getmembers(client):
        if name.startswith("_") or name in ("ImageArrayRaw", "ImageArrayInfo"):  # alpyca's own views
            continue
        known = live.alpaca.devices[device, "0"].members.get(name.lower())
        assert known is not None, name
        if isinstance(member, property):
            assert known.get is not None and (member.fset is None or known.put is not None), name
            status, body = get(live, name.lower(), device=device)
            assert status == 200 and ("Value" in body or body["ErrorNumber"]), name
            empty = {0x40B} if device == "camera" else set()  # there is no frame yet
            assert body["ErrorNumber"] in {0, 0x400, 0x402} | empty, (name, body)
        else:
            assert known.put is not None or known.get is not None, name


def test_device_state_and_utc(live: AlpacaLive) -> None:
    state = get(live, "devicestate")[1]["Value"]
    assert isinstance(state, list)
    names = {each["Name"] for each in state}
    assert {"RightAscension", "Declination", "Slewing", "Tracking", "AtPark", "UTCDate", "TimeStamp"} <= names
    assert str(get(live, "utcdate")[1]["Value"]).endswith("Z")
    focus = get(live, "devicestate", device="focuser")[1]["Value"]
    assert isinstance(focus, list)
    assert {each["Name"] for each in focus} == {"IsMoving", "Position", "TimeStamp"}


def test_an_answer_does_not_wait_for_a_delayed_acknowledge(live: AlpacaLive) -> None:
    """40 ms each is what two writes would cost with Nagle's algorithm; a kept connection shows it."""
    connection = HTTPConnection("127.0.0.1", live.port, timeout=10)
    times = []
    for _ in range(30):
        start = perf_counter()
        connection.request("GET", "/api/v1/telescope/0/slewing")
        connection.getresponse().read()
        times.append(perf_counter() - start)
    connection.close()
    print(f"median answer {sorted(times)[15] * 1e3:.1f} ms")
    assert sorted(times)[15] < 0.030


@pytest.mark.slow
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_anything_is_answered_and_nothing_is_an_internal_error(live: AlpacaLive, data: st.DataObject) -> None:
    device = data.draw(st.sampled_from(["telescope", "focuser", "camera"]))
    members = sorted(set(live.alpaca.devices[device, "0"].members) - {"disconnect", "connected"})
    member = data.draw(st.sampled_from(members))
    names = [
        "Axis",
        "Rate",
        "Position",
        "RightAscension",
        "Declination",
        "Tracking",
        "Duration",
        "ClientID",
        "Light",
    ]
    values = st.one_of(
        st.text(st.characters(codec="utf-8"), max_size=8), st.floats().map(str), st.integers().map(str)
    )
    pairs = data.draw(st.lists(st.tuples(st.sampled_from(names), values), max_size=4))
    from urllib.parse import urlencode

    method = data.draw(st.sampled_from(["GET", "PUT"]))
    if member.startswith("slewto") and not member.endswith("async"):
        return  # waits for the slew
    status, _ = ask(live, method, f"/api/v1/{device}/0/{member}", urlencode(pairs))
    assert status in (200, 400)
