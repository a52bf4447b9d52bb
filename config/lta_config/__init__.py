"""Every fact in one place: topics, vehicles, scenarios, gains, and their strict readers."""
