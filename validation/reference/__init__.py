"""Reference solutions: front tracking for any scene (``tracking``), closed forms for special ones."""
