"""What a scenario may say: documents, units, the schema, plants, programme."""
