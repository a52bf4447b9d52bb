"""Write the HTML page of a study: missing effects, evidence, and gain in prediction accuracy."""
