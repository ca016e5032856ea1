"""Pages for swell paper: the layout in millimetres, the key, and the marks as SVG and PDF."""
