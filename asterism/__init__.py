"""asterism: the shape of plastic stars printed on stretched fabric."""

__version__ = "0.1.0"
