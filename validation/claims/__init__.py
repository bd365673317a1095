"""Statements of the paper's text as checks: wording, results of runs, verdict.

:mod:`validation.claims.evidence` lists the runs they rest on, :mod:`validation.claims.page` every statement.
"""
