"""A campaign file, checked, and the cases it plans: as many as asked for, none of them in memory."""

import hashlib
import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from scenarios.campaign import inputs
from scenarios.campaign.inputs import FAULT, Input
from scenarios.lab.prepare import CAMPAIGNS, located, prepare
from scenarios.lab.prepare import load as load_scenario
from scenarios.language.document import Document, ScenarioError, read
from scenarios.language.units import parse
from scenarios.language.validate import check, schema

SCHEMA_FILE = Path(__file__).with_name("campaign.schema.json")
"""The published JSON schema of campaign files."""
MOST = 1_000_000
"""Planned runs of one campaign. That many runs of five seconds are two months of one core, and its table and
report take some 3 GB. Beyond that there would be minutes of planning without a word."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One planned run, as a worker is sent it.

    key: hash of everything that decides its outcome. document: the scenario, plain. beside: folder in which
    relative names are looked for. kept: where the logs of those to `keep` (nothing, failed, all) stay, or
    None.
    """

    key: str
    index: int
    values: dict[str, Any]
    document: dict[str, Any]
    beside: str
    metrics: tuple[str, ...]
    keep: str = "nothing"
    kept: str | None = None


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A campaign as the runner uses it. time_s: no run is begun after so much wall time."""

    file: Path
    name: str
    description: str
    scenario: Path
    base: dict[str, Any]
    inputs: tuple[Input, ...]
    shares: npt.NDArray[np.float64]
    """(runs, inputs): where in its distribution each input lies; (0, 0) for a grid."""
    way: str
    """Of sampling: grid, random, latin hypercube or sobol."""
    metrics: tuple[str, ...]
    keep: str
    time_s: float | None

    @property
    def count(self) -> int:
        """Planned runs."""
        return math.prod(len(each.values) for each in self.inputs) if self.way == "grid" else len(self.shares)

    def document(self, values: Iterable[tuple[Input, Any]]) -> dict[str, Any]:
        """The scenario, plain, with these values of some inputs."""
        document: dict[str, Any] = json.loads(json.dumps(self.base))
        del document["_folder"]
        for each, value in values:
            each.put(document, value)
        return document

    def cases(self) -> Iterator[Case]:
        """The planned runs, one after the other."""
        return map(self.case, range(self.count))

    def case(self, index: int) -> Case:
        """One of the planned runs; a grid's last input changes fastest."""
        if self.way == "grid":
            places = np.unravel_index(index, [len(each.values) for each in self.inputs])
            values = tuple(each.values[int(place)] for each, place in zip(self.inputs, places, strict=True))
        else:
            row = self.shares[index]
            values = tuple(each.draw(float(share)) for each, share in zip(self.inputs, row, strict=True))
        document = self.document(zip(self.inputs, values, strict=True))
        folder = self.base["_folder"]
        text = json.dumps([document, folder], sort_keys=True)
        key = hashlib.sha256(text.encode()).hexdigest()[:16]
        named = {each.name: value for each, value in zip(self.inputs, values, strict=True)}
        return Case(
            key=key, index=index, values=named, document=document, beside=folder, metrics=self.metrics,
            keep=self.keep,
        )  # fmt: skip


def load(file: Path) -> Plan:
    """Read and check a campaign file and the scenario it names; ScenarioError says what and where.

    file: its path, or the name of one of schmidt's own.
    """
    file = located(file, CAMPAIGNS)
    document = read(file)
    check(document, schema(SCHEMA_FILE))
    data = document.data
    scenario = file.parent / data["scenario"]
    base = read(scenario)
    load_scenario(base)
    plain = json.loads(json.dumps({**base.data, "_folder": str(scenario.parent.resolve())}))
    found = tuple(
        inputs.read(given, document.where(("inputs", index)), plain)
        for index, given in enumerate(data["inputs"])
    )
    names = [each.name for each in found]
    if len(set(names)) < len(names):
        raise ScenarioError(f"{file}: two inputs have one name; give one a `name`")
    way = data.get("sample", "latin hypercube")
    runs = int(data.get("budget", {}).get("runs", 100))
    if way == "grid":
        runs = math.prod(len(each.values) for each in found)
    if runs > MOST:
        lower = "fewer values or `levels`" if way == "grid" else "a lower budget.runs"
        raise ScenarioError(
            f"{file}: {runs} runs are planned, one campaign has at most {MOST}: give it {lower}, or make "
            "several"
        )
    places = [each.place for each in found if each.place != FAULT]  # of them there may be several
    if twice := next((place for k, place in enumerate(places) if place in places[:k]), ""):
        raise ScenarioError(f"{file}: two inputs change {twice}, and the later one would win; leave one out")
    plan = Plan(
        file=file,
        name=data["name"],
        description=data.get("description", ""),
        scenario=scenario,
        base=plain,
        inputs=found,
        shares=np.zeros((0, 0)) if way == "grid" else sample(way, runs, len(found), int(data.get("seed", 1))),
        way=way,
        metrics=tuple(data.get("metrics", ("expectations",))),
        keep=data.get("keep", "nothing"),
        time_s=parse(data["budget"]["time"], "time") if "time" in data.get("budget", {}) else None,
    )
    load_scenario(Document(file, plan.case(0).document, {}))  # the first case is a scenario, too
    beside = Path(plain["_folder"]) / file.name  # where the scenario's own names are looked for
    for each in found:  # and the ends of every input
        for value in each.ends:
            try:
                prepare(Document(beside, plan.document([(each, value)]), {}))
            except ScenarioError as error:
                raise ScenarioError(f"{file}: input {each.name!r}, value {value!r}: {error}") from None
    return plan


def sample(way: str, runs: int, width: int, seed: int) -> npt.NDArray[np.float64]:
    """Shares within 0..1, (runs, width)."""
    random = np.random.default_rng(seed)
    if way == "random":
        return random.random((runs, width))
    from scipy.stats import qmc  # a second of imports

    if way == "latin hypercube":
        return np.asarray(qmc.LatinHypercube(width, rng=random).random(runs))
    drawn: npt.NDArray[np.float64] = qmc.Sobol(width, rng=random).random_base2((runs - 1).bit_length())
    return drawn[:runs]
