"""The examples of docs/reference/rig-examples.md are rig files."""

import re
from pathlib import Path

import pytest

from calibration.inputs.rigfile import load_rig
from calibration.report.rigview import show_rig

ROOT = Path(__file__).parents[2]
EXAMPLES = re.findall(
    r"```yaml\n(.*?)```",
    (ROOT / "docs" / "reference" / "rig-examples.md").read_text(encoding="utf-8"),
    re.DOTALL,
)


@pytest.mark.parametrize("number", range(len(EXAMPLES)))
def test_an_example_of_the_page_is_read(tmp_path: Path, number: int) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(EXAMPLES[number], encoding="utf-8")
    assert load_rig(path).stages or number < 3


@pytest.mark.parametrize("path", sorted((ROOT / "calibration" / "rigs").glob("*.yaml")), ids=lambda p: p.stem)
def test_what_comes_along_is_shown(path: Path) -> None:
    assert show_rig(path, [], None).startswith(load_rig(path).name)
