# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Estimate the energy state in flight and monitor the reserve."""
