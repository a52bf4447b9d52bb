# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Reproduce the seed paper and compare each of its claims with our results."""
