"""LX200: the telescope for Stellarium, KStars with INDI, and SkySafari-type programs, over TCP and serial."""
