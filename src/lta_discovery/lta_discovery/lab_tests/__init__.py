"""Plan the tests of a laboratory for a vehicle, and read their logs."""
