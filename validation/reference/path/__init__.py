"""Front tracking whose state is the path of the edge, followed by an arclength in load and radius."""
