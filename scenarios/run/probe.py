"""The digest of a very short run: whether two ways, machines or versions give the same bits."""

import sys
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

_SCENARIO = """\
name: probe
start_utc: 2026-02-10T14:00:00Z
steps:
  - power_on: {}
  - set_rate: {axis: ra, rate: 100 arcsec/s, for: 1 s}
"""


@cache
def digest() -> str:
    """Run three seconds of the whole network and return the trace digest."""
    from scenarios.lab.session import Session
    from scenarios.language.document import parse
    from scenarios.language.load import convert
    from scenarios.language.plants import plant_model

    file = Path("probe.yaml")
    scenario = convert(parse(_SCENARIO, file))
    with tempfile.TemporaryDirectory(prefix="schmidt-probe-") as folder:
        session = Session(scenario, plant_model(scenario.plant, file.parent), Path(folder))
        session.advance(3_000_000_000)
        session.recorder.close()
        return session.recorder.digest()


def main(library: Sequence[str]) -> None:
    """Print the digest; with a name of a compiled library, that is used."""
    if library:
        from scenarios.native.finder import use

        use(Path(library[0]))
    print(digest())


if __name__ == "__main__":
    main(sys.argv[1:])
