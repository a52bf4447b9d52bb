# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Onboard software: state estimation, cascaded control, thrust allocation and navigation."""
