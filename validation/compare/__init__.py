"""Solvers against the reference, closed forms and an earlier report."""
