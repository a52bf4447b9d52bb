"""Running nodes again on what was recorded, and comparing what they answer with the recording."""
