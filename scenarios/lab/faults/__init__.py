"""What can go wrong, as one table: scenarios, the live call, the schema and the documentation read it."""
