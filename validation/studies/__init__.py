"""Refinement studies: convergence, work against precision, accuracy of the parts."""
