"""Switches: found in a solution, the phase split there at free times, the parts joined again.

A control that jumps inside of a segment costs accuracy on every mesh; at the end of a phase it
costs nothing. Splitting changes the problem's trees alone: any method solves the parts.
"""
