"""The stiff and extreme matrix: every solver on every axis along which a scene can become hard.

A case (``case``) is one scene with the expected answer; a cell (``verdict``) is one solver's answer to it and
its verdict. ``matrix`` lists the cases, ``runner`` runs them in processes that can be killed, ``limits``
states the results in words.
"""
