"""The web server of the page: socket, routes, the tabs' websockets, and what watches over the loop meanwhile."""
