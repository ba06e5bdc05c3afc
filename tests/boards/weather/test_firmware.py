"""The weather station: three sensors on the ADC, and for how long bad weather counts."""

import pytest

from boards.weather.firmware import WeatherBoard
from bus.protocol import Health
from tests.boards.alone import Alone

WEATHER_MAST = 0x72


@pytest.fixture
def alone() -> Alone[WeatherBoard]:
    return Alone(WeatherBoard, WEATHER_MAST, temperature=10.0, humidity=50.0, wind=2.0, rain=0.0)


def after(alone: Alone[WeatherBoard], **pins: float) -> dict[str, float]:
    """What is said a second later."""
    alone.pins.update(pins)
    alone.run(1.0)
    return alone.said()


def test_routines_take_what_the_table_says(alone: Alone[WeatherBoard]) -> None:
    sample, can = (alone.board.cpu.lines[name] for name in ("sample", "can"))
    assert (sample.cost_ns, sample.latency_ns, sample.source.level) == (200_000, 1200, False)
    assert (can.cost_ns, can.latency_ns, can.source.level) == (60_000, 1200, True)


def test_pins_read_fair_weather_before_a_scenario_says_more() -> None:
    assert {pin.name: (pin.default, pin.unit) for pin in WeatherBoard.PINS} == {
        "temperature": (10.0, "degC"), "humidity": (50.0, "%"), "wind": (2.0, "m/s"),
        "rain": (0.0, "drops on the sensor, 0 or 1"),
    }  # fmt: skip


@pytest.mark.parametrize(("pin", "signal", "low", "high"), [
    ("temperature", "Temperature", -40.0, 60.0), ("humidity", "Humidity", 0.0, 100.0),
    ("wind", "Wind", 0.0, 75.0),
])  # fmt: skip
def test_a_sensor_is_read_in_1023_steps_and_stops_at_its_rails(
    alone: Alone[WeatherBoard], pin: str, signal: str, low: float, high: float
) -> None:
    step = (high - low) / 1023
    for value, told, rail in (
        (low, low, False), (high, high, False), (low - step, low, True), (high + step, high, True),
        (low + 0.4 * step, low, False), (low + 300.4 * step, low + 300 * step, False),
        (low - 0.4 * step, low, False), (high + 0.4 * step, high, False),
    ):  # fmt: skip
        said = after(alone, **{pin: value})
        assert said[signal] == pytest.approx(told, abs=0.0501 if pin == "humidity" else 0.00501)
        assert (Health.SENSOR in alone.board.health()) is rail


@pytest.mark.parametrize(("pins", "signals"), [
    ({}, set()), ({"rain": 0.49}, set()), ({"rain": 0.5}, {"Rain"}), ({"rain": 1.0}, {"Rain"}),
    ({"wind": 14.95}, set()), ({"wind": 15.05}, {"Windy"}), ({"humidity": 89.9}, set()),
    ({"humidity": 90.1}, {"Humid"}),
    ({"humidity": 95.0, "wind": 30.0, "rain": 1.0}, {"Rain", "Windy", "Humid"}),
])  # fmt: skip
def test_weather_is_bad_by_rain_wind_or_humidity(
    alone: Alone[WeatherBoard], pins: dict[str, float], signals: set[str]
) -> None:
    said = after(alone, **pins)
    assert {name for name in ("Rain", "Windy", "Humid") if said[name]} == signals
    assert said["Unsafe"] == bool(signals)


def test_limits_are_parameters_and_at_a_limit_is_within_it(alone: Alone[WeatherBoard]) -> None:
    alone.board.values["wind_limit_cm_s"].value = 199  # 1.979 m/s are read
    alone.board.values["humidity_limit_permille"].value = 500  # 50.05 %
    said = after(alone)
    assert (said["Windy"], said["Humid"]) == (0, 1)
    alone.board.values["wind_limit_cm_s"].value = 197
    alone.board.values["humidity_limit_permille"].value = 501
    said = after(alone)
    assert (said["Windy"], said["Humid"]) == (1, 0)
    for name in ("wind_limit_cm_s", "humidity_limit_permille"):
        alone.board.values[name].value = 0
    said = after(alone, wind=0.0, humidity=0.0)
    assert (said["Windy"], said["Humid"]) == (0, 0)


@pytest.mark.parametrize("hold_s", [0, 3])
def test_bad_weather_counts_for_a_while_after_it_is_over(alone: Alone[WeatherBoard], hold_s: int) -> None:
    alone.board.values["hold_s"].value = hold_s
    assert after(alone)["Unsafe"] == 0
    assert [after(alone, rain=1.0)["Unsafe"] for _ in range(2)] == [1, 1]
    assert [after(alone, rain=0.0)["Unsafe"] for _ in range(5)] == [1] * hold_s + [0] * (5 - hold_s)


def test_an_hour_that_nobody_has_seen_is_no_bad_weather(alone: Alone[WeatherBoard]) -> None:
    alone.board.values["hold_s"].value = 3600
    assert after(alone)["Unsafe"] == 0


def test_after_power_up_the_weather_is_as_it_is_now(alone: Alone[WeatherBoard]) -> None:
    assert after(alone, rain=1.0, wind=99.0)["Unsafe"] == 1
    assert Health.SENSOR in alone.board.health()
    alone.board.values["hold_s"].value = 7
    alone.pins.update(rain=0.0, wind=2.0)
    alone.board.power_off(alone.queue.now_ns)
    alone.board.power_on(alone.queue.now_ns)
    alone.run(0.4)
    assert alone.board.health() == Health(0)
    assert alone.board.values["hold_s"].value == 300
    assert after(alone)["Unsafe"] == 0
