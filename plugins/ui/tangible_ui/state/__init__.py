"""What all tabs share: the document with its earlier texts and drafts, files that came from a page, and comparisons."""
