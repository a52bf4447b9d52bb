# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Replay flights through the model: predictions and their sensitivities."""
