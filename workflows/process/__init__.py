"""What a process needs whatever it computes: threads, memory, devices, progress, files written atomically."""
