"""An axis with two motors that pull against each other: torque, volts, encoders and command together."""
