"""Shared parts of all results: pages, figures, folders, progress bars and worker processes."""
