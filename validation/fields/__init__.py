"""Fields under the surface: which moments, as files for ParaView, and how far they can be trusted."""
