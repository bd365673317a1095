"""What measured curves say about material and adhesion: curves, parameters, fits and their errors.

One of the kinds of evidence that stand beside each other: runs compared with an instrument's record
instead of another solver's run.
"""
