"""Running the solver many times: each run once, and repeated only after a change."""
