# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Describe, validate and compare vehicle files, and estimate heaviness from a flight."""
