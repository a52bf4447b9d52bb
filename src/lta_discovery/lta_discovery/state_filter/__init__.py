"""Filter flights through the model: likelihoods, noise, and causal forecasts."""
