"""From YAML nodes to the parts of a plant model; errors name file, line, field and the nearest word."""

import dataclasses
import math
from typing import Any, get_args, get_type_hints

import yaml

from plant.effects import REGISTRY
from plant.effects.base import STAGES, Effect
from plant.effects.targets import DOMAINS, TARGETS
from plant.effects.unknown import KINDS, STOPS
from plant.parts import AxisModel, EffectModel, Function, Number, Stops
from plant.units import UNITS, factor
from plant.yamltext import nearest

MAX_KNOTS = 32
MAX_EFFECTS = 100
"""Of an axis: three times the catalogue."""


class ModelError(ValueError):
    """A plant file that cannot be used: file, line, field and what was expected."""


@dataclasses.dataclass(frozen=True)
class Reader:
    """Reads nodes of one file; `name` is what errors call the file."""

    name: str

    def fail(self, node: yaml.Node, path: str, what: str) -> ModelError:
        """Return an error at a node."""
        return ModelError(f"{self.name}, line {node.start_mark.line + 1}: {path or 'file'}: {what}")

    def mapping(self, node: yaml.Node, path: str) -> dict[str, tuple[yaml.Node, yaml.Node]]:
        """Return key -> (key node, value node)."""
        if not isinstance(node, yaml.MappingNode):
            raise self.fail(node, path, "expected a mapping of fields")
        return {str(key.value): (key, value) for key, value in node.value}

    def fields(
        self, node: yaml.Node, path: str, required: list[str], optional: list[str]
    ) -> dict[str, yaml.Node]:
        """Return the fields of a mapping; unknown and missing ones are errors."""
        found = self.mapping(node, path)
        for word, (key, _) in found.items():
            if word not in required and word not in optional:
                raise self.fail(
                    key, f"{path}.{word}".lstrip("."), "unknown field; " + nearest(word, required + optional)
                )
        for word in required:
            if word not in found:
                raise self.fail(node, f"{path}.{word}".lstrip("."), "missing")
        return {word: value for word, (_, value) in found.items()}

    def scalar(self, node: yaml.Node, path: str) -> str:
        """Return the text of a scalar."""
        if not isinstance(node, yaml.ScalarNode):
            raise self.fail(node, path, "expected a single value")
        return str(node.value)

    def real(self, node: yaml.Node, path: str) -> float:
        """Return a finite number."""
        text = self.scalar(node, path)
        try:
            value = float(text)
        except ValueError:
            raise self.fail(node, path, f"expected a number, not '{text}'") from None
        if not math.isfinite(value):
            raise self.fail(node, path, f"expected a finite number, not '{text}'")
        return value

    def choice(self, node: yaml.Node, path: str, choices: list[str]) -> str:
        """Return one word of a list."""
        word = self.scalar(node, path)
        if word not in choices:
            raise self.fail(node, path, f"'{word}' is not known; " + nearest(word, choices))
        return word

    def word(
        self, given: dict[str, yaml.Node], path: str, field: str, choices: list[str], default: str
    ) -> str:
        """Return one word of a list at a field, or the default where it is absent."""
        return self.choice(given[field], f"{path}.{field}", choices) if field in given else default

    def number(self, node: yaml.Node, path: str, unit: str, low: float, high: float) -> Number:
        """Return a number whose unit fits `unit` and whose value lies within the bounds (in `unit`)."""
        fields = self.fields(node, path, ["value", "unit", "source"], [])
        value = self.real(fields["value"], path + ".value")
        given = self.scalar(fields["unit"], path + ".unit")
        fitting = [u for u in UNITS if UNITS[u][0] == UNITS[unit][0]]
        if given not in fitting:
            raise self.fail(
                fields["unit"], path + ".unit", f"'{given}' does not fit; " + nearest(given, fitting)
            )
        scaled = value * factor(given, unit)
        slack = 1e-9 * max(abs(low), abs(high))
        if not low - slack <= scaled <= high + slack:
            texts = f"{value:g} {given}", f"{low:g} to {high:g} {unit}"
            said, limits = (text.removesuffix(" 1") for text in texts)
            raise self.fail(fields["value"], path, f"{said} is outside {limits}")
        if given == "bit" and value % 1:
            raise self.fail(fields["value"], path, f"{value:g} bit is no whole number")
        source = self.scalar(fields["source"], path + ".source")
        if not source.strip():
            raise self.fail(fields["source"], path + ".source", "is empty: say where the number comes from")
        return Number(value, given, source)

    def part(self, node: yaml.Node, path: str, kind: type[Any]) -> Any:
        """Return a part: numbers by their declared units, nested parts, text."""
        hints = get_type_hints(kind)
        specs = dataclasses.fields(kind)
        optional = [s.name for s in specs if s.name == "description" or s.default is not dataclasses.MISSING]
        required = [s.name for s in specs if s.name not in optional]
        given = self.fields(node, path, required, optional)
        values: dict[str, Any] = {}
        for spec in specs:
            here = f"{path}.{spec.name}".lstrip(".")
            if spec.name not in given:
                values[spec.name] = "" if spec.name == "description" else spec.default
            elif spec.metadata:
                meta = spec.metadata
                values[spec.name] = self.number(
                    given[spec.name], here, meta["unit"], meta["low"], meta["high"]
                )
            elif kind is AxisModel and spec.name == "effects":
                values[spec.name] = self.effects(given[spec.name], here)
            elif spec.name == "stops":
                values[spec.name] = self.stops(given[spec.name], here)
            elif hints[spec.name] is str:
                values[spec.name] = self.scalar(given[spec.name], here)
            else:
                inner = get_args(hints[spec.name]) or (hints[spec.name],)  # of an optional part, its kind
                values[spec.name] = self.part(given[spec.name], here, inner[0])
        return kind(**values)

    def stops(self, node: yaml.Node, path: str) -> Stops:
        """Return an axis' hard stops, low below high."""
        found: Stops = self.part(node, path, Stops)
        if found.low.si >= found.high.si:
            raise self.fail(node, path, "low must lie below high")
        return found

    def effects(self, node: yaml.Node, path: str) -> tuple[EffectModel, ...]:
        """Return the list of effects."""
        if isinstance(node, yaml.ScalarNode) and node.value in ("", "null", "~"):
            return ()
        if not isinstance(node, yaml.SequenceNode):
            raise self.fail(node, path, "expected a list of effects")
        if len(node.value) > MAX_EFFECTS:
            raise self.fail(node, path, f"{len(node.value)} effects; at most {MAX_EFFECTS}")
        return tuple(self.effect(child, f"{path}.{k}") for k, child in enumerate(node.value))

    def effect(self, node: yaml.Node, path: str) -> EffectModel:
        """Return one effect, checked against the registry."""
        found = self.mapping(node, path)
        if "name" not in found:
            raise self.fail(node, path + ".name", "missing")
        name = self.choice(found["name"][1], path + ".name", list(REGISTRY))
        effect = REGISTRY[name]
        if name == "unknown":
            given = self.fields(node, path, ["name", "function"], ["enabled"])
            function = self.function(given["function"], path + ".function")
            return EffectModel(name, function=function, enabled=self.enabled(given, path))
        places = ["stage", "harmonic"] if effect.staged else []
        given = self.fields(node, path, ["name", *places[:1]], ["parameters", "enabled", *places[1:]])
        stage = (
            self.choice(given["stage"], path + ".stage", list(effect.stages or STAGES))
            if effect.staged
            else None
        )
        harmonic = 1
        if "harmonic" in given:
            number = self.real(given["harmonic"], path + ".harmonic")
            if number % 1 or not 1 <= number <= 1000:
                raise self.fail(
                    given["harmonic"], path + ".harmonic", "expected a whole number from 1 to 1000"
                )
            harmonic = int(number)
        parameters = (
            self.parameters(given["parameters"], path + ".parameters", effect)
            if "parameters" in given
            else {}
        )
        return EffectModel(name, stage, harmonic, parameters, None, self.enabled(given, path))

    def enabled(self, given: dict[str, yaml.Node], path: str) -> bool:
        """Return `enabled`, true when absent."""
        return self.word(given, path, "enabled", ["true", "false"], "true") == "true"

    def parameters(self, node: yaml.Node, path: str, effect: Effect) -> dict[str, Number]:
        """Return an effect's parameters."""
        known = [p.name for p in effect.parameters]
        given = self.fields(node, path, [], known)
        return {
            p.name: self.number(given[p.name], f"{path}.{p.name}", p.unit, p.low, p.high)
            for p in effect.parameters
            if p.name in given
        }

    def function(self, node: yaml.Node, path: str) -> Function:
        """Return the function of an `unknown` effect."""
        optional = ["interpolation", "period", "motor"]
        given = self.fields(node, path, ["target", "domain", "knots", "source"], optional)
        target = self.choice(given["target"], path + ".target", list(TARGETS))
        domain = self.choice(given["domain"], path + ".domain", list(DOMAINS))
        kind = self.word(given, path, "interpolation", list(KINDS), "cubic")
        period = self.real(given["period"], path + ".period") if "period" in given else 0.0
        motor = int(self.word(given, path, "motor", ["0", "1", "2"], "0"))
        rows = given["knots"]
        if kind == "stop" and domain != "axis_angle":
            raise self.fail(given["domain"], path + ".domain", "a sum of stops follows the axis_angle")
        most = STOPS if kind == "stop" else MAX_KNOTS
        if not isinstance(rows, yaml.SequenceNode) or not 1 <= len(rows.value) <= most:
            raise self.fail(rows, path + ".knots", f"expected a list of 1 to {most} pairs [x, y], SI units")
        knots: list[tuple[float, float]] = []
        for k, row in enumerate(rows.value):
            here = f"{path}.knots.{k}"
            if not isinstance(row, yaml.SequenceNode) or len(row.value) != 2:
                raise self.fail(row, here, "expected a pair [x, y]")
            x, y = (self.real(cell, here) for cell in row.value)
            if knots and x <= knots[-1][0]:
                raise self.fail(row, here, "knots must rise in x")
            if kind == "stop" and x <= 0.0:
                raise self.fail(row, here, "the radius of a stop must be above zero")
            knots.append((x, y))
        return Function(
            target, domain, kind, period, tuple(knots), self.scalar(given["source"], path + ".source"), motor
        )
