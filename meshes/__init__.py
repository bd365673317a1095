"""Part of crosscontact."""
