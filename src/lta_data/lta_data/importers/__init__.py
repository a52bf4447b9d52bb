"""Other people's logs, made bags of ours: one file a format, one registry, one way to convert."""
