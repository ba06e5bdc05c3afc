"""The measured logs: files, rig file as an outside user writes it, what is known to be in them.

The truth of each is its line of the data folder's README; sizes are wide on purpose.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from tests.measured import own
from tests.measured.truth import Sign

ROOT = Path(__file__).parents[2]
DATA = ROOT.parent / "shared" / "data" / "measured"
EXAMPLES = ROOT / "calibration" / "rigs"
RIGS = Path(__file__).parent / "rigs"

Rms = Callable[[list[Path], Path | None], float]


@dataclass(frozen=True, kw_only=True)
class Case:
    """`needs` must all be told, `may` may be; none needed: the log has nothing that can be named."""

    key: str
    files: str
    rig: Path | None = None
    needs: tuple[Sign, ...] = ()
    may: tuple[Sign, ...] = ()
    own: Rms | None = None
    hold_out: tuple[str, ...] = ()

    @property
    def logs(self) -> list[Path]:
        """The files that are there."""
        return sorted(DATA.glob(self.files))


@dataclass(frozen=True, kw_only=True)
class Own:
    """`terms` beside the declared ones."""

    terms: own.Terms
    hold_out: list[str] = field(default_factory=list)

    def __call__(self, logs: list[Path], rig: Path | None) -> float:
        return own.held_out_rms(logs, rig, self.terms, self.hold_out)


def sign(*names: str) -> Sign:
    """Any effect of these names."""
    return Sign(names=names)


LINES = ("motor_cogging", "torque_ripple", "gear_eccentricity", "gear_mesh", "bearing_pass", "damaged_tooth")
# friction that is more than its sign and a slope, and teeth or wires that bend: no README excludes them
FRICTION = sign(
    *("friction_asymmetry", "stribeck_change", "viscous_change", "coulomb_change", "load_friction"),
    *("presliding", "play", "position_friction", "friction_warmup", "shaft_compliance"),
)
# a speed that is counted over a row is half a row late; a filtered one more
LATE = Sign(names=("channel_delay",), size=("delay", 0.0, 0.005))
COLUMNS = sign("log_wrap", "sample_loss", "clock_jitter")
OTHER = sign("unknown")
WEIGHT = Sign(names=("gravity_imbalance",), size=("amplitude", 595.0, 699.0))


def _motor(harmonic: int) -> Sign:
    return Sign(names=LINES, stage="motor", harmonic=harmonic)


def _worm(period_s: float) -> Sign:
    near = (period_s * (1 - 0.012), period_s * (1 + 0.012))
    return Sign(names=("gear_eccentricity", "unknown"), period_s=near)


def _guide(key: str, file: str, period_s: float | None, harmonics: int = 4, rig: Path | None = None) -> Case:
    return Case(
        key=key,
        files=f"phd2/{file}",
        rig=rig,
        needs=(_worm(period_s),) if period_s else (),
        may=(Sign(names=("gear_eccentricity", "unknown")),) if period_s else (_worm(638.25), _worm(478.69)),
        own=partial(own.guide_rms, periods_s=[period_s], harmonics=harmonics) if period_s else None,
    )


def _lifted(held: str) -> Case:
    names = (f"{held}.csv",) if held else ()
    return Case(
        key="xl330" + (f"-{held}" if held else ""),
        files="xl330/*.csv",
        rig=EXAMPLES / "xl330.yaml",
        needs=(WEIGHT,),
        may=(COLUMNS, FRICTION, OTHER),
        own=Own(terms=own.weight, hold_out=list(names)),
        hold_out=names,
    )


CASES = [
    _lifted(""),
    *(_lifted(k) for k in ("10h28m10", "10h28m57", "10h29m21", "10h30m10")),
    Case(
        key="ripple_speed",
        files="motor_ripple/ripple_sdm251_off_060.csv",
        rig=RIGS / "ripple_speed.yaml",
        needs=(_motor(6),),
        may=(Sign(names=LINES), OTHER),
        own=Own(terms=own.orders(1, 2, 3, 4, 6, 12, 18, 24, 30, 36, 42, 48)),
    ),
    Case(
        key="ripple_load0",
        files="motor_ripple/ripple_ms4887_torque60_load0.csv",
        rig=RIGS / "ripple_torque.yaml",
        needs=(_motor(4), _motor(2), _motor(24)),
        may=(Sign(names=LINES), OTHER),
        own=Own(terms=own.orders(1, 2, 3, 4, 6, 8, 12, 24, 48, 60)),
    ),
    Case(
        key="ripple_load50",
        files="motor_ripple/ripple_ms4887_torque60_load50.csv",
        rig=RIGS / "ripple_torque.yaml",
        needs=(_motor(24), _motor(2), _motor(1)),
        may=(Sign(names=LINES), OTHER),
        own=Own(terms=own.orders(1, 2, 3, 4, 6, 8, 12, 24, 48, 60)),
    ),
    Case(key="torque_steps", files="torque_steps/*.csv", rig=RIGS / "torque_steps.yaml", may=(LATE,)),
    Case(
        key="ur10e_j1",
        files="ur10e/ur10e_j1.csv",
        rig=RIGS / "ur10e_j1.yaml",
        needs=(Sign(names=("viscous_change", "stribeck_change", "unknown"), domain="velocity"),),
        may=(FRICTION, OTHER, Sign(names=LINES), LATE, COLUMNS),
        own=Own(terms=own.both(own.bends, own.sides)),
    ),
    Case(
        key="ur10e_j2",
        files="ur10e/ur10e_j2.csv",
        rig=RIGS / "ur10e_j2.yaml",
        needs=(Sign(names=("gravity_imbalance",), size=("amplitude", 9.5, 11.7)),),
        may=(FRICTION, OTHER, Sign(names=LINES), LATE, COLUMNS),
        own=Own(terms=own.both(own.weight, own.bends)),
    ),
    Case(
        key="servo_command",
        files="servo_command/*.csv",
        rig=RIGS / "servo_command.yaml",
        needs=(Sign(names=("channel_delay",), size=("delay", 0.07, 0.21)),),
        may=(OTHER, COLUMNS),
        own=Own(terms=own.late_by(0.14)),
    ),
    Case(
        key="emps",
        files="emps/DATA_EMPS.mat",
        rig=EXAMPLES / "emps.yaml",
        needs=(sign("friction_asymmetry"), Sign(names=(*LINES, "unknown"), order=(396.0, 404.0))),
        may=(FRICTION, OTHER, Sign(names=("channel_delay",), size=("delay", 0.0003, 0.0011))),
        own=Own(terms=own.both(own.sides, own.bends, own.orders(400), own.bristles)),
    ),
    Case(
        key="servo_cogging",
        files="servo_cogging/motorCoggingTorque.txt",
        rig=EXAMPLES / "servo_cogging.yaml",
        needs=(_motor(6), sign("position_friction")),
        may=(Sign(names=LINES), FRICTION, OTHER, COLUMNS),
        own=Own(terms=own.both(own.orders(*range(1, 61)), own.friction_waves)),
    ),
    Case(
        key="servo_output",
        files="servo_output/outputEncoderData.txt",
        rig=EXAMPLES / "servo_output.yaml",
        needs=(
            Sign(names=("play",), size=("gap", 3.5, 9.5)),
            *(
                Sign(names=("gear_eccentricity", "encoder_eccentricity"), stage="output", harmonic=h)
                for h in (1, 2)
            ),
        ),
        may=(Sign(names=LINES), sign("encoder_eccentricity", "encoder_subdivision", "roller_slip"), OTHER),
        own=Own(terms=own.both(own.orders(*(k / 4096 for k in range(1, 9))), own.gap)),
    ),
    Case(
        key="pendulum",
        files="pendulum/*.mat",
        rig=EXAMPLES / "pendulum.yaml",
        needs=(
            sign("gravity_imbalance"),
            Sign(names=("channel_delay",), size=("delay", 0.0006, 0.0014)),
        ),
        may=(FRICTION, OTHER),
        own=Own(terms=own.weight),
    ),
    Case(
        key="tribometer",
        files="tribometer/test_data_2.txt",
        rig=EXAMPLES / "tribometer.yaml",
        needs=(sign("presliding"),),
        may=(COLUMNS, FRICTION, OTHER),
        own=Own(terms=own.both(own.bristles, own.places)),
    ),
    _guide("phd2_01", "dataset01.csv", 478.69),
    _guide("phd2_02", "performance_dataset02.txt", 122.2, 2),
    _guide("phd2_03", "performance_dataset03.txt", 382.95),
    _guide("phd2_04", "performance_dataset04.txt", 382.95),
    _guide("phd2_06", "performance_dataset06.txt", 122.2, 2),
    _guide("phd2_07", "performance_dataset07.txt", 239.34, 3, RIGS / "g11.yaml"),
]
