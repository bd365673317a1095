"""The stiff and extreme matrix: every solver on every axis along which a scene can become hard.

A case (``case``) is one scene with the expected answer; a cell (``verdict``) is one solver's answer to it and
its verdict. ``matrix`` lists the cases, ``runner`` runs them in processes that can be killed, ``growth`` and
``limits`` state the results in words.

``random_scenes`` makes scenes of seeds over wide ranges; ``random_matrix``, run as a module, puts them
through all solvers and judges every answer by ``trace_invariants`` and against the front tracking
(``random_answers``), if asked also by the checks of a comparison (``random_compared``). Families of their own
are ``random_instruments`` (springs, levels, records, laws), ``random_swings`` (to and fro several times) and
``random_plain`` (what a first-time user writes).
"""
