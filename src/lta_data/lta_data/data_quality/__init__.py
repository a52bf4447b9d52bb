"""Check the quality of a recording; findings name channel, interval and evidence."""
