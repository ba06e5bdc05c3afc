"""Residual channels: torque (T), electrical (E), difference of encoders (K), sensor and clock (S)."""
