"""Measured comparisons, each printing its ratios side by side in one run (``make bench``)."""
