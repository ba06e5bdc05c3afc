"""Mutation testing of whole rooms: `python -m tests.mutation ROOM`."""
