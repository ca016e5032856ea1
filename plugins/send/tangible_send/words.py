"""Words of a page to send that stand in the file itself, in each language; all others are in the page's script."""

from collections.abc import Mapping

from tangible_legibility.words.languages import Language

UNTITLED: Mapping[Language, str] = {
    "en": "A picture to explore",
    "de": "Ein Bild zum Erkunden",
    "fr": "Une image à explorer",
}
NO_SCRIPT: Mapping[Language, str] = {
    "en": "To hear and feel the picture, this page needs JavaScript. Its description is below.",
    "de": "Um das Bild zu hören und zu fühlen, braucht diese Seite JavaScript. Die Beschreibung steht unten.",
    "fr": "Pour entendre et sentir l'image, cette page a besoin de JavaScript. La description est ci-dessous.",
}
FIRST_FRAME: Mapping[Language, str] = {
    "en": "This is the first frame of a film.",
    "de": "Dies ist das erste Bild eines Films.",
    "fr": "C'est la première image d'un film.",
}
