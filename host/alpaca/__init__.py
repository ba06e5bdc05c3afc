"""ASCOM Alpaca: the telescope and the focuser for programs that speak HTTP (ITelescopeV4, IFocuserV4)."""
