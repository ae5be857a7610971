"""Convergence: a case computed again with each of its settings made finer, and how far its result changes."""
