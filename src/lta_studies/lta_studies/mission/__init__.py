"""Missions over days: perch and charge, fly when light and reserve allow, come back in time."""
