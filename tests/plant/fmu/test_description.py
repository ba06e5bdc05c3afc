"""modelDescription.xml by the standard (fmi-standard.org, 2.0.4 and 3.0.1): references, units, structure."""

from math import pi
from xml.etree import ElementTree as Xml

import pytest

from plant.fmu.description import description
from tests.plant.fmu.sample import DECLARED, axis

REALS = ["current_a", "current_b", "angle", "rate", "torque", "friction"]
COUNTERS = ["incremental", "absolute", "auxiliary", "tachometer_a", "tachometer_b"]
SWITCHES = {0: "gear_mesh", 2: "encoder_eccentricity", 3: "winding_heating", 4: "channel_delay",
            5: "shaft_compliance", 6: "play", 7: "cable_wrap"}  # fmt: skip
GIVEN = {"causality": "parameter", "variability": "fixed", "initial": "exact"}
Variable = tuple[str, dict[str, str]]


def read(fmi: int) -> Xml.Element:
    return Xml.fromstring(description(axis(), fmi, "{token}", "1.2.3"))


def inside(element: Xml.Element | None) -> list[Xml.Element]:
    assert element is not None
    return list(element)


def variables(fmi: int) -> dict[str, Variable]:
    """Type and all attributes, by name, whichever version has them where."""
    found: dict[str, Variable] = {}
    for each in inside(read(fmi).find("ModelVariables")):
        if fmi == 3:
            found[each.attrib["name"]] = (each.tag, dict(each.attrib))
        else:
            assert each.tag == "ScalarVariable"
            (typed,) = each
            found[each.attrib["name"]] = (typed.tag, {**each.attrib, **typed.attrib})
    return found


@pytest.mark.parametrize(
    ("fmi", "version", "token", "state"),
    [(2, "2.0", "guid", "FMUstate"), (3, "3.0", "instantiationToken", "FMUState")],
)
def test_a_version_has_its_own_words(fmi: int, version: str, token: str, state: str) -> None:
    top = read(fmi)
    assert top.tag == "fmiModelDescription"
    assert top.attrib["fmiVersion"] == version and top.attrib[token] == "{token}"
    assert len(top.attrib) == 6 and top.attrib["modelName"] == "low_preload ra"
    assert top.attrib["description"].endswith(" Axis ra.")
    assert top.attrib["generationTool"] == "schmidt 1.2.3"
    (able,) = top.findall("CoSimulation")
    assert able.attrib == {
        "modelIdentifier": "axis", "canHandleVariableCommunicationStepSize": "true",
        f"canGetAndSet{state}": "true", f"canSerialize{state}": "true",
    }  # fmt: skip
    (experiment,) = top.findall("DefaultExperiment")
    assert experiment.attrib == {"startTime": "0", "stopTime": "1", "stepSize": "0.005"}


@pytest.mark.parametrize(("fmi", "kinds"), [(2, ("Real", "Integer", "Boolean")),
                                            (3, ("Float64", "Int64", "Boolean"))])  # fmt: skip
def test_every_variable_has_its_type_and_its_reference(fmi: int, kinds: tuple[str, ...]) -> None:
    real, whole, boolean = kinds
    found = variables(fmi)
    placed = {name: (kind, int(each["valueReference"])) for name, (kind, each) in found.items()}
    expected = {"time": (real, 0), "duty_a": (real, 1), "duty_b": (real, 2)}
    expected |= {name: (real, 10 + k) for k, name in enumerate(REALS)}
    expected |= {name: (whole, 20 + k) for k, name in enumerate(COUNTERS)}
    expected |= {f"effects[{k}].{name}.enabled": (boolean, 50 + k) for k, name in SWITCHES.items()}
    expected |= {each.name: (real, 1000 + k) for k, each in enumerate(axis().parameters) if each.name}
    assert placed == expected
    assert list(placed) == list(expected)


