"""The reference page of effects, by which people write plant files, is what the code says."""

from pathlib import Path

from docs.generate import effects

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "effects.md"


def test_the_published_bounds_and_defaults_are_those_of_the_code() -> None:
    """Else run `python -m docs.generate`, and say in the changelog that a plant file may break."""
    assert PAGE.read_text(encoding="utf-8") == effects.page()
