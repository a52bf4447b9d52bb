"""The checks of a recording: one file a kind of finding."""
