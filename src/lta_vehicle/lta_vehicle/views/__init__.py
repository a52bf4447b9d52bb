"""A vehicle in words, tables and drawings."""
