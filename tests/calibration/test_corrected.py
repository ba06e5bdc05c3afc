"""Findings in, effects of a plant file out: every name, its signs, and an `unknown` over the axis angle."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.frame import build_frame
from calibration.balances.motion import motion_of
from calibration.balances.recursions import stop_operator
from calibration.balances.torque import WIDTH, Transmission, torque_problem
from calibration.decide.select import select
from calibration.finding import Curve, Finding, Parameter
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.declaredplant import declared_model, declared_numbers
from calibration.names import NAMES as FOUND
from calibration.names.inplant import Facts, as_found
from calibration.names.position_friction import nearest_place
from calibration.names.unknown_shapes import spline_columns
from calibration.replay.corrected import curve_of
from calibration.replay.plantfile import convert, correct
from plant.effects import REGISTRY
from plant.effects.signals import ANGLE, CURRENT, MEMORY, MOTOR, MOTOR_ANGLE
from plant.effects.unknown import formula
from plant.evaluate import evaluate, evaluate_function, signals, values_over
from plant.gears import ORDERS, RATIO
from plant.loop import Excitation, simulate
from plant.model import PlantModel, dumps, load, loads, with_effects
from plant.parts import EffectModel, Function
from plant.rows import KINDS, _function, values
from tests.calibration.logs import COLUMNS, FORMATS, HEADER, manoeuvre

FACTS = Facts("a test", half_play=0.5 * np.radians(21.0), middle=1.0, span=0.5, warming=-1 / 3600)


def finding(name: str, channel: str = "T", domain: str = "time", **numbers: float) -> Finding:
    """A finding with numbers without intervals."""
    words = ("stage", "harmonic", "order", "frequency", "note")
    given = {k: numbers.pop(k) for k in words if k in numbers}
    return Finding(
        name,
        channel,
        domain,
        parameters={k: Parameter(v, "", v - 0.1, v + 0.1) for k, v in numbers.items()},
        **given,  # type: ignore[arg-type]
    )


#: every form in which the pipeline finds a name: (finding, what the plant file must hold of it, or None)
FORMS: list[tuple[Finding, str | None]] = [
    (finding("stribeck_change", stiction_factor=1.5), None),
    (finding("presliding", sigma_0=2e6), None),
    (finding("viscous_change", factor=1.4), None),
    (finding("coulomb_change", factor=1.7), None),
    (finding("shaft_compliance", "K", stiffness=1e6), None),
    (finding("friction_asymmetry", coulomb_asymmetry=0.1), "friction_asymmetry"),
    (finding("position_friction", order=123.4, amplitude=5.0, phase=1.0), "position_friction"),
    (finding("load_friction", coefficient=0.1), "load_friction"),
    (finding("friction_warmup", depth=-0.3, time_constant=60.0), "friction_warmup"),
    (finding("preload_change", change=0.4, start=100.0), "preload_change"),
    (finding("gravity_imbalance", amplitude=40.0, phase=0.3), "gravity_imbalance"),
    (finding("gear_eccentricity", stage="shaft1", harmonic=1, amplitude=9.0, phase=1.0), "gear_eccentricity"),
    (
        finding("gear_eccentricity", "K", stage="shaft2", harmonic=2, amplitude=3.0, phase=1.0),
        "gear_eccentricity",
    ),
    (finding("gear_mesh", stage="mesh2", harmonic=1, amplitude=9.0, phase=1.0), "gear_mesh"),
    (finding("gear_mesh", "K", stage="mesh2", harmonic=1, amplitude=3.0, phase=1.0), "gear_eccentricity"),
    (finding("damaged_tooth", stage="shaft1", amplitude=60.0, phase=0.3, width=0.02), "damaged_tooth"),
    (
        finding("motor_cogging", stage="motor", harmonic=37, amplitude=0.03, phase=1.0, motor=1.0),
        "motor_cogging",
    ),
    (
        finding("torque_ripple", stage="motor", harmonic=37, ripple=0.05, phase=1.0, motor=2.0),
        "torque_ripple",
    ),
    (finding("backlash_loss", "E", loss=0.9), "backlash_loss"),
    (finding("structural_mode", inertia=200.0, frequency=9.0, damping=0.02), "structural_mode"),
    (finding("encoder_eccentricity", "K", amplitude=2.0, phase=0.5), "encoder_eccentricity"),
    (
        finding(
            "encoder_eccentricity", "S", stage="roller", harmonic=1, order=24.5, amplitude=0.84, phase=0.5
        ),
        "encoder_eccentricity",
    ),
    (finding("encoder_subdivision", "S", order=32768.0, amplitude=0.2, phase=0.5), "encoder_subdivision"),
    (finding("roller_ratio", "S", error=500.0), "roller_ratio"),
    (finding("roller_slip", "S", creep=0.02, threshold=0.005), "roller_slip"),
    (finding("roller_slip", "S", slip=0.02, threshold=0.005), "roller_slip"),
    (finding("play", "K", gap=12.0), "play"),
    (finding("adc_offset", "E", offset=0.03, motor=2.0), "adc_offset"),
    (finding("adc_offset", offset_torque=5.0), "adc_offset"),
    (finding("adc_gain", "E", gain=0.05, motor=1.0), "adc_gain"),
    (finding("adc_gain", gain=0.05, motor=2.0), "adc_gain"),
    (finding("pwm_deadband", "E", deadband=0.01), "pwm_deadband"),
    (finding("diode_braking", "E", share=0.8), "diode_braking"),
    (finding("supply_sag", "E", resistance=0.2), "supply_sag"),
    (finding("winding_heating", "E", thermal_resistance=1.5, time_constant=90.0), "winding_heating"),
    (finding("magnet_weakening", "E", loss=0.1, motor=2.0), "magnet_weakening"),
    (finding("wind_torque", deviation=3.0, correlation_time=1.6), "wind_torque"),
    (finding("cable_wrap", stiffness=30.0, neutral_torque=5.0, hysteresis=8.0, width=0.02), "cable_wrap"),
    (finding("brake_drag", torque=50.0, start=100.0), "brake_drag"),
    (finding("brake_drag", torque=-50.0, start=100.0), "brake_drag"),
    (finding("bearing_pass", order=437.3, amplitude=9.0, phase=1.0), "bearing_pass"),
    (finding("encoder_thermal_drift", "K", drift=2.0), "encoder_thermal_drift"),
    (finding("channel_delay", "S", delay=0.004, column=2.0), "channel_delay"),
    (finding("channel_delay", "S", delay=0.004, note="the current or effort column is late"), None),
    (finding("clock_jitter", "S", deviation=3e-4), "clock_jitter"),
    (finding("sample_loss", "S", packet_loss=0.05), "sample_loss"),
    (finding("log_wrap", "S", column=1.0, bits=24.0, mode=0.0), "log_wrap"),
    (finding("log_wrap", "S", column=2.0, bits=8.0, mode=1.0), "log_wrap"),
    (finding("command_disturbance", "S", amplitude=0.007, phase=0.1, frequency=0.8), "command_disturbance"),
    (finding("unknown", domain="reversal", loop=12.0, travel=1e-3), "unknown"),
    (finding("unknown", domain="reversal", **{f"loop_{k}": 1.0 for k in range(5)}), "unknown"),
    (finding("unknown", domain="time", frequency=0.7, amplitude=4.0, phase=0.2), "unknown"),
    (finding("unknown", "E", "motor_angle", amplitude=0.2, phase=0.2, motor=2.0), "unknown"),
    (finding("unknown", "E", "time", frequency=49.9, amplitude=0.05), "unknown"),
    (finding("unknown", "S", "command", size=20.0, period=3.0), None),
    (
        replace(
            finding("unknown", domain="velocity"),
            curve=Curve("velocity", "N m", (0.0, 1.0), (0.0, 5.0), (1.0, 1.0)),
        ),
        "unknown",
    ),
]


def test_every_name_of_the_catalogue_has_a_form() -> None:
    as_it_is = {n.name for n in FOUND.values() if n.to_plant is as_found}
    assert {f.name for f, _ in FORMS} | as_it_is == set(REGISTRY) == set(FOUND)


@pytest.mark.parametrize("found, written", FORMS, ids=lambda x: getattr(x, "name", None))
def test_what_is_found_is_in_the_plant_file_or_has_a_remark(found: Finding, written: str | None) -> None:
    model = with_effects(load(), "ra", ())
    corrected, remarks = correct(model, "ra", [found], FACTS)
    names = [e.name for e in loads(dumps(corrected)).axes.ra.effects]
    assert names == ([] if written is None else [written])
    assert written is not None or len(remarks) == 1
    for effect in corrected.axes.ra.effects:
        assert all(n.source for n in effect.parameters.values())


def test_a_loss_that_begins_is_told_with_its_time() -> None:
    loss = finding("magnet_weakening", "E", loss=0.1, start=120.0, duration=5.0)
    remarks = FOUND["magnet_weakening"].to_plant(loss, FACTS).remarks
    assert len(remarks) == 1 and "from 120 s on" in remarks[0]


def torque(effect: EffectModel, angle: np.ndarray) -> np.ndarray:
    """The torque on the axis, N m."""
    return evaluate(effect.name, signals(len(angle), {ANGLE: angle}), values(effect))


@pytest.mark.parametrize(
    "found",
    [
        f
        for f, _ in FORMS
        if f.name in ("gear_mesh", "bearing_pass", "gravity_imbalance") and f.channel == "T"
    ],
    ids=lambda f: f.name,
)
def test_a_line_pushes_against_the_torque_the_motors_had_to_add(found: Finding) -> None:
    (made,) = convert(found, FACTS).effects
    angle = np.linspace(0.0, 0.4, 300)
    order = {"gear_mesh": ORDERS["mesh2"], "bearing_pass": 437.3, "gravity_imbalance": 1.0}[found.name]
    supplied = found.parameters["amplitude"].value * np.cos(order * angle + found.parameters["phase"].value)
    assert np.allclose(torque(made, angle), -supplied, atol=1e-6)


@pytest.mark.parametrize("motor", [1, 2])
def test_lines_of_a_motor_know_that_its_angle_lies_half_the_play_off(motor: int) -> None:
    axis = np.linspace(0.0, 0.01, 200)
    seen = RATIO * axis  # the angle as calibration has it: the axis' times the ratio
    real = seen + (3 - 2 * motor) * FACTS.half_play
    for name, unit in {
        "motor_cogging": ("amplitude", "N m at the motor"),
        "torque_ripple": ("ripple", "1"),
    }.items():
        size = {"motor_cogging": 0.03, "torque_ripple": 0.05}[name]
        numbers = {unit[0]: size, "phase": 1.0, "motor": float(motor)}
        (made,) = convert(finding(name, stage="motor", harmonic=37, **numbers), FACTS).effects
        rows = signals(200, {MOTOR_ANGLE: real, MOTOR: np.full(200, motor - 1.0), CURRENT: np.ones(200)})
        pushed = evaluate(name, rows, {k: n.si for k, n in made.parameters.items()})
        assert np.allclose(pushed, -size * np.cos(37 * seen + 1.0), atol=1e-9)


def test_a_line_of_both_motors_is_one_effect_of_each() -> None:
    numbers = {"amplitude": 0.03, "phase": 1.0, "amplitude_2": 0.01, "phase_2": 0.5}
    made = convert(finding("motor_cogging", stage="motor", harmonic=33, **numbers), FACTS)
    found = [(e.parameters["motor"].si, e.parameters["amplitude"].si) for e in made.effects]
    assert found == [(1.0, 0.03), (2.0, 0.01)] and made.remarks == []


def test_a_line_of_friction_keeps_its_phase_where_the_axis_was() -> None:
    found = finding("position_friction", order=123.4, amplitude=5.0, phase=1.0)
    (made,) = convert(found, FACTS).effects
    stage, harmonic = nearest_place(123.4)
    assert (made.stage, made.harmonic) == (stage, harmonic)
    near = 1.0 + np.linspace(-0.01, 0.01, 50)
    assert made.parameters["phase"].si == pytest.approx(
        np.angle(np.exp(1j * (ORDERS[stage] * harmonic * 1.0 - 123.4 * 1.0 - 1.0)))
    )
    wave = np.cos(ORDERS[stage] * harmonic * near - made.parameters["phase"].si)
    assert np.allclose(wave, np.cos(123.4 * near + 1.0), atol=0.01)


def test_a_brake_that_lets_go_lowers_the_friction_under_it() -> None:
    model = with_effects(load(), "ra", ())
    corrected, _ = correct(model, "ra", [finding("brake_drag", torque=-50.0, start=100.0)], FACTS)
    before, after = model.axes.ra.friction, corrected.axes.ra.friction
    assert after.coulomb.si == pytest.approx(before.coulomb.si - 50.0)
    (drag,) = corrected.axes.ra.effects
    assert drag.parameters["start"].si + drag.parameters["duration"].si == pytest.approx(100.0)


def smooth(angle: np.ndarray) -> np.ndarray:
    """A torque that no name of the catalogue has, N m over the axis angle in rad."""
    return 25.0 * np.exp(-0.5 * ((angle - 4.85) / 0.03) ** 2) - 10.0 * np.tanh((angle - 4.95) / 0.04)


def logs(folder: Path, model: PlantModel) -> list[Path]:
    """Sweeps and ramps of the right ascension axis over some 22 degrees, from the compiled loop."""
    paths, start = [], 4e8
    for k, kind in enumerate(("sweep", "sweep", "ramp", "sweep")):
        wanted = manoeuvre(kind)
        log = simulate(
            model, "ra", len(wanted) * 0.01, Excitation(setpoint=wanted, start_steps=start), seed=k + 1
        )
        start = float(log.position[-1])
        path = folder / f"run{k + 1}.log"
        with path.open("w", encoding="utf-8") as file:
            file.write(HEADER.format(axis="ra", minute=2 * k) + ",".join(COLUMNS) + "\n")
            np.savetxt(file, np.column_stack([getattr(log, c) for c in COLUMNS]), fmt=FORMATS, delimiter=",")
        paths.append(path)
    return paths


@pytest.mark.slow
def test_a_smooth_torque_over_the_angle_comes_back_as_an_unknown_within_its_uncertainty(
    tmp_path: Path,
) -> None:
    x = np.linspace(4.6, 5.1, 32)
    true = Function("torque", "axis_angle", "cubic", 0.0, tuple(zip(x, smooth(x), strict=True)), "a test")
    plain = with_effects(load("low_preload"), "ra", ())
    paths = logs(tmp_path, with_effects(plain, "ra", [EffectModel("unknown", function=true)]))
    runs = [read_axis_log(p) for p in paths]
    frame = build_frame(runs)
    whole = np.ones(len(frame.t))
    drive = Transmission(
        per_ampere=0.39 * RATIO, left={"a": whole, "b": whole}, softness_s2=0.0, stiffness=3e6
    )
    view = motion_of(frame, WIDTH)
    t = torque_problem(view, drive, frame.run == 3, declared_numbers(runs, None))
    assert t is not None
    columns = spline_columns(view.x[view.rows], 16)
    labels = tuple((f"knot_{k}", "N m") for k in range(columns.shape[1]))
    s = select(t.problem, [Candidate("unknown", "axis_angle", columns, labels)], np.random.default_rng(0))
    assert [c.candidate.name for c in s.chosen] == ["unknown"] and s.held.after < s.held.before
    curve = curve_of(s, 0, view)
    assert curve is not None
    found = replace(finding("unknown", domain="axis_angle"), curve=curve)
    corrected, remarks = correct(plain, "ra", [found], FACTS)
    (effect,) = loads(dumps(corrected)).axes.ra.effects
    assert remarks == [] and effect.function is not None and "95 %" in effect.function.source
    knots, heights = (np.array(v) for v in zip(*effect.function.knots, strict=True))
    travelled = view.x[view.rows][t.problem.train]
    angle = np.linspace(*np.quantile(travelled, [0.03, 0.97]), 200)
    made, half = evaluate_function(knots, heights, angle), np.interp(angle, curve.x, curve.half)
    # an asymmetry of friction takes up a constant: the function is known up to that
    error = made - smooth(angle) - np.mean(made - smooth(angle))
    assert np.std(smooth(angle)) > 8.0
    assert np.mean(np.abs(error) < half + 0.3) > 0.9, (np.abs(error).max(), half)
    assert np.std(error) < 0.1 * np.std(smooth(angle))


def test_a_sum_of_stops_is_the_hysteresis_calibration_fits() -> None:
    (made,) = convert(finding("unknown", domain="reversal", loop=12.0, travel=1e-3), FACTS).effects
    model = loads(dumps(with_effects(load(), "ra", [made])))
    (back,) = model.axes.ra.effects
    assert back == made and back.function is not None
    angle = 1.0 + 4e-3 * np.sin(np.linspace(0.0, 12.0, 400))
    p = np.zeros(80)
    numbers = _function(back.function)
    p[MEMORY : MEMORY + len(numbers)] = numbers
    y = np.zeros(len(angle))
    values_over(KINDS[formula], signals(len(angle), {ANGLE: angle}), p, y)
    state = stop_operator(angle, np.zeros(len(angle), dtype=np.int64), 1e-3) / 1e-3
    assert np.allclose(y[20:], -12.0 * state[20:], atol=0.01)  # behind the first time at an end
    assert np.ptp(y) == pytest.approx(24.0)


def test_the_emulators_own_logs_name_the_plant_file_that_is_declared() -> None:
    model, keep = declared_model({"note": "schmidt, plant high_preload", "preload": "low"}, None)
    assert keep and model.name == "high_preload"
    model, keep = declared_model({"preload": "high"}, None)
    assert not keep and model.name == "high_preload"


def test_an_unknown_without_a_function_is_a_remark() -> None:
    brush = finding("unknown", domain="motor_angle", channel="E")
    corrected, remarks = correct(load(), "ra", [brush], FACTS)
    assert len(remarks) == 1 and "left out" in remarks[0]
    assert all(e.name != "unknown" for e in corrected.axes.ra.effects)
