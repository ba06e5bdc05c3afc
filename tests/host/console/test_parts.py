"""Parts of the consoles without a browser: combination of encoders, sky map, who may look, tables."""

import asyncio
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from host.auxiliary import ABSOLUTE_ARCSEC, AUXILIARY_ARCSEC, combine
from host.console.figures import hours
from host.console.live import Sample
from host.console.plots import series
from host.console.skymap import boundary, label
from host.guard import COOKIE, Guard
from host.sky.mount import STEP_ARCSEC, Mount, scale_from_limits
from host.sky.site import Site

SITE = Site(math.radians(29.3667), math.radians(79.45), 1950.0, 800.0, 10.0, 0.5)
MOUNT = Mount(
    scale_from_limits(-math.radians(80), math.radians(80)),
    scale_from_limits(-math.radians(30), math.radians(85)),
    0.0, SITE.latitude_rad,
)  # fmt: skip


def test_the_combined_encoder_is_the_best_linear_unbiased_estimate() -> None:
    """Against 100 000 drawn readings: no bias, the stated deviation, and smaller than either's."""
    rng = np.random.default_rng(5)
    truth = 100_000.0
    absolute = truth + ABSOLUTE_ARCSEC * rng.standard_normal(100_000)
    auxiliary = truth + AUXILIARY_ARCSEC * rng.standard_normal(100_000)
    found = [
        combine(round(a / STEP_ARCSEC), b) for a, b in zip(absolute[:20_000], auxiliary[:20_000], strict=True)
    ]
    estimates = np.array([f.estimate_arcsec for f in found])
    sigma = found[0].sigma_arcsec
    assert estimates.mean() == pytest.approx(truth, abs=4 * sigma / math.sqrt(len(found)))
    assert estimates.std() == pytest.approx(sigma, rel=0.03)
    assert sigma < min(ABSOLUTE_ARCSEC, AUXILIARY_ARCSEC)


def test_one_encoder_alone_keeps_its_own_deviation_and_none_says_nothing() -> None:
    assert combine(1000, None).sigma_arcsec == ABSOLUTE_ARCSEC
    assert combine(None, 5.0) == (None, 5.0, None, 5.0, AUXILIARY_ARCSEC, True)
    assert combine(None, None).estimate_arcsec is None


@given(st.floats(-20, 20))
def test_hours_are_within_a_day(angle: float) -> None:
    text = hours(angle)
    assert 0 <= int(text[:2]) < 24 and 0 <= int(text[3:5]) < 60 and 0 <= float(text[6:10]) < 60


def test_the_soft_limits_on_the_sky_map_are_those_of_the_mount() -> None:
    """The pole's altitude is the latitude; the limit at hour angle 0 in the south is at its altitude."""
    places = boundary(MOUNT, SITE)
    top = max(places)
    assert top[0] <= math.pi / 2
    lowest_south = math.pi / 2 - SITE.latitude_rad + math.radians(-30)
    near_south = min(places, key=lambda p: abs(p[1] - math.pi))
    assert near_south[0] == pytest.approx(lowest_south, abs=0.02)


def test_the_map_has_a_text_for_who_cannot_see_it() -> None:
    assert "nowhere yet" in label(None)


async def _ask(
    host: str, query: bytes = b"", cookie: bytes = b"", more: tuple[tuple[bytes, bytes], ...] = ()
) -> tuple[int, list[tuple[bytes, bytes]]]:
    sent: list[dict[str, Any]] = []

    async def app(scope: Any, receive: Any, send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message: Any) -> None:
        sent.append(message)

    async def receive() -> Any:
        return {}

    headers = [*more, *([(b"cookie", cookie)] if cookie else [])]
    scope = {"type": "http", "client": (host, 1), "query_string": query, "headers": headers}
    await Guard(app, "word")(scope, receive, send)
    return sent[0]["status"], sent[0]["headers"]


def test_this_machine_may_look_and_others_need_the_token() -> None:
    assert asyncio.run(_ask("127.0.0.1"))[0] == 200
    assert asyncio.run(_ask("192.0.2.7"))[0] == 403
    assert asyncio.run(_ask("192.0.2.7", b"token=wrong"))[0] == 403
    status, headers = asyncio.run(_ask("192.0.2.7", b"token=word"))
    assert status == 200 and headers[0][0] == b"set-cookie"
    assert asyncio.run(_ask("192.0.2.7", b"", f"{COOKIE}=word".encode()))[0] == 200


@pytest.mark.parametrize(
    ("host", "origin", "status"),
    [
        ("localhost:8080", None, 200),
        ("127.0.0.1:8080", "http://127.0.0.1:8080", 200),
        ("[::1]:8080", "http://[::1]:8080", 200),
        ("dome.example:8080", "http://dome.example:8080", 200),
        ("rebound.invalid:8080", None, 403),
        ("rebound.invalid:8080", "http://rebound.invalid:8080", 403),
        ("localhost:8080", "http://page.invalid", 403),
        ("localhost:8080", "http://localhost:3000", 403),
        ("localhost:8080", "null", 403),
    ],
)
def test_a_foreign_host_or_page_is_refused(
    host: str, origin: str | None, status: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A name of anybody's may point at this machine, and a page of anybody's may open a websocket."""
    monkeypatch.setenv("SCHMIDT_HOSTS", "dome.example")
    said = ((b"host", host.encode()), *(((b"origin", origin.encode()),) if origin is not None else ()))
    assert asyncio.run(_ask("127.0.0.1", more=said))[0] == status


def test_a_plot_has_only_points_that_it_shows() -> None:
    """At ten times real time the kept samples reach back further than the two minutes of the axis."""
    samples = [
        Sample(
            float(t),
            (None, None),
            (9000.0 if t < 100 else 1.0, 0.0),
            (0.0, 0.0),
            (0.0,) * 4,
            (None,) * 2,
            (None,) * 2,
        )
        for t in range(0, 400, 3)
    ]
    ra, dec = series(samples, lambda sample: sample.rate_arcsec_s, 2)
    assert ra[-1] == [0.0, 1.0] and ra[0][0] == -120 and {y for _, y in ra} == {1.0}
    assert len(ra) == len(dec) == 41
