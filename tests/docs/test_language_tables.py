"""Schema and pages are made from the tables; an expectation is one row."""

from typing import Any

import jsonschema
import pytest

from docs.generate import language
from scenarios.language.validate import schema
from scenarios.run import evaluate


def accepted(expectation: dict[str, Any], definition: dict[str, Any] | None = None) -> bool:
    """Whether an editor that has the published schema takes it."""
    rule = definition or schema()["$defs"]["expectation"]
    return jsonschema.Draft202012Validator({**rule, "$defs": schema()["$defs"]}).is_valid(expectation)


@pytest.mark.parametrize("name", evaluate.KINDS)
def test_every_kind_takes_one_limit_and_its_own_words(name: str) -> None:
    kind = evaluate.KINDS[name]
    limit = "1 " + {"angle": "arcsec", "rate": "arcsec/s", "focus": "um", "fraction": "%"}.get(kind.limit, "")
    value: Any = limit if kind.limit else 1
    assert accepted({name: {"at_most": value}})
    assert accepted({"name": "it holds", name: {"at_least": value}})
    assert not accepted({name: {}})
    assert not accepted({name: {"at_most": value, "at_least": value}})
    assert not accepted({name: {"at_most": value, "colour": 1}})
    assert accepted({name: {"at_most": value, "during": "follow", "settle": "5 s"}}) == bool(kind.steps)
    assert accepted({name: {"at_most": value, "statistic": "p95"}}) == bool(kind.steps)
    for field, words in kind.words.items():
        assert all(accepted({name: {"at_most": value, field: word}}) for word in words)
        assert not accepted({name: {"at_most": value, field: "none of them"}})


def test_expectations_are_one_at_a_time() -> None:
    assert not accepted({})
    assert not accepted({"overruns": {"at_most": 0}, "bus_load": {"at_most": "50 %"}})
    assert not accepted({"overrun": {"at_most": 0}})


def test_a_new_row_is_schema_and_page(monkeypatch: pytest.MonkeyPatch) -> None:
    row = evaluate.Kind(
        lambda _outcome, _given: 0.0, "time", "it lasts", ("park",), {"of": {"day": "", "night": "dark"}}
    )
    monkeypatch.setitem(evaluate.KINDS, "length", row)
    assert row.unit == "s"
    assert accepted({"length": {"at_most": "3 s", "of": "night"}}, language.definition())
    assert not accepted({"length": {"at_most": "3 s", "of": "dusk"}}, language.definition())
    page = language.scenarios_page()
    assert "| `length` | it lasts, in `park` steps | time | `of`: `day` (default), `night` (dark) |\n" in page
