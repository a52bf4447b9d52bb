"""Quick looks at a recording: on the terminal, as PNG, as a page."""
