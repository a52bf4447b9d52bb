"""Checks of a recording, one file per kind of finding."""
