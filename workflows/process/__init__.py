"""Settings and services of any process: threads, memory, devices, interrupts, progress, files written atomically."""
