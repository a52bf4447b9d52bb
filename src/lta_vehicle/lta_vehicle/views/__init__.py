# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Vehicle sheets as terminal output, HTML page, drawings and JSON."""
