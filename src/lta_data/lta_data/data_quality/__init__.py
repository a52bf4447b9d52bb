"""Whether a recording can be believed: checks that name channel, interval and evidence."""
