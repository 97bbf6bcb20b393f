"""The Python twin: exactly what is copied into an FMU (numpy and the standard library only)."""
