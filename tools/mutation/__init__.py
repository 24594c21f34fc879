"""What scripts/mutants is made of: the list of changes, suggestions for it, builds of one change, tests on it."""
