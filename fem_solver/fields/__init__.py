"""Fields in the body: stresses, energies and losses from the history of the surface."""
