"""A ball rolls over a rough beam."""
