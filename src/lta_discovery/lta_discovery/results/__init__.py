"""Write the result of a study: JSON, vehicle file, overlay bag for Foxglove, terminal."""
