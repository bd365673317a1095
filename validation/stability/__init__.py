"""The stiff and extreme matrix: every solver on every axis along which a scene can become hard.

A probe (``probe``) is one scene with what is known about it; a cell (``verdict``) is one solver's answer to
it, judged. ``matrix`` lists the probes, ``drive`` runs them in processes that can be killed, ``growth`` and
``limits`` say what came out.
"""
