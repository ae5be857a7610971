"""The texture that rolls quietest, or the roughest that keeps a level."""
