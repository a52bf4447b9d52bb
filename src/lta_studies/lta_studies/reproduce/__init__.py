"""The seed paper, claim by claim, beside what this system gives."""
