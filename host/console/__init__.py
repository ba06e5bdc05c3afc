"""The consoles of the paper in a browser (H2 to H5, H7), beside a view of the bus and of the calibration."""
