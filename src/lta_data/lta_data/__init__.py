"""Recordings: read, mended, imported, exported, checked, compared and plotted."""
