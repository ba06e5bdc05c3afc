"""Scenarios and campaigns that come with schmidt, by name: `quick-look`, `what-fails-first`."""

from pathlib import Path

from scenarios.language.document import ScenarioError
from scenarios.language.validate import nearest

SCENARIOS = Path(__file__).parents[1]
CAMPAIGNS = SCENARIOS / "campaigns"


def located(given: Path, folder: Path = SCENARIOS) -> Path:
    """The file that is meant: the one of this path, or else the one of this name in `folder`.

    A path with a suffix or a folder in it is never a name. Raises ScenarioError for a name that nothing has.
    """
    try:
        there = given.exists()
    except (OSError, ValueError):  # a path that no system takes; reading it says why
        return given
    if there or given.suffix or len(given.parts) != 1:
        return given
    own = {file.stem: file for file in sorted(folder.glob("*.yaml"))}
    found = own.get(given.name.replace("_", "-"))
    if found is None:
        raise ScenarioError(f"{given}: no such file, and none of schmidt's own; {nearest(given.name, own)}")
    return found
