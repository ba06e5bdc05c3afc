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
REVERSED_AT = 15  # axis angle of the last reversal, rad
DIRECTION = 16  # sign of the last motion
FRICTION = 17  # last friction torque, N m
SUPPLY_CURRENT = 18  # sum of duty * current of the last step, A
ACCELERATION = 19  # last axis acceleration, rad/s2
STEP = 20  # grid steps done

# --- inputs
DUTY = 21  # two: in force now, 0..1
MEAN_DUTY = 23  # two: mean over the running grid step

# --- readings at the grid point: pairs (value, change per nanosecond)
OUT = 25
OUT_INCREMENTAL, OUT_ABSOLUTE, OUT_AUXILIARY = 0, 2, 4  # counts
OUT_TACH_A, OUT_TACH_B = 6, 8  # counts
OUT_ANGLE = 10  # rad, truth
OUT_CURRENT_A, OUT_CURRENT_B = 12, 13  # A
OUT_SIZE = 14
SUPPLY_RESISTANCE = 39  # ohm, shared with the other axis
OTHERS_SAG = 40  # V that the other axis takes in it

# --- parameters
INERTIA = 41  # axis without rotors and without the second mass, kg m2
ROTOR_INERTIA = 42
RATIO = 43
GEAR_STIFFNESS = 44  # one train, N m/rad at the axis
GEAR_DAMPING = 45  # one train, N m s/rad at the axis
HALF_PLAY = 46  # rad at the axis, each side
RESISTANCE = 47  # loop: winding + switch + sense, ohm
INDUCTANCE = 48
TORQUE_CONSTANT = 49
VOLTAGE = 50
ROTOR_DRAG = 51  # N m s/rad at the rotor
CURRENT_DECAY = 52  # exp(-R h / L)
CURRENT_BLEND = 53  # (1 - CURRENT_DECAY) L / (R h)
WINDING = 54  # the winding's share of RESISTANCE, ohm
RIPPLE = 55  # V / (2 L f_pwm), A; 0: no ripple peak in the reading
DIODE, DIODE_DROP = 56, 57  # share of the freewheel braking, V
PULSE = 58  # PWM period over inductance, A/V; 0: the plant declares no diode for its power stage
VALLEY = 59  # two: smallest current of a PWM period, A; state of the power stage
INCREMENTAL_SCALE, ABSOLUTE_SCALE, AUXILIARY_SCALE, TACH_SCALE = 61, 62, 63, 64  # counts per rad
INCREMENTAL_ZERO = 65  # rad
AWAKE = 66  # 1: the error that the incremental reading woke up with is part of its zero
TACH_ZERO = 67  # two, rad
TEMPERATURE, WARMING = 69, 70  # degC at start, K/s
GRID = 71  # s
RECORD_EVERY = 72  # steps, 0: nothing is recorded
RECORDED = 73  # rows written since start
DELAY_ON = 74  # 1: keep the readings of every step
DECLARED_FRICTION = 75  # friction parameters as declared
FRICTION_SIZE = 8
F_SIGMA0, F_SIGMA1, F_SIGMA2, F_COULOMB, F_STICTION, F_RATE, F_EXPONENT, F_DECAY = range(FRICTION_SIZE)
STOP_MIDDLE, STOP_REACH = 83, 84  # hard stops: middle of the travel, half of it, rad
STOP_STIFFNESS = 85  # of one buffer, N m/rad; 0: no hard stops
STOP_DAMPING = 86  # N m s/rad

# --- signals: what an effect may depend on
SIGNALS = 87
SIGNALS_SIZE = 16
FRICTION_NOW = SIGNALS + SIGNALS_SIZE  # friction parameters of this step: part of the signal vector
SIGNALS_END = FRICTION_NOW + FRICTION_SIZE

# --- effects: rows sorted by hook
ROWS_MOTOR = SIGNALS_END  # number of rows that act on each motor
ROWS_ALL = ROWS_MOTOR + 1  # number of all rows
SUMS = ROWS_ALL + 1  # sum of the values at each hook, for motor A; then of the motor hooks for motor B
SUMS_OF_B = SUMS + 12
EFFECTS = SUMS_OF_B + 5
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
WIDTH = DELAYS + OUT_SIZE * DELAY_ROWS
