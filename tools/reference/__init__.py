# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Generate the reference pages of docs/ from the code and configuration files."""
