"""Reports: the page about a design (PDF) and the page of a verification (HTML)."""
