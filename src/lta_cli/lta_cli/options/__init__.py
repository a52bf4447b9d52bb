"""Define options and the console that many verbs share."""
