"""Scenarios that nobody should write and somebody will: (name, text). Each was found to hang, to end in a
traceback or to fill the memory, or is a near relation of one that did."""

BASE = """name: x
start_utc: 2026-02-10T14:00:00Z
steps:
  - power_on: {}
"""


def step(text: str) -> str:
    """The base with one more step."""
    return f"{BASE}  - {text}\n"


def overriding(text: str) -> str:
    """The base on a plant with one number changed."""
    return f"{BASE}plant: {{file: low-preload, overrides: {{{text}}}}}\n"


def target(text: str) -> str:
    """The base going somewhere."""
    return step(f"goto: {{target: {{{text}}}}}")


_FIRST = "a: &a [x,x,x,x,x,x,x,x,x,x]\n"
_LAUGHS = "".join(
    f"{name}: &{name} [{','.join(['*' + before] * 10)}]\n"
    for before, name in zip("abcdefgh", "bcdefghi", strict=True)
)
"""A hundred million values in nine lines."""
NINES = "9" * 5000

REFUSED: tuple[tuple[str, str], ...] = (
    ("wait of 1e30 s", step("wait: {for: 1e30 s}")),
    ("wait of 1e9 h", step("wait: {for: 1e9 h}")),
    ("at 1e30 s", BASE.replace("power_on: {}", "power_on: {}\n    at: 1e30 s")),
    ("delay of 1e300 s", BASE.replace("power_on: {}", "power_on: {}\n    delay: 1e300 s")),
    ("track of 1e12 s", BASE + "  - goto: {target: Capella}\n  - track: {for: 1e12 s}\n"),
    ("time limit of 1e300 s", BASE + "time_limit: 1e300 s\n"),
    ("fault at 1e300 s", BASE + "faults: [{node_off: {node: AXIS_RA}, at: 1e300 s}]\n"),
    ("speed of nearly nothing", BASE + "speed: 0.000000000000001\n"),
    ("speed of 1e12", BASE + "speed: 1000000000000.0\n"),
    ("speed inf", BASE + "speed: .inf\n"),
    ("speed nan", BASE + "speed: .nan\n"),
    ("alias bomb", _FIRST + _LAUGHS + BASE),
    ("alias bomb in the description", BASE + "description:\n" + "".join(
        f"  {line}\n" for line in (_FIRST + _LAUGHS).splitlines())),
    ("alias that holds itself", BASE + "description: &a [*a]\n"),
    ("alias of nothing", BASE + "description: *nope\n"),
    ("merge of itself", "a: &a\n  <<: *a\n"),
    ("NUL byte", BASE + 'description: "a\0b"\n'),
    ("NUL escape", BASE.replace("name: x", 'name: "a\\0b"')),
    ("escape of no character", BASE + 'description: "\\UFFFFFFFF"\n'),
    ("half a surrogate pair", BASE + 'name2: "\\ud800"\n'),
    ("lists in lists", BASE + "description: " + "[" * 5000 + "]" * 5000 + "\n"),
    ("maps in maps", BASE + "description: " + "{a: " * 3000 + "}" * 3000),
    ("blocks in blocks", "".join(" " * i + "a:\n" for i in range(3000))),
    ("half a bit", overriding("axes.ra.encoders.absolute: 12.5")),
    ("grid of zero", overriding("numerics.grid: 0")),
    ("grid of nearly zero", overriding("numerics.grid: 1.0e-300")),
    ("grid nan", overriding("numerics.grid: .nan")),
    ("inertia inf", overriding("axes.ra.inertia: .inf")),
    ("inertia below zero", overriding("axes.ra.inertia: -1")),
    ("controller's period", overriding("controller.period: 1.0e+300")),
    ("right ascension that overflows", target("ra: '" + "9" * 400 + ":0:0', dec: '+1:0:0'")),
    ("right ascension of 5000 digits", target(f"ra: '{NINES}:0:0', dec: '+1:0:0'")),
    ("declination of 5000 digits", target(f"ra: '5:0:0', dec: '+{NINES}:0:0'")),
    ("seconds of 5000 digits", target(f"ra: '5:0:{NINES}', dec: '+1:0:0'")),
    ("proper motion inf", target("ra: '5:0:0', dec: '+1:0:0', pm_dec: .inf")),
    ("proper motion of 1e300", target("ra: '5:0:0', dec: '+1:0:0', pm_ra: 1.0e+300")),
    ("year 9999", BASE.replace("2026", "9999")),
    ("year 1", BASE.replace("2026", "0001")),
    ("month 13", BASE.replace("-02-", "-13-")),
    ("seed of 5000 digits", BASE + f"seed: {NINES}\n"),
    ("seed of 5000 hex digits", BASE + "seed: 0x" + "f" * 5000 + "\n"),
    ("seed inf", BASE + "seed: .inf\n"),
    ("bit rate 0", BASE + "network: {bitrate: 0 kbit/s}\n"),
    ("bit rate of 1e300", BASE + "network: {bitrate: 1e300 Mbit/s}\n"),
    ("crystal of nan ppm", BASE + "network: {nodes: {AXIS_RA: {ppm: .nan}}}\n"),
    ("crystal of inf ppm", BASE + "network: {nodes: {AXIS_RA: {ppm: .inf}}}\n"),
    ("phase of 1e200 s", BASE + "network: {nodes: {AXIS_RA: {phase: 1e200 s}}}\n"),
    ("parameter of 5000 digits", BASE + f"network: {{nodes: {{AXIS_RA: {{parameters: {{1: {NINES}}}}}}}}}\n"),
    ("latitude of 1e300", BASE + "site: {latitude: 1e300 deg}\n"),
    ("height of -1e300 m", BASE + "site: {height: -1e300 m}\n"),
    ("temperature of 1e300", BASE + "site: {temperature: 1e300 degC}\n"),
    ("status period of nothing", BASE + "logs: {status: 1e-300 s}\n"),
    ("trace period of nothing", BASE + "logs: {traces: 0 s}\n"),
    ("time stamp that is none", BASE + "description: !!timestamp 'x'\n"),
    ("number that is none", BASE + "seed: !!int 'x'\n"),
    ("code", "!!python/object/apply:os.system ['true']\n"),
    ("plant of 5000 letters", BASE + "plant: {file: " + "a" * 5000 + "}\n"),
    ("plant with a NUL", BASE + 'plant: {file: "a\\0b"}\n'),
    ("plant that is a folder", BASE + "plant: {file: /tmp}\n"),
    ("wait of -1 s", step("wait: {for: -1 s}")),
    ("at -5 s", BASE.replace("power_on: {}", "power_on: {}\n    at: -5 s")),
    ("fault at -5 s", BASE + "faults: [{node_off: {node: AXIS_RA}, at: -5 s}]\n"),
    ("temperature below zero kelvin", BASE + "site: {temperature: -500 degC}\n"),
    ("pressure of -5 hPa", BASE + "site: {pressure: -5 hPa}\n"),
    ("horizon beyond the zenith", BASE + "site: {horizon: 95 deg}\n"),
    ("stiction below Coulomb", overriding("axes.ra.friction.stiction: 1")),
    ("override that is a block", overriding("axes.ra.inertia: {value: 3, unit: parsec}")),
    ("override that is a word", overriding("axes.ra.inertia: heavy")),
    ("effect in parsec", BASE + "plant: {file: low-preload, effects: [{name: gear_mesh, stage: mesh1, "
        "parameters: {amplitude: {value: 1, unit: parsec}}}]}\n"),
    ("inputs of a board without any", BASE + "network: {nodes: {AXIS_RA: {inputs: {wind: 3}}}}\n"),
    ("one effect 3000 times", BASE + f"plant: {{file: low-preload, effects: [{'pwm_deadband, ' * 3000}]}}\n"),
    ("one fault 101 times", BASE + f"faults: [{'{stuck_dominant: {}}, ' * 101}]\n"),
    ("bytes for text", BASE + "description: !!binary aGVsbG8=\n"),
    ("a set for text", BASE + "description: !!set {a, b}\n"),
    ("pairs for text", BASE + "description: !!omap [a: 1]\n"),
    ("seed that no command line takes", BASE + f"seed: {2**63}\n"),
    ("bit rate below zero", BASE + "network: {bitrate: -1 Mbit/s}\n"),
    ("bit rate beyond CAN's", BASE + "network: {bitrate: 2 Mbit/s}\n"),
    ("program for an AVR beside RS232", BASE + "network: {nodes: {AXIS_RA: {firmware: x.elf}}}\n"),
    ("program for an AVR beside USB", BASE + "network: {nodes: {GATEWAY: {firmware: x.elf}}}\n"),
    ("step that is a list", step("[power_on]")),
    ("step that is nothing", step("~")),
    ("override that is true", overriding("axes.ra.inertia: true")),
    ("override of nothing", overriding("axes.ra.nose: 1")),
    ("half a harmonic", BASE + "plant: {file: low-preload, effects: [{name: gear_mesh, stage: mesh1, "
        "harmonic: 2.5}]}\n"),
    ("nothing", ""),
    ("a number", "3"),
    ("a tab", "\t"),
)  # fmt: skip
