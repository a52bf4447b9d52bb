"""Where a model and a measured flight disagree, and which physical effect is missing."""
