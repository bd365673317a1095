"""Reference solutions: the path of the edge for any scene (``path``), closed forms for special ones."""
