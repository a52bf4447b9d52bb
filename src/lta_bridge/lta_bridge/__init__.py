# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Recorder and player of bags, and links to real hardware."""
