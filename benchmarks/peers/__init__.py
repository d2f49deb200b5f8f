"""Footfall against other tools at equal accuracy of the objective, a process each.

The modules ``with_*`` run in the virtual environment of their tool, which knows no footfall: they,
``problems`` and ``measuring`` import nothing of this repository but each other.
"""
