"""Read, repair, import, export, check, compare and plot recordings."""
