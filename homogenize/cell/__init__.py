"""The periodic unit cell."""
