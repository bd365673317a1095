"""What only the authors run: studies of the solvers, random scenes, prices as ratios. Not installed.

Run from the project's folder, ``python -m benchmarks.NAME``. Nothing outside imports it but tests.
"""
