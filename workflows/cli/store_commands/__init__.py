"""The commands of `moseg store`."""
