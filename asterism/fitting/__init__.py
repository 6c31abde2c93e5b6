"""From a target surface to a design: flattening, reach, first guess and fit."""
