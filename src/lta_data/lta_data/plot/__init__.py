# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Plot recordings on the terminal, as PNG, or as a page."""
