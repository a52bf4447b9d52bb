"""Finding gains over a spread of helium losses, and saying how firmly they hold."""
