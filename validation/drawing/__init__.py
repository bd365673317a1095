"""Curves and figures that fields and report share."""
