"""Where everything lies in an axis' row of the world array (float64, SI units unless told).

One flat row per axis keeps the compiled call cheap (one array argument) and lets Python read single values
through a memoryview. Positions are those of the step's middle (leapfrog), rates those of the grid point.
"""

# --- state
RATE = 0  # axis, rad/s, at the grid point
ANGLE = 1  # axis, rad, half a step later
RATE_BEFORE = 2  # one step earlier, to extrapolate the rate to the step's middle
BRISTLE = 3  # LuGre z, rad, half a step later
STRIBECK = 4  # last g(rate), rad
MOTORS = 5  # two blocks of MOTOR_SIZE
MOTOR_SIZE = 5
M_RATE, M_ANGLE, M_RATE_BEFORE, M_CURRENT, M_GEAR = range(MOTOR_SIZE)  # rad/s, rad, rad/s, A, N m at the axis
REVERSED_AT = 18  # axis angle of the last reversal, rad
DIRECTION = 19  # sign of the last motion
FRICTION = 20  # last friction torque, N m
SUPPLY_CURRENT = 21  # sum of duty * current of the last step, A
ACCELERATION = 22  # last axis acceleration, rad/s2
STEP = 23  # grid steps done

# --- inputs
DUTY = 24  # two: in force now, 0..1
MEAN_DUTY = 26  # two: mean over the running grid step

# --- readings at the grid point: pairs (value, change per nanosecond)
OUT = 28
OUT_INCREMENTAL, OUT_ABSOLUTE, OUT_AUXILIARY = 0, 2, 4  # counts
OUT_TACH_A, OUT_TACH_B = 6, 8  # counts
OUT_ANGLE = 10  # rad, truth
OUT_CURRENT_A, OUT_CURRENT_B = 12, 13  # A
OUT_SIZE = 14
SUPPLY_RESISTANCE = 42  # ohm, shared with the other axis
OTHERS_SAG = 43  # V that the other axis takes in it

# --- parameters
INERTIA = 44  # axis without rotors and without the second mass, kg m2
ROTOR_INERTIA = 45
RATIO = 46
GEAR_STIFFNESS = 47  # one train, N m/rad at the axis
GEAR_DAMPING = 48  # one train, N m s/rad at the axis
HALF_PLAY = 49  # rad at the axis, each side
RESISTANCE = 50  # loop: winding + switch + sense, ohm
INDUCTANCE = 51
TORQUE_CONSTANT = 52
VOLTAGE = 53
ROTOR_DRAG = 54  # N m s/rad at the rotor
CURRENT_DECAY = 55  # exp(-R h / L)
CURRENT_BLEND = 56  # (1 - CURRENT_DECAY) L / (R h)
WINDING = 57  # the winding's share of RESISTANCE, ohm
RIPPLE = 58  # V / (2 L f_pwm), A; 0: no ripple peak in the reading
DIODE, DIODE_DROP = 59, 60  # share of the freewheel braking, V
PULSE = 61  # PWM period over inductance, A/V; 0: the plant declares no diode for its power stage
VALLEY = 62  # two: smallest current of a PWM period, A; state of the power stage
INCREMENTAL_SCALE, ABSOLUTE_SCALE, AUXILIARY_SCALE, TACH_SCALE = 64, 65, 66, 67  # counts per rad
INCREMENTAL_ZERO = 68  # rad
AWAKE = 69  # 1: the error that the incremental reading woke up with is part of its zero
TACH_ZERO = 70  # two, rad
TEMPERATURE, WARMING = 72, 73  # degC at start, K/s
GRID = 74  # s
RECORD_EVERY = 75  # steps, 0: nothing is recorded
RECORDED = 76  # rows written since start
DELAY_ON = 77  # 1: keep the readings of every step
DECLARED_FRICTION = 78  # friction parameters as declared
FRICTION_SIZE = 8
F_SIGMA0, F_SIGMA1, F_SIGMA2, F_COULOMB, F_STICTION, F_RATE, F_EXPONENT, F_DECAY = range(FRICTION_SIZE)
STOP_MIDDLE, STOP_REACH = 86, 87  # hard stops: middle of the travel, half of it, rad

# --- signals: what an effect may depend on
SIGNALS = 88
SIGNALS_SIZE = 16
FRICTION_NOW = SIGNALS + SIGNALS_SIZE  # friction parameters of this step: part of the signal vector
SIGNALS_END = FRICTION_NOW + FRICTION_SIZE

# --- effects: rows sorted by hook
ROWS_MOTOR = SIGNALS_END  # number of rows that act on each motor
ROWS_ALL = ROWS_MOTOR + 1  # number of all rows
SUMS = ROWS_ALL + 1  # sum of the values at each hook, for motor A; then of the motor hooks for motor B
SUMS_OF_B = SUMS + 12
EFFECTS = SUMS_OF_B + 6
ROW = 80  # hook, kind, memory, parameters
ROW_KIND, ROW_MEMORY = 1, 2
MAX_EFFECTS = 32

# --- rings
TRUTH = EFFECTS + ROW * MAX_EFFECTS
TRUTH_COLUMNS = (
    "t", "angle", "rate", "current_a", "current_b", "motor_angle_a", "motor_angle_b", "gear_torque_a",
    "gear_torque_b", "friction", "bristle",
)  # fmt: skip
TRUTH_SIZE = len(TRUTH_COLUMNS)
TRUTH_ROWS = 256
DELAYS = TRUTH + TRUTH_SIZE * TRUTH_ROWS
DELAY_ROWS = 512
STOP_STIFFNESS = DELAYS + OUT_SIZE * DELAY_ROWS  # of one buffer, N m/rad; 0: no hard stops
STOP_DAMPING = STOP_STIFFNESS + 1  # N m s/rad
WIDTH = STOP_DAMPING + 1
