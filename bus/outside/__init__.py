"""Where simulated frames meet what is outside: python-can's buses, adapters, sockets and the wall clock."""
