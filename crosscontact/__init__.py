"""The door: Python API and command line."""
