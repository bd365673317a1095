"""Figures that belong to one kind of evidence; matplotlib is loaded when one is drawn."""
