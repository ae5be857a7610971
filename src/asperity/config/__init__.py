"""The form of a case: keys with units, limits and words, read from TOML into frozen objects in SI."""
