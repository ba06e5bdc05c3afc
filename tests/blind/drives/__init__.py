"""Sealed logs of other drives: a ball screw, a belt, a geared servo, a direct-drive rotary table.

Another simulator than the telescope's, with parameters from publications about such drives (families.py).
Like the sealer it imports none of the project's rooms (a test holds it).
"""
