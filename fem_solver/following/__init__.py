"""Surface history on a mesh that follows the contact edge, in steps that pass over many nodes."""
