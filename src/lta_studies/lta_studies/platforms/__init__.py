# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fly platforms in the same manoeuvres, each with its own control law."""
