"""What runs on the PC: link, telescope client, sky and logs."""
