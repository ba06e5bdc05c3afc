"""The table of faults: level, name, what happens, arguments, the code that does it, what is left."""

from functools import partial

from scenarios.lab.faults import onboard, onbus, onchip, onplant, onsensor
from scenarios.lab.faults.kind import Kind, Parameter

_bus = partial(Kind, "bus")
_board = partial(Kind, "board")
_chip = partial(Kind, "chip")
_sensor = partial(Kind, "sensor")
_actuator = partial(Kind, "actuator")
_plant = partial(Kind, "plant")

_NODE = Parameter("node", "the board", "node")
_SENSOR = Parameter("sensor", "the sensor", "sensor")
_AXIS = Parameter("axis", "the axis", "axis")
_EITHER = Parameter("axis", "the axis (both when left out)", "axis", default="")
_MOTOR = Parameter("motor", "a pulls in +, b in −", "motor")
_SHARE = Parameter("probability", "share of them", "fraction", low=0.0, high=1.0)

_COUNTERS = "error counters (TEC, REC), which good frames take down"
_FRESH = "a board that has just booted"
_MOVED = "what has moved meanwhile"

_DATA = (1 << 64) - 1
"""Eight bytes."""

KINDS: tuple[Kind, ...] = (
    _bus(
        "bit_errors", "in this share of the frames one bit is inverted on the wire: error frames, "
        "repetitions, error counters",
        (_SHARE, Parameter("node", "the sender (all when left out)", "node", default="")), onbus.BitErrors,
        _COUNTERS,
    ),
    _bus(
        "babbler", "a foreign node sends one identifier without end; the lower it is, the less gets through",
        (Parameter("identifier", "what it sends", "identifier", default=0, low=0, high=0x7FF),
        Parameter("load", "share of the bus it takes when nobody else wants it", "fraction",
                  default=1.0, low=0.001, high=1.0)),
        onbus.Babbler, _COUNTERS,
    ),
    _bus(
        "partition", "the cable breaks: these boards make up a bus of their own. Each piece arbitrates and "
        "acknowledges for itself. Logs and doors stay with the other boards",
        (Parameter("nodes", "the boards that are cut off", "nodes"),), onbus.Cut,
        "error counters, and frames that waited for a receiver",
    ),
    _bus(
        "wrong_bitrate", "the board's controller is set to another bit rate: it destroys what it hears "
        "until it is passive, and is not understood",
        (_NODE, Parameter("bitrate", "what it is set to", "bitrate", low=5e3, high=2e6)),
        onbus.WrongRate, _COUNTERS,
    ),
    _bus(
        "duplicate_node", "a second node has the board's identifiers: it measures something else and "
        "answers its commands as well, so frames collide beyond arbitration",
        (_NODE, Parameter("period", "of its measurements", "time", default=0.01, low=0.001, high=10.0)),
        onbus.Twin, _COUNTERS,
    ),
    _bus(
        "forged_sender", "a foreign node sends a board's frame. CAN proves no sender, so receivers accept "
        "it. A false POSITION drags a tracking axis, beyond its soft limits too",
        (Parameter("identifier", "what it sends", "identifier", low=0, high=0x7FF),
        Parameter("data", "eight bytes. The first is highest.", "whole", low=0, high=_DATA),
        Parameter("period", "of it", "time", default=0.01, low=0.001, high=1000.0)), onbus.Forger,
        _COUNTERS + ", and " + _MOVED,
    ),
    _bus(
        "stuck_dominant", "the bus is held dominant: nobody can start, the sender of the moment goes off "
        "the bus, all others end error passive (ISO 11898-1)",
        (), onbus.Dominant, _COUNTERS,
    ),
    _board(
        "node_off", "the board has no supply; it boots afresh when it is back",
        (_NODE,), onboard.NoSupply, _FRESH,
    ),
    _board(
        "brown_out", "enough supply for the CAN controller (MCP2515: 2.7 V) and too little for the "
        "processor. Outputs fall, the bus is acknowledged, nobody answers. It boots when the supply is back",
        (_NODE,), onboard.BrownOut, _FRESH,
    ),
    _board(
        "reset", "the board restarts at once, and again after every `every`",
        (_NODE, Parameter("every", "time between resets (one only when left out)", "time",
                          default="", low=0.01, high=1e6)),
        onboard.Resets, _FRESH,
    ),
    _board(
        "hang", "the processor stands still: outputs keep their values, the CAN controller acknowledges and "
        "keeps two frames; afterwards it goes on from where it stood",
        (_NODE,), onboard.Hang, "lost interrupts, and a board's clock that lacks the time",
    ),
    _board(
        "crystal_drift", "the board's crystal runs faster by this much (timers notice with their next "
        "period)",
        (_NODE,
        Parameter("ppm", "change of its rate, parts per million", "number", low=-9900.0, high=9900.0)),
        onboard.Drift, "the time its clock has gained",
    ),
    _board(
        "late_interrupts", "interrupts are masked for `masked` every `every`: those that come meanwhile "
        "pile up and are served late, a second one of a kind is lost",
        (_NODE, Parameter("masked", "how long", "time", default=0.006, low=1e-6, high=10.0),
        Parameter("every", "how often", "time", default=0.02, low=1e-5, high=100.0)), onboard.LateInterrupts,
        "lost interrupts, and a board's clock that lacks the time",
    ),
    _chip(
        "frame_loss", "frames of a board, or with an identifier, pass the bus, but each receiver misses "
        "them with this probability",
        (Parameter("node", "whose frames", "node", default=""),
        Parameter("identifier", "or these", "identifier", default="", low=0, high=0x7FF),
        Parameter("probability", "share of them", "fraction", default=1.0, low=0.0, high=1.0)),
        onchip.FrameLoss, one_of=("node", "identifier"),
    ),
    _chip(
        "deaf_controller", "the CAN controller gives its processor no frame; it still acknowledges and sends",
        (_NODE,), onchip.DeafController,
    ),
    _chip(
        "endat_line", "in this share of the EnDat transfers one bit is inverted: the board shows the last "
        "position and a CRC error",
        (_AXIS, _SHARE), onchip.EndatLine,
    ),
    _chip(
        "serial_noise", "in this share of a board's RS232 packets one bit is inverted",
        (_NODE, _SHARE), onchip.SerialNoise,
    ),
    _chip(
        "pwm_stuck", "the PWM of an axis board keeps its duties, whatever is written",
        (_AXIS,), onchip.PwmStuck, _MOVED,
    ),
    _sensor(
        "sensor_stuck", "it keeps showing the value it had when it was first read",
        (_SENSOR,), onsensor.Stuck,
    ),
    _sensor(
        "sensor_noise", "white noise on every reading",
        (_SENSOR,
        Parameter("deviation", "standard deviation, in counts, A or V", "number", low=0.0, high=1e9)),
        onsensor.Noise,
    ),
    _sensor(
        "sensor_bias", "an offset on every reading",
        (_SENSOR, Parameter("offset", "in counts, A or V", "number", low=-1e9, high=1e9)),
        onsensor.Bias,
    ),
    _sensor(
        "sensor_scale", "every reading is multiplied, about the sensor's zero",
        (_SENSOR, Parameter("factor", "1 is right", "number", low=-10.0, high=10.0)), onsensor.Scale,
    ),
    _sensor(
        "sensor_delayed", "the board sees what it would have read this much earlier",
        (_SENSOR, Parameter("delay", "how much", "time", low=0.0, high=60.0)), onsensor.Delayed,
    ),
    _sensor(
        "sensor_intermittent", "a bad contact: in this share of the readings it shows the last good one",
        (_SENSOR, _SHARE), onsensor.Intermittent,
    ),
    _actuator(
        "motor_open", "no voltage reaches the motor's winding (its current decays with L/R through the "
        "freewheel diode: a lead that breaks would stop it at once)",
        (_AXIS, _MOTOR), onplant.MotorOpen, _MOVED,
    ),
    _actuator(
        "mosfet_short", "the motor's switch conducts all the time",
        (_AXIS, _MOTOR), onplant.MosfetShort, _MOVED,
    ),
    _actuator(
        "emergency_stop", "the button of the safety chain is pressed: both drives lose the supply of their "
        "power stages, the boards keep theirs",
        (), onplant.EmergencyStop, "the chain stays open until both axes are OFF, and " + _MOVED,
    ),
    _actuator(
        "weak_supply", "the motors' supply has this share of its voltage",
        (Parameter("factor", "share that is left", "fraction", default=0.7, low=0.0, high=1.5), _EITHER),
        onplant.WeakSupply, _MOVED,
    ),
    _plant(
        "friction_change", "Coulomb and breakaway friction of an axis are this many times the declared",
        (_AXIS, Parameter("factor", "1 is as declared", "number", low=0.01, high=10.0)), onplant.Friction,
        _MOVED,
    ),
    _plant(
        "load_change", "the moved mass of an axis is this many times the declared",
        (_AXIS, Parameter("factor", "1 is as declared", "number", low=0.1, high=10.0)), onplant.Load, _MOVED,
    ),
    _plant(
        "play_change", "the gear trains of an axis have more play",
        (_AXIS, Parameter("angle", "how much more, at the axis", "angle", low=0.0, high=36000.0)),
        onplant.Play, _MOVED,
    ),
)  # fmt: skip
BY_NAME = {kind.name: kind for kind in KINDS}
