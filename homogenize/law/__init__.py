"""The homogenised law: tables, fit, file."""
