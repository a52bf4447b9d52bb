"""Topics, vehicles, scenarios and gains: the data files and their strict readers."""
