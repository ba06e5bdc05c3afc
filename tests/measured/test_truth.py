"""How an answer about a measured log is judged."""

from typing import Any

import pytest

from tests.measured.truth import HALF, MISSED, RIGHT, WRONG, Sign, judge

WEIGHT = Sign(names=("gravity_imbalance",), size=("amplitude", 595.0, 699.0))
LOOP = Sign(names=("presliding",))


def effect(name: str, *others: str, amplitude: float = 650.0, half: float = 10.0) -> dict[str, Any]:
    """One of report.json."""
    size = {"value": amplitude, "low": amplitude - half, "high": amplitude + half}
    places = dict.fromkeys(("stage", "harmonic", "order", "frequency_Hz"))
    return {
        "name": name,
        "equivalent": list(others),
        "domain": "time",
        "parameters": {"amplitude": size},
        **places,
    }


@pytest.mark.parametrize(
    ("effects", "says"),
    [
        ([effect("gravity_imbalance")], RIGHT),
        ([effect("gravity_imbalance", amplitude=720.0, half=60.0)], RIGHT),
        ([effect("gravity_imbalance", amplitude=720.0)], WRONG),
        ([effect("cable_wrap", "gravity_imbalance")], RIGHT),
        ([effect("gravity_imbalance"), effect("presliding")], RIGHT),
        ([effect("gravity_imbalance"), effect("damaged_tooth")], HALF),
        ([effect("damaged_tooth"), effect("gravity_imbalance")], WRONG),
        ([effect("presliding")], MISSED),
        ([effect("unknown")], HALF),
        ([], MISSED),
    ],
)
def test_an_answer_is_right_half_missed_or_wrong(effects: list[dict[str, Any]], says: str) -> None:
    assert judge({"effects": effects}, [WEIGHT], [LOOP])[0] == says


def test_of_a_log_that_cannot_tell_no_name_is_right() -> None:
    assert judge({"effects": []}, [], [])[0] == RIGHT
    assert judge({"effects": [effect("channel_delay")]}, [], [])[0] == WRONG
