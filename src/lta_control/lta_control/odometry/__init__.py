# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Estimate speed and position: through the air, and over ground."""
