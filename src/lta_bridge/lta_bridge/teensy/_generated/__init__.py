"""Modules that the build writes; linters pass over a folder that begins with `_`."""
