"""The kernel's parameters as places in one flat array (numba freezes module integers into the code)."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NAMES: Final = (
    # declared plant, SI units at the axis unless said otherwise
    "J",
    "SIG0",
    "SIG1",
    "SIG2",
    "TC",
    "TS",
    "VS",
    "DELTA",
    "RATIO",
    "KGEAR",
    "CGEAR",
    "HALF_GAP",
    "JM",
    "KA",
    "KB",
    "RA",
    "RB",
    "L",
    "V0",
    "COUNTER",
    "KP_Q12",
    "KI_Q12",
    "TICK",
    "ROLLER_SCALE",
    "ROLLER_NOISE",
    # friction effects
    "ASYM_C",
    "ASYM_V",
    "POSF_A",
    "POSF_ORDER",
    "POSF_PH",
    "LOADF",
    "WARM_A",
    "WARM_TAU",
    "PRELOAD_A",
    "PRELOAD_T0",
    "PRELOAD_RAMP",
    "BRAKE_T",
    "BRAKE_T0",
    # torque over angle
    "GRAV_A",
    "GRAV_PH",
    "CABLE_K",
    "CABLE_TH0",
    "CABLE_H",
    "CABLE_SCALE",
    "L1_T",
    "L1_K",
    "L1_ORDER",
    "L1_PH",
    "L2_T",
    "L2_K",
    "L2_ORDER",
    "L2_PH",
    "TOOTH_T",
    "TOOTH_K",
    "TOOTH_ORDER",
    "TOOTH_WIDTH",
    "TOOTH_PH",
    # motors
    "COG_A",
    "COG_N",
    "COG_PH",
    "RIP_A",
    "RIP_N",
    "RIP_PH",
    "COUNTER_LOSS",
    "ROTOR_DRAG",
    "DEADBAND",
    "DIODE",
    "SAG",
    "HEAT",
    "HEAT_TAU",
    "MAG_A",
    "MAG_T0",
    "MAG_RAMP",
    "MAG_SIDE",
    # structure, roller, delays
    "J2",
    "W2",
    "Z2",
    "ROLLER_EPS",
    "SLIP_C",
    "SLIP_A0",
    "DELAY_POS",
    "DELAY_VEL",
    "DELAY_TACH",
    "DELAY_ADC",
    # outside the catalogue
    "PREI_A",
    "PREI_W",
    "BRUSH_A",
    "BRUSH_PH",
    "BRUSH_WIDTH",
    "BUG_V",
    "BUG_F",
    "QUAD",
    # the run
    "T_SESSION",
    "TH_START",
    "ROLLER_PHASE",
)
COUNT: Final = len(NAMES)
INDEX: Final = {name: place for place, name in enumerate(NAMES)}

(
    J, SIG0, SIG1, SIG2, TC, TS, VS, DELTA, RATIO, KGEAR, CGEAR, HALF_GAP, JM, KA, KB, RA, RB, L, V0,
    COUNTER, KP_Q12, KI_Q12, TICK, ROLLER_SCALE, ROLLER_NOISE, ASYM_C, ASYM_V, POSF_A, POSF_ORDER,
    POSF_PH, LOADF, WARM_A, WARM_TAU, PRELOAD_A, PRELOAD_T0, PRELOAD_RAMP, BRAKE_T, BRAKE_T0, GRAV_A,
    GRAV_PH, CABLE_K, CABLE_TH0, CABLE_H, CABLE_SCALE, L1_T, L1_K, L1_ORDER, L1_PH, L2_T, L2_K, L2_ORDER,
    L2_PH, TOOTH_T, TOOTH_K, TOOTH_ORDER, TOOTH_WIDTH, TOOTH_PH, COG_A, COG_N, COG_PH, RIP_A, RIP_N,
    RIP_PH, COUNTER_LOSS, ROTOR_DRAG, DEADBAND, DIODE, SAG, HEAT, HEAT_TAU, MAG_A, MAG_T0, MAG_RAMP,
    MAG_SIDE, J2, W2, Z2, ROLLER_EPS, SLIP_C, SLIP_A0, DELAY_POS, DELAY_VEL, DELAY_TACH, DELAY_ADC,
    PREI_A, PREI_W, BRUSH_A, BRUSH_PH, BRUSH_WIDTH, BUG_V, BUG_F, QUAD, T_SESSION, TH_START, ROLLER_PHASE,
) = range(COUNT)  # fmt: skip

# columns the kernel writes, one row per 10 ms
OUT_NAMES: Final = (
    "setpoint", "effort", "velocity", "theta", "theta_log", "phi_a", "phi_b", "i_a", "i_b", "i_a_log",
    "i_b_log", "omega", "e_torque", "e_kin", "e_volt_a", "e_volt_b", "e_roller", "duty_a", "duty_b",
    "f_coulomb", "f_stiction", "f_stiffness", "f_stribeck",
)  # fmt: skip
OUT: Final = {name: place for place, name in enumerate(OUT_NAMES)}
(
    O_SETPOINT, O_EFFORT, O_VELOCITY, O_THETA, O_THETA_LOG, O_PHI_A, O_PHI_B, O_I_A, O_I_B, O_I_A_LOG,
    O_I_B_LOG, O_OMEGA, O_E_TORQUE, O_E_KIN, O_E_VOLT_A, O_E_VOLT_B, O_E_ROLLER, O_DUTY_A, O_DUTY_B,
    O_F_COULOMB, O_F_STICTION, O_F_STIFFNESS, O_F_STRIBECK,
) = range(len(OUT_NAMES))  # fmt: skip


def vector(values: dict[str, float]) -> Array:
    """Parameters by name to the flat array; a name that does not exist is a KeyError."""
    out = np.zeros(COUNT)
    for name, value in values.items():
        out[INDEX[name]] = value
    return out
