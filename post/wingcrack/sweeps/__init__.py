"""What studies and verification share: scenes changed from run to run, and numbers of the runs."""
