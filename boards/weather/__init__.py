"""Weather station (P13): humidity, temperature, wind and rain, outside or in the dome."""
