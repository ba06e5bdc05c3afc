"""Mutation testing of codecs, CRCs, CAN error states and the MCP2515: `python -m tests.mutation`."""
