"""The state that all tabs share: the document with its history and drafts, uploads, and force laws compared."""
