"""Sound power from vibration: what rail, sleepers and wheel radiate when a force moves them."""
