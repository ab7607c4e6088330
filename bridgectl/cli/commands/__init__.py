"""What each command takes: its help and its options, without libraries that take time."""
