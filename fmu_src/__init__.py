"""What goes into an FMU, and the packaging."""
