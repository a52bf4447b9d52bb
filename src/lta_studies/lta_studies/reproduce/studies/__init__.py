"""One study for each row of the reproduction; it measures what the row's file declares."""
