"""The homogenised law: axes, plan of the cells, tables, file and errors."""