@pytest.mark.parametrize("fmi", [2, 3])
def test_variables_are_what_they_are(fmi: int) -> None:
    found = {name: each for name, (_, each) in variables(fmi).items()}
    assert found["time"].items() >= {"causality": "independent", "variability": "continuous"}.items()
    for letter in "ab":
        duty = found[f"duty_{letter}"]
        assert duty.items() >= {"causality": "input", "start": "0", "min": "0", "max": "1"}.items()
        assert duty["description"] == f"duty cycle of motor {letter.upper()}"
    for names, changes in ((REALS, "continuous"), (COUNTERS, "discrete")):
        for name in names:
            expected = {"causality": "output", "initial": "calculated", "variability": changes}
            assert found[name].items() >= expected.items()
    assert found["rate"]["unit"] == "rad/s"
    for k, name in SWITCHES.items():
        switch = found[f"effects[{k}].{name}.enabled"]
        assert switch.items() >= (GIVEN | {"start": "false" if k == 2 else "true"}).items()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_parameter_has_its_numbers_and_its_units(fmi: int) -> None:
    found = {name: each for name, (_, each) in variables(fmi).items()}
    grid = found["numerics.grid"]
    expected = {"start": "0.0005", "min": "1e-05", "max": "0.002", "unit": "s", "displayUnit": "us"}
    assert grid.items() >= (expected | GIVEN).items()
    assert grid["valueReference"] == "1000" and grid["description"].startswith("chosen: converged")
    plain = found["axis.friction.coulomb"]
    assert plain["unit"] == "N m" and "displayUnit" not in plain
    ratio = found["axis.encoders.roller_ratio"]
    assert (ratio["min"], ratio["max"]) == ("1.0", "1000.0") and "unit" not in ratio
    start = found["start_angle"]
    assert start["unit"] == "rad" and "min" not in start and "max" not in start
    assert found["effects[0].gear_mesh.amplitude"]["valueReference"] == str(1000 + DECLARED)


def test_outputs_of_version_3_are_told_by_reference() -> None:
    made = [(each.tag, dict(each.attrib)) for each in inside(read(3).find("ModelStructure"))]
    references = [str(k) for k in (*range(10, 16), *range(20, 25))]
    assert made == [
        (word, {"valueReference": each}) for word in ("Output", "InitialUnknown") for each in references
    ]


def test_outputs_of_version_2_are_told_by_place_from_one() -> None:
    """Time and two duties come before them, so they begin at 4."""
    groups = inside(read(2).find("ModelStructure"))
    assert [group.tag for group in groups] == ["Outputs", "InitialUnknowns"]
    for group in groups:
        assert [(each.tag, each.attrib) for each in group] == [
            ("Unknown", {"index": str(4 + k)}) for k in range(11)
        ]


def test_units_are_defined_with_those_of_the_plant_file_to_show() -> None:
    units = {each.attrib["name"]: each for each in inside(read(3).find("UnitDefinitions"))}
    assert list(units) == sorted(units) and "" not in units and "1" not in units

    def base(name: str) -> dict[str, str]:
        (found,) = units[name].findall("BaseUnit")
        return dict(found.attrib)

    def shown(name: str) -> dict[str, float]:
        return {each.attrib["name"]: float(each.attrib["factor"])
                for each in units[name].findall("DisplayUnit")}  # fmt: skip

    assert base("N m") == {"kg": "1", "m": "2", "s": "-2"}
    assert base("degC") == {"K": "1", "offset": "273.15"} and base("rad/s") == {"rad": "1", "s": "-1"}
    assert not units["bit"].findall("BaseUnit") and not units["counts/turn"].findall("BaseUnit")
    assert shown("s") == pytest.approx({"us": 1e6}) and shown("A") == {}
    ratio = 113 / 27 * 123 / 21 * 250 / 17
    degrees = {"deg": 180 / pi, "deg motor": ratio * 180 / pi, "arcsec": 648_000 / pi}
    assert shown("rad") == pytest.approx(degrees)
    assert shown("N m") == pytest.approx({"N mm motor": 1000 / ratio})  # of the effect alone
    assert shown("Hz") == pytest.approx({"kHz": 1e-3})


def test_the_file_is_xml_with_lines() -> None:
    text = description(axis(), 3, "{t}", "1").decode("utf-8")
    assert text.startswith("<?xml version='1.0' encoding='UTF-8'?>\n")
    assert "\n  <CoSimulation " in text
    (log,) = read(3).findall("LogCategories/Category")
    assert log.attrib == {"name": "error"}
