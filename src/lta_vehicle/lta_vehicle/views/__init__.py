"""Vehicle sheets as terminal output, HTML page, drawings and JSON."""
