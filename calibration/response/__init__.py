"""A response of any drive: a balance of forces, or one sensor against another, with command and volts."""
