"""How runs are carried out, kept, and shared out among processes."""
