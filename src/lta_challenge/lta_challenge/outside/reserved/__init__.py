"""Forces written after discovery had begun to propose laws; no challenge draws them."""
