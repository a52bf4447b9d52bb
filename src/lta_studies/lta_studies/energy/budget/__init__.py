"""Power budget by task, from simulated flights, compared with the seed paper."""
