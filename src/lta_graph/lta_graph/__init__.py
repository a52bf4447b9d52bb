"""How the LTA nodes are wired, kept in step, watched and launched."""
