# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Filter flights through the model: likelihoods, noise, and causal forecasts."""
