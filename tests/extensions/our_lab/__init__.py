"""What our laboratory adds to asperity."""
