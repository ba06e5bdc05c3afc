"""Pages of docs/reference that are made from code: each module here makes one."""
