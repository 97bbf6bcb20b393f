"""Off-line stage: part.toml → Part → Mesh → System(K, M) → Modes → ReducedModel → FMU."""
