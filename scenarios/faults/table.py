"""The table of faults: name, level, what happens, arguments, the code that does it, what is left."""

from __future__ import annotations

from scenarios.faults import onboard, onbus, onchip, onplant, onsensor
from scenarios.faults.kind import Kind, Parameter

_NODE = Parameter("node", "the board", "node")
_SENSOR = Parameter("sensor", "the sensor", "sensor")
_AXIS = Parameter("axis", "the axis", "axis")
_EITHER = Parameter("axis", "the axis (both when left out)", "axis", "")
_MOTOR = Parameter("motor", "a pulls in +, b in −", "motor")
_SHARE = Parameter("probability", "share of them", "quantity", None, 0.0, 1.0, "fraction")

_NOTHING = "nothing"
_COUNTERS = "error counters (TEC, REC), which good frames take down"
_FRESH = "a board that has just booted"
_MOVED = "what has moved meanwhile"

KINDS: tuple[Kind, ...] = (
    Kind(
        "bit_errors",
        "bus",
        "in this share of the frames one bit is inverted on the wire: error frames, repetitions, "
        "error counters",
        (_SHARE, Parameter("node", "the sender (all when left out)", "node", "")),
        onbus.BitErrors,
        _COUNTERS,
    ),
    Kind(
        "babbler",
        "bus",
        "a node that is none of ours sends one identifier without end; the lower it is, the less "
        "gets through",
        (
            Parameter("identifier", "what it sends", "identifier", 0, 0, 0x7FF),
            Parameter(
                "load",
                "share of the bus it takes when nobody else wants it",
                "quantity",
                1.0,
                0.001,
                1.0,
                "fraction",
            ),
        ),
        onbus.Babbler,
        _COUNTERS,
    ),
    Kind(
        "partition",
        "bus",
        "the cable breaks: these boards make up a bus of their own, each piece arbitrates and "
        "acknowledges for "
        "itself; logs and doors stay with the other boards",
        (Parameter("nodes", "the boards that are cut off", "nodes"),),
        onbus.Cut,
        "error counters, and frames that waited for a receiver",
    ),
    Kind(
        "wrong_bitrate",
        "bus",
        "the board's controller is set to another bit rate: it destroys what it hears until it is "
        "passive, and is "
        "not understood",
        (_NODE, Parameter("bitrate", "what it is set to", "quantity", None, 5e3, 2e6, "bitrate")),
        onbus.WrongRate,
        _COUNTERS,
    ),
    Kind(
        "duplicate_node",
        "bus",
        "a second node has the board's identifiers: it measures something else and answers its "
        "commands as well, "
        "so frames collide beyond arbitration",
        (_NODE, Parameter("period", "of its measurements", "quantity", 0.01, 0.001, 10.0, "time")),
        onbus.Twin,
        _COUNTERS,
    ),
    Kind(
        "stuck_dominant",
        "bus",
        "the bus is held dominant: nobody can start, the sender of the moment goes off the bus, "
        "all others end "
        "error passive (ISO 11898-1)",
        (),
        onbus.Dominant,
        _COUNTERS,
    ),
    Kind(
        "node_off",
        "board",
        "the board has no supply; it boots afresh when it is back",
        (_NODE,),
        onboard.NoSupply,
        _FRESH,
    ),
    Kind(
        "brown_out",
        "board",
        "enough supply for the CAN controller (MCP2515: 2.7 V) and too little for the processor: "
        "outputs fall, the "
        "bus is acknowledged, nobody answers; it boots when the supply is back",
        (_NODE,),
        onboard.BrownOut,
        _FRESH,
    ),
    Kind(
        "reset",
        "board",
        "the board restarts at once, and again after every `every`",
        (
            _NODE,
            Parameter(
                "every", "time between resets (one only when left out)", "quantity", "", 0.01, 1e6, "time"
            ),
        ),
        onboard.Resets,
        _FRESH,
    ),
    Kind(
        "hang",
        "board",
        "the processor stands still: outputs keep their values, the CAN controller acknowledges "
        "and keeps two "
        "frames; afterwards it goes on from where it stood",
        (_NODE,),
        onboard.Hang,
        "lost interrupts, and a board's clock that lacks the time",
    ),
    Kind(
        "crystal_drift",
        "board",
        "the board's crystal runs faster by this much (timers notice with their next period)",
        (_NODE, Parameter("ppm", "change of its rate, parts per million", "number", None, -9900.0, 9900.0)),
        onboard.Drift,
        "the time its clock has gained",
    ),
    Kind(
        "late_interrupts",
        "board",
        "interrupts are masked for `masked` every `every`: those that come meanwhile pile up and "
        "are served late, "
        "a second one of a kind is lost",
        (
            _NODE,
            Parameter("masked", "how long", "quantity", 0.006, 1e-6, 10.0, "time"),
            Parameter("every", "how often", "quantity", 0.02, 1e-5, 100.0, "time"),
        ),
        onboard.LateInterrupts,
        "lost interrupts, and a board's clock that lacks the time",
    ),
    Kind(
        "frame_loss",
        "chip",
        "frames of a board, or with an identifier, pass the bus, but each receiver misses them "
        "with this "
        "probability",
        (
            Parameter("node", "whose frames", "node", ""),
            Parameter("identifier", "or these", "identifier", "", 0, 0x7FF),
            Parameter("probability", "share of them", "quantity", 1.0, 0.0, 1.0, "fraction"),
        ),
        onchip.FrameLoss,
        _NOTHING,
        ("node", "identifier"),
    ),
    Kind(
        "deaf_controller",
        "chip",
        "the CAN controller gives its processor no frame; it still acknowledges and sends",
        (_NODE,),
        onchip.DeafController,
        _NOTHING,
    ),
    Kind(
        "endat_line",
        "chip",
        "in this share of the EnDat transfers one bit is inverted: the board shows the last "
        "position and a CRC error",
        (_AXIS, _SHARE),
        onchip.EndatLine,
        _NOTHING,
    ),
    Kind(
        "serial_noise",
        "chip",
        "in this share of a board's RS232 packets one bit is inverted",
        (_NODE, _SHARE),
        onchip.SerialNoise,
        _NOTHING,
    ),
    Kind(
        "pwm_stuck",
        "chip",
        "the PWM of an axis board keeps its duties, whatever is written",
        (_AXIS,),
        onchip.PwmStuck,
        _MOVED,
    ),
    Kind(
        "sensor_stuck",
        "sensor",
        "it keeps showing the value it had when it was first read",
        (_SENSOR,),
        onsensor.Stuck,
        _NOTHING,
    ),
    Kind(
        "sensor_noise",
        "sensor",
        "white noise on every reading",
        (_SENSOR, Parameter("deviation", "standard deviation, in counts, A or V", "number", None, 0.0, 1e9)),
        onsensor.Noise,
        _NOTHING,
    ),
    Kind(
        "sensor_bias",
        "sensor",
        "an offset on every reading",
        (_SENSOR, Parameter("offset", "in counts, A or V", "number", None, -1e9, 1e9)),
        onsensor.Bias,
        _NOTHING,
    ),
    Kind(
        "sensor_scale",
        "sensor",
        "every reading is multiplied, about the sensor's zero",
        (_SENSOR, Parameter("factor", "1 is right", "number", None, -10.0, 10.0)),
        onsensor.Scale,
        _NOTHING,
    ),
    Kind(
        "sensor_delayed",
        "sensor",
        "the board sees what it would have read this much earlier",
        (_SENSOR, Parameter("delay", "how much", "quantity", None, 0.0, 60.0, "time")),
        onsensor.Delayed,
        _NOTHING,
    ),
    Kind(
        "sensor_intermittent",
        "sensor",
        "a bad contact: in this share of the readings it shows the last good one",
        (_SENSOR, _SHARE),
        onsensor.Intermittent,
        _NOTHING,
    ),
    Kind(
        "motor_open",
        "actuator",
        "no voltage reaches the motor's winding (its current decays with L/R through the "
        "freewheel diode: a lead "
        "that breaks would stop it at once)",
        (_AXIS, _MOTOR),
        onplant.MotorOpen,
        _MOVED,
    ),
    Kind(
        "mosfet_short",
        "actuator",
        "the motor's switch conducts all the time",
        (_AXIS, _MOTOR),
        onplant.MosfetShort,
        _MOVED,
    ),
    Kind(
        "weak_supply",
        "actuator",
        "the motors' supply has this share of its voltage",
        (Parameter("factor", "share that is left", "quantity", 0.7, 0.0, 1.5, "fraction"), _EITHER),
        onplant.WeakSupply,
        _MOVED,
    ),
    Kind(
        "friction_change",
        "plant",
        "Coulomb and breakaway friction of an axis are this many times the declared",
        (_AXIS, Parameter("factor", "1 is as declared", "number", None, 0.01, 10.0)),
        onplant.Friction,
        _MOVED,
    ),
    Kind(
        "load_change",
        "plant",
        "the moved mass of an axis is this many times the declared",
        (_AXIS, Parameter("factor", "1 is as declared", "number", None, 0.1, 10.0)),
        onplant.Load,
        _MOVED,
    ),
    Kind(
        "play_change",
        "plant",
        "the gear trains of an axis have more play",
        (_AXIS, Parameter("angle", "how much more, at the axis", "quantity", None, 0.0, 36000.0, "angle")),
        onplant.Play,
        _MOVED,
    ),
)
BY_NAME = {kind.name: kind for kind in KINDS}
