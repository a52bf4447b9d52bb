"""The wind tunnel for people: its progress, its page, its pictures."""
