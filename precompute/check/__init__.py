"""What FMI 2.0 demands of a co-simulation FMU, asked of the FMU itself."""
