"""Weather station (P13): humidity, temperature, wind and rain, outside or in the dome."""

from boards.weather.firmware import WeatherBoard

__all__ = ["WeatherBoard"]
