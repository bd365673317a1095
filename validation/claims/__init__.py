"""Statements of the paper's text as checks: what it says, what was found, whether it holds.

A module a figure; :mod:`validation.claims.evidence` says which runs they rest on, and
:mod:`validation.claims.all` lists and judges them.
"""
