"""Pictures of the documentation and of the studio's first page, and the numbers that stand beside them."""
