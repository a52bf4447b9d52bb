# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Propose a mapping for a log from the names and the physics of its columns."""
