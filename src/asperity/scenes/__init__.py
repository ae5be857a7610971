"""What every scene has: how it is computed, what is looked at, and how that is laid out and shown."""
