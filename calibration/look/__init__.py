"""Looking at a drive: its balances one after another, by what it is declared to be."""
