"""Plot recordings on the terminal, as PNG, or as a page."""
