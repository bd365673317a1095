"""Statements of the paper's text as checks: what it says, what the runs show, whether it holds.

A module a figure; :mod:`validation.claims.evidence` says which runs they rest on, and
:mod:`validation.claims.all` lists and evaluates them.
"""
