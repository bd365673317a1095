"""Sweeps: one scene over many values of its keys, carried out once each, as one labelled data set.

Beside the five kinds of evidence: a sweep asks for runs as they do, and judges nothing.
"""
