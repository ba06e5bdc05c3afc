"""Every report that a test of calibration makes is asked for its parameters' names."""

from typing import Any

import pytest

from calibration import command
from tests.calibration.reported import knows


def strange(report: dict[str, Any]) -> list[str]:
    """Parameters that neither the plant's effect nor the page on reports knows."""
    return [
        f"{e['name']}: {p}" for e in report["effects"] for p in e["parameters"] if not knows(e["name"], p)
    ]


@pytest.fixture(autouse=True)
def known_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    """A report with a strange parameter fails its test."""
    write = command.write_report

    def asked(data: dict[str, Any], *more: Any) -> None:
        assert not strange(data)
        write(data, *more)

    monkeypatch.setattr(command, "write_report", asked)
