"""Figures of the fields under the surface; PyVista and matplotlib are loaded when something is drawn."""
