"""The page's web server: socket, routes, the tabs' websockets, and polling of the loop."""
