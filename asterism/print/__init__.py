"""From a design to the printer: solids, 1:1 sheets, needles, start code; one file format a module."""
