"""Sealed logs like those that people of the world have: a motor at one speed, arms that lift, guide logs, two
sensors, tables with the faults of real files.

A third simulator. Like the others it imports none of the project's rooms (an import contract holds it), and
every parameter, length, rate and noise is drawn over a factor of 3 to 10 or more.
"""
