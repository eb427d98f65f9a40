"""A run in the browser: a local page with the fields of all written states (`wingcrack view`)."""
