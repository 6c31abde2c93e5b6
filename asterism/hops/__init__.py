"""Components of Grasshopper, served to Hops: sheets, exact shapes, fits and prints inside Rhino."""
