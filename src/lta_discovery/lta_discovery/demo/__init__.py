# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Demonstrate discovery: hide an effect, fly with it, and find it."""
