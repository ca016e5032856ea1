"""Pages for swell paper: what is drawn where in millimetres, its SVG and PDF, and the drawn page measured again."""
