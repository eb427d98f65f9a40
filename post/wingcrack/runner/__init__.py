"""Running the solver many times: each run once, and again only when something has changed."""
