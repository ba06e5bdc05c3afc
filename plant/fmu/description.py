"""modelDescription.xml of FMI 2.0 and 3.0 (fmi-standard.org)."""

import re
from collections.abc import Iterator
from typing import Final
from xml.etree import ElementTree as Xml

from plant.fmu import variables as has
from plant.units import UNITS

NAME: Final = "axis"
"""Of the library inside."""
_KINDS: Final = {"Float64": "Real", "Int64": "Integer", "Boolean": "Boolean"}
"""FMI 3's type -> FMI 2's."""
_SYMBOLS: Final = {
    "N": {"kg": 1, "m": 1, "s": -2}, "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "W": {"kg": 1, "m": 2, "s": -3},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2}, "H": {"kg": 1, "m": 2, "s": -2, "A": -2}, "Hz": {"s": -1},
    "degC": {"K": 1}, "rad": {"rad": 1}, "kg": {"kg": 1}, "m": {"m": 1}, "s": {"s": 1}, "A": {"A": 1},
    "K": {"K": 1},
}  # fmt: skip
"""Exponents of SI's base units, as FMI names them; counts, bits and steps have none."""
_KELVIN: Final = 273.15
"""K at 0 degC."""


def exponents(unit: str) -> dict[str, int]:
    """Return the exponents of SI's base units in a base unit such as `N m/(rad)`."""
    found: dict[str, int] = {}
    above, _, below = unit.partition("/")
    for sign, part in ((1, above), (-1, below.strip("()"))):
        for symbol, power in re.findall(r"([A-Za-z]+)(\d?)", part):
            for base, exponent in _SYMBOLS.get(symbol, {}).items():
                found[base] = found.get(base, 0) + sign * int(power or 1) * exponent
    return {base: exponent for base, exponent in found.items() if exponent}


def description(axis: has.Exported, fmi: int, token: str, version: str) -> bytes:
    """Return the XML. fmi: 2 or 3; token: what the library knows its description by."""
    three = fmi == 3
    top = Xml.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "3.0" if three else "2.0",
            "modelName": f"{axis.model.name} {axis.axis}",
            "instantiationToken" if three else "guid": token,
            "description": f"{axis.model.description} Axis {axis.axis}.",
            "generationTool": f"schmidt {version}",
            "variableNamingConvention": "structured",
        },
    )
    state = "FMUState" if three else "FMUstate"
    able = {"canHandleVariableCommunicationStepSize": "true", f"canGetAndSet{state}": "true"}
    Xml.SubElement(top, "CoSimulation", {"modelIdentifier": NAME, **able, f"canSerialize{state}": "true"})
    _units(Xml.SubElement(top, "UnitDefinitions"), axis)
    Xml.SubElement(Xml.SubElement(top, "LogCategories"), "Category", name="error")
    step = repr(axis.model.controller.period.si)
    Xml.SubElement(top, "DefaultExperiment", {"startTime": "0", "stopTime": "1", "stepSize": step})
    variables = Xml.SubElement(top, "ModelVariables")
    structure = Xml.SubElement(top, "ModelStructure")
    outputs: list[tuple[int, str]] = []
    for index, (kind, reference, about, typed) in enumerate(_variables(axis), 1):
        if three:
            Xml.SubElement(variables, kind, {**about, "valueReference": reference, **typed})
        else:
            each = Xml.SubElement(variables, "ScalarVariable", {**about, "valueReference": reference})
            Xml.SubElement(each, _KINDS[kind], typed)
        if about["causality"] == "output":
            outputs.append((index, reference))
    for group, name in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        inside = structure if three else Xml.SubElement(structure, group)
        for index, reference in outputs:
            if three:
                Xml.SubElement(inside, name, valueReference=reference)
            else:
                Xml.SubElement(inside, "Unknown", index=str(index))
    Xml.indent(top)
    return bytes(Xml.tostring(top, encoding="UTF-8", xml_declaration=True))


_Variable = tuple[str, str, dict[str, str], dict[str, str]]


def _variables(axis: has.Exported) -> Iterator[_Variable]:
    """(type, reference, what it is, its numbers), in the order of the file."""
    time = {"name": "time", "causality": "independent", "variability": "continuous"}
    yield "Float64", "0", time, {"unit": "s"}
    for k, motor in enumerate("ab", 1):
        about = {"name": f"duty_{motor}", "causality": "input", "variability": "continuous"}
        about["description"] = f"duty cycle of motor {motor.upper()}"
        yield "Float64", str(k), about, {"start": "0", "min": "0", "max": "1"}
    output = {"causality": "output", "initial": "calculated"}
    for k, (name, unit, text) in enumerate(has.REALS, has.FIRST_REAL):
        about = {"name": name, "variability": "continuous", "description": text, **output}
        yield "Float64", str(k), about, {"unit": unit}
    for k, (name, *_) in enumerate(has.COUNTERS, has.FIRST_COUNTER):
        about = {"name": name, "variability": "discrete", "description": "counts of this encoder", **output}
        yield "Int64", str(k), about, {}
    given = {"causality": "parameter", "variability": "fixed", "initial": "exact"}
    for k, name in enumerate(axis.switchable, has.FIRST_SWITCH):
        if name:
            start = str(axis.enabled[k - has.FIRST_SWITCH]).lower()
            yield "Boolean", str(k), {"name": name, "description": "acts", **given}, {"start": start}
    for k, each in enumerate(axis.parameters, has.FIRST_PARAMETER):
        if each.name:
            bounds = {"min": repr(each.low), "max": repr(each.high)} if each.low > -1e300 else {}
            numbers = {"start": repr(each.start), **bounds}
            if unit := has.base_unit(each.unit):
                numbers |= {"unit": unit} | ({"displayUnit": each.unit} if each.unit != unit else {})
            yield "Float64", str(k), {"name": each.name, "description": each.source, **given}, numbers


def _units(units: Xml.Element, axis: has.Exported) -> None:
    """Units of all numbers, and those of the plant file to show them in."""
    shown: dict[str, set[str]] = {unit: set() for _, unit, _ in has.REALS} | {"s": set(), "rad": {"deg"}}
    for each in axis.parameters:
        if each.name and (unit := has.base_unit(each.unit)):
            shown.setdefault(unit, set()).add(each.unit)
    for name in sorted(shown):
        unit_ = Xml.SubElement(units, "Unit", name=name)
        base = {symbol: str(power) for symbol, power in exponents(name).items()}
        if base:
            Xml.SubElement(unit_, "BaseUnit", base | ({"offset": str(_KELVIN)} if name == "degC" else {}))
        for other in sorted(shown[name] - {name}):
            Xml.SubElement(unit_, "DisplayUnit", name=other, factor=repr(1.0 / UNITS[other][1]))
