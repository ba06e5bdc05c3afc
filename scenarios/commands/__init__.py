"""What `schmidt` can be told: one file per kind of work, each with its commands' options."""
