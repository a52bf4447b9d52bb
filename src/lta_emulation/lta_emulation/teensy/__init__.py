# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The light board, emulated."""
