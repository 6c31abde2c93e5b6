"""Newton's method, line search, and the certificate of a minimum."""
