"""Onboard software: state estimation, cascaded control, thrust allocation and navigation."""
