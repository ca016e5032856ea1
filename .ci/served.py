"""Does the page of an installed wheel come out of `tangible ui`? Run outside of the checkout."""

from pathlib import Path
from urllib.parse import urljoin
from urllib.request import urlopen

from ui_server import UiServer

with UiServer(cwd=Path()) as server:
    page = urlopen(server.url).read().decode()
    sizes = {name: len(urlopen(urljoin(server.url, name)).read()) for name in ("app.js", "app.css", "LICENSES.txt")}
assert 'src="app.js"' in page
assert sizes["app.js"] > 100_000
assert all(sizes.values())
