"""How runs are carried out, stored, continued, and distributed over processes."""
