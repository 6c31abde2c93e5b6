"""Newton's method, its line search, saddle points, and the certificate of a minimum."""
