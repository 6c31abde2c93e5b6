"""Files for the print of a design: solids, 1:1 sheets, needles, start code. Each file format is a module."""
