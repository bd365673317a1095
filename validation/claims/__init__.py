"""Statements of the paper's text as checks: wording, results of runs, verdict.

A module a figure; :mod:`validation.claims.evidence` lists the runs they rest on, and
:mod:`validation.claims.all` lists and evaluates them.
"""
